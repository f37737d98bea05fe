// SPDX-License-Identifier: BSD-3-Clause
#include "world/model/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "world/search/search.hpp"

namespace straytrace::world {
namespace {

template <class List, class Vectors, std::size_t... I>
Pool<List> pool_of(Vectors const& vectors, std::index_sequence<I...>) {
  Pool<List> pool;
  ((std::get<I>(pool.arrays) = {std::get<I>(vectors).data(), std::get<I>(vectors).size()}), ...);
  return pool;
}

}  // namespace

void World::too_many_shapes(std::string_view kind) const {
  throw InputError(fmt::format("the scene has more than {} surfaces of shape '{}'", most_shapes, kind),
                   "repeat less, or describe many small surfaces by one mesh or one larger shape");
}

std::uint32_t World::add_optic(Optic const& optic) {
  material_optic_.push_back(std::uint32_t(optics_.size()));
  optics_.push_back(optic);
  return material_optic_.back();
}

void World::begin_scatter_at(SurfaceId id, bool front, double crossover, double below) {
  Surface& surface = surfaces_[id.value];
  std::uint32_t& side = front ? surface.front : surface.back;
  Optic optic = optics_[side];
  optic.crossover = crossover;
  optic.below = below;
  std::uint32_t const own = add_optic(optic);
  material_optic_[own] = material_optic_[side];
  side = own;
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

BodyId World::add_mode(BodyId of, std::string name, ElasticMode mode) {
  mode.id = add_body(std::move(name), {});
  bodies_[of.value].modes.push_back(mode);
  return mode.id;
}

GroupId World::add_group(std::string const& name) {
  auto const found = std::ranges::find(groups_, name);
  if (found != groups_.end()) return {std::uint32_t(found - groups_.begin())};
  groups_.push_back(name);
  return {std::uint32_t(groups_.size() - 1)};
}

PortId World::add_port(std::string name) {
  ports_.push_back(std::move(name));
  return {std::uint32_t(ports_.size() - 1)};
}

void World::add_footprint(Footprint f, Feed feed) {
  feeds_.push_back(std::move(feed));
  if (f.free) return lit_.push_back(f);
  PoolRef const ref = surfaces_[f.surface.value].shape;
  WorldView const now = view();
  Extent const e = now.shapes.visit(ref, [](auto const& shape) { return shape.extent(); });
  double const given = f.backoff > 0 ? f.backoff : infinity;
  f.backoff = std::fmin(given, e.r_max + (e.high - e.low));
  if (feeds_.back().propagated) {  // it may have passed another part of this surface on its way
    double const before = now.cross(f.surface.value, {f.centre - 1e-6 * f.travel, -f.travel}, {}).distance;
    f.backoff = std::fmin(f.backoff, 0.5 * before);
  }
  lit_.push_back(f);
}

void World::add_receiver(std::string name, Receiver receiver) {
  surfaces_[receiver.surface.value].clear = receiver.clear;
  receivers_.push_back(receiver);
  receiver_names_.push_back(std::move(name));
}

bool World::open_port(SurfaceId surface, std::uint32_t beam, std::string const& name) {
  std::vector<std::uint32_t> lit;
  for (std::uint32_t i = 0; i < lit_.size(); ++i)
    if (lit_[i].surface == surface && lit_[i].beam == beam) lit.push_back(i);
  open_port(name, lit);
  return !lit.empty();
}

void World::open_port(std::string const& name, std::vector<std::uint32_t> const& footprints) {
  if (footprints.empty()) return;
  PortId const port = add_port(name);
  for (std::uint32_t const i : footprints) {
    lit_[i].port = port;
    lit_[i].receives = true;
  }
}

namespace {

struct PairedPort {
  PortId port;
  std::uint32_t beam;
  std::string light, name;
};

}  // namespace

void World::pair_ports(std::vector<std::uint32_t> const& reverse) {
  std::vector<PortId> first(beams.size());  // port of each beam of the network
  std::vector<std::uint32_t> beam_of(ports_.size());
  for (Footprint const& f : lit_) {
    if (!f.port.valid()) continue;
    beam_of[f.port.value] = f.beam;
    if (!beams[f.beam].network.empty() && !first[f.beam].valid()) first[f.beam] = f.port;
  }
  for (std::uint32_t beam = 0; beam < beams.size(); ++beam) {
    if (!first[beam].valid()) continue;
    auto const pair = [&](std::string name, PortId to, std::uint32_t other, bool forward) {
      pairs_.push_back({.port = add_port(std::move(name)),
                        .beam = beam,
                        .to = to,
                        .forward = forward,
                        .lit = beams[beam].network,
                        .light = beams[other].network,
                        .reference = std::sqrt(beams[beam].share * beams[other].share)});
    };
    for (std::uint32_t to = 0; to < beam_of.size(); ++to)
      if (std::uint32_t const other = beam_of[to]; other != beam && !beams[other].network.empty())
        pair(ports_[to] + " lit by " + beams[beam].name, {to}, other, other == reverse[beam]);
    if (reverse[beam] == no_beam || !first[reverse[beam]].valid())
      pair(ports_[first[beam].value] + " along the beam", first[beam], beam, true);
  }
  for (MirrorLight const& mirror : mirror_lights) pair_with_mirror(mirror, beam_of);
}

void World::pair_with_mirror(MirrorLight const& mirror, std::vector<std::uint32_t> const& beam_of) {
  Footprint const& spot = lit_[mirror.footprint];
  PairedPort const at{spot.port, spot.beam, mirror.name, mirror.name};
  for (std::uint32_t to = 0; to < beam_of.size(); ++to) {
    LightBeam const& other = beams[beam_of[to]];
    if (other.network.empty()) continue;
    auto const pair = [&](PairedPort const& from, PairedPort const& into) {
      if (!into.port.valid()) return;
      pairs_.push_back({.port = add_port(into.name + " lit by " + from.light),
                        .beam = from.beam,
                        .to = into.port,
                        .mirror = mirror.footprint,
                        .lit = from.light,
                        .light = into.light,
                        .reference = std::sqrt(beams[from.beam].share * beams[into.beam].share)});
    };
    PairedPort const of_network{{to}, beam_of[to], other.network, ports_[to]};
    pair(at, of_network);
    pair(of_network, at);
  }
}

void World::open_face_port(PortId first, PortId second) {
  face_ports_.push_back({add_port(fmt::format("{} + {}", ports_[first.value], ports_[second.value])), first, second});
}

PortId World::port_between(Footprint const& source, Footprint const& goal) const {
  if (source.beam == goal.beam || beams.empty()) return goal.port;
  bool const from = !beams[source.beam].network.empty(), to = !beams[goal.beam].network.empty();
  if (!from && !to) return goal.port;
  auto const at_mirror = [&](PortPair const& p) {
    if (p.mirror == Feed::none) return true;
    Footprint const& end = from ? goal : source;
    return end.standing && end.surface == lit_[p.mirror].surface;
  };
  auto const pair = std::ranges::find_if(
      pairs_, [&](PortPair const& p) { return p.beam == source.beam && p.to == goal.port && at_mirror(p); });
  return pair == pairs_.end() ? PortId{} : pair->port;
}

void World::anchor(BodyId id, Vec3 place) {
  if (!id.valid() || bodies_[id.value].pivot_given) return;
  auto const on_it = [id](Surface const& s) { return s.body.value == id.value; };
  if (std::ranges::any_of(surfaces_, on_it)) return;
  bodies_[id.value].pivot = place;
  bodies_[id.value].pivot_given = true;
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

void World::build_search() {
  std::vector<SearchItem> items;
  WorldView const now = view();
  for (std::uint32_t id = 0; id < surfaces_.size(); ++id) {
    if (surfaces_[id].clear) continue;
    items.push_back(now.shapes.visit(surfaces_[id].shape, [](auto const& shape) { return search_item(shape); }));
    items.back().ref = SurfaceRef::of(id, surfaces_[id].shape);
  }
  tree_.build(items);
  searched_ = surfaces_.size();
}

void World::finish() {
  if (searched_ != surfaces_.size()) build_search();
  receiver_of_surface_.assign(surfaces_.size(), WorldView::none);
  for (std::size_t i = receivers_.size(); i-- > 0;)
    if (!receivers_[i].clear) receiver_of_surface_[receivers_[i].surface.value] = std::uint32_t(i);
  lit_of_surface_.assign(surfaces_.size(), WorldView::none);
  emitters_.clear();
  for (std::uint32_t i = 0; i < lit_.size(); ++i) {
    if (lit_[i].receives)
      if (std::uint32_t& first = lit_of_surface_[lit_[i].surface.value]; first == WorldView::none) first = i;
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
  v.receivers = {receivers_.data(), receivers_.size()};
  v.receiver_of_surface = {receiver_of_surface_.data(), receiver_of_surface_.size()};
  for (Receiver const& r : receivers_) v.both_ends = v.both_ends || r.sub_paths > 0;
  for (Footprint const& lit : lit_) v.both_ends = v.both_ends || lit.sub_paths > 0;
  v.polarised = polarised;
  v.tree = tree_.view();
  v.steering = steering_.view();
  v.halo = halo_.view();
  v.limits = limits;
  v.wavelength = wavelength;
  v.block_size = block_size;
  return v;
}

std::vector<std::string> World::body_names() const {
  std::vector<std::string> names;
  for (Body const& b : bodies_) names.push_back(b.name);
  return names;
}

PhaseSensitivity& phase_sensitivity_of(std::vector<PhaseSensitivity>& phase_sensitivities, BodyId body) {
  auto const at = std::ranges::find_if(phase_sensitivities, [&](PhaseSensitivity const& l) { return l.body == body; });
  return at == phase_sensitivities.end() ? phase_sensitivities.emplace_back(PhaseSensitivity{body, {}}) : *at;
}

void add_hit(std::vector<PhaseSensitivity>& phase_sensitivities, World const& world, SurfaceId surface, Vec3 point,
             Vec3 kappa, double delay) {
  BodyId const id = world.surfaces()[surface.value].body;
  if (!id.valid()) return;
  Body const& body = world.bodies()[id.value];
  Vec3 const turn = cross(point - body.pivot, kappa);
  double const rigid[6] = {kappa.x, kappa.y, kappa.z, turn.x, turn.y, turn.z};
  PhaseSensitivity& phase_sensitivity = phase_sensitivity_of(phase_sensitivities, id);
  for (int i = 0; i < 6; ++i) {
    phase_sensitivity.d[i] += rigid[i];
    phase_sensitivity.moment[i] += delay * rigid[i];
  }
  for (ElasticMode const& mode : body.modes) {
    PhaseSensitivity& of_mode = phase_sensitivity_of(phase_sensitivities, mode.id);
    double const d = dot(kappa, mode.shape->at(point - (mode.origin_given ? mode.origin : body.pivot)));
    of_mode.d[0] += d;
    of_mode.moment[0] += delay * d;
  }
}

}  // namespace straytrace::world
