// SPDX-License-Identifier: BSD-3-Clause
#include "world/world.hpp"

#include <algorithm>
#include <cmath>

namespace straytrace {
namespace {

// Heights along z and clear aperture about the z axis of a placed shape. A shape that is not coaxial with z gets its
// bounding heights and no clear aperture.
template <class Shape>
AxialTree::Item axial_item(Shape const& shape) {
  double low, high, r_min, r_max;
  shape.extent(low, high, r_min, r_max);
  Vec3 const at = shape.reference(), along = shape.axis;
  double const tilt = std::sqrt(along.x * along.x + along.y * along.y);
  bool const coaxial = tilt == 0 && at.x == 0 && at.y == 0;
  double const z1 = at.z + low * along.z, z2 = at.z + high * along.z;
  AxialTree::Item item;
  item.low = std::min(z1, z2) - r_max * tilt;
  item.high = std::max(z1, z2) + r_max * tilt;
  item.clear = coaxial ? r_min * (1 - 1e-9) : 0;
  double const longest = std::max(std::fabs(low), std::fabs(high));
  item.reach = (std::sqrt(at.x * at.x + at.y * at.y) + longest * tilt + r_max) * (1 + 1e-9);
  return item;
}

template <class List, class Vectors, std::size_t... I>
Pool<List> pool_of(Vectors const& vectors, std::index_sequence<I...>) {
  Pool<List> pool;
  ((std::get<I>(pool.arrays) = {std::get<I>(vectors).data(), std::get<I>(vectors).size()}), ...);
  return pool;
}

}  // namespace

std::uint32_t World::add_optic(Optic const& optic) {
  optics_.push_back(optic);
  return std::uint32_t(optics_.size() - 1);
}

std::uint32_t World::add_volume(Medium const& medium) {
  media_.push_back(medium);
  volumes_.push_back({std::uint32_t(media_.size() - 1)});
  return std::uint32_t(volumes_.size() - 1);
}

BodyId World::add_body(std::string name, Vec3 pivot) {
  bodies_.push_back({std::move(name), pivot, !std::isnan(pivot.x)});
  return {std::uint32_t(bodies_.size() - 1)};
}

GroupId World::add_group(std::string const& name) {
  auto const found = std::find(groups_.begin(), groups_.end(), name);
  if (found != groups_.end()) return {std::uint32_t(found - groups_.begin())};
  groups_.push_back(name);
  return {std::uint32_t(groups_.size() - 1)};
}

PortId World::add_port(std::string name) {
  ports_.push_back(std::move(name));
  return {std::uint32_t(ports_.size() - 1)};
}

void World::add_footprint(Footprint f) {
  PoolRef const ref = surfaces_[f.surface.value].shape;
  double low = 0, high = 0, r_min = 0, r_max = 0;
  WorldView const now = view();
  now.shapes.visit(ref, [&](auto const& shape) { shape.extent(low, high, r_min, r_max); });
  f.backoff = r_max + (high - low);
  lit_.push_back(f);
}

bool World::open_port(SurfaceId surface, std::uint32_t beam, std::string const& name) {
  PortId port;
  for (Footprint& f : lit_) {
    if (f.surface != surface || f.beam != beam) continue;
    if (!port.valid()) port = add_port(name);
    f.port = port;
    f.receives = true;
  }
  return port.valid();
}

void World::settle_pivots() {
  WorldView const now = view();
  for (auto s = surfaces_.rbegin(); s != surfaces_.rend(); ++s) {  // backwards: the first surface has the last word
    if (!s->body.valid()) continue;
    Body& body = bodies_[s->body.value];
    if (body.pivot_given) continue;
    body.pivot = now.shapes.visit(s->shape, [](auto const& shape) { return shape.reference(); });
  }
}

void World::finish() {
  std::vector<AxialTree::Item> items;
  WorldView const now = view();
  for (std::uint32_t id = 0; id < surfaces_.size(); ++id) {
    items.push_back(now.shapes.visit(surfaces_[id].shape, [](auto const& shape) { return axial_item(shape); }));
    items.back().surface = id;
  }
  tree_.build(std::move(items));
  lit_of_surface_.assign(surfaces_.size(), WorldView::none);
  emitters_.clear();
  for (std::uint32_t i = 0; i < lit_.size(); ++i) {
    if (std::uint32_t& first = lit_of_surface_[lit_[i].surface.value]; lit_[i].receives && first == WorldView::none)
      first = i;
    if (lit_[i].emits) emitters_.push_back(i);
  }
}

WorldView World::view() const {
  WorldView v;
  v.shapes = pool_of<ShapeTypes>(shapes_, std::make_index_sequence<std::tuple_size_v<ShapeTypes>>());
  v.laws = pool_of<LawTypes>(laws_, std::make_index_sequence<std::tuple_size_v<LawTypes>>());
  v.interfaces = pool_of<SpecularTypes>(interfaces_, std::make_index_sequence<std::tuple_size_v<SpecularTypes>>());
  v.volumes = {volumes_.data(), volumes_.size()};
  v.media = {media_.data(), media_.size()};
  v.surfaces = {surfaces_.data(), surfaces_.size()};
  v.optics = {optics_.data(), optics_.size()};
  v.lit = {lit_.data(), lit_.size()};
  v.lit_of_surface = {lit_of_surface_.data(), lit_of_surface_.size()};
  v.emitters = {emitters_.data(), emitters_.size()};
  v.tree = tree_.view();
  v.steering = steering_.view();
  v.limits = limits;
  v.wavelength = wavelength;
  return v;
}

std::vector<std::string> World::body_names() const {
  std::vector<std::string> names;
  for (Body const& b : bodies_) names.push_back(b.name);
  return names;
}

}  // namespace straytrace
