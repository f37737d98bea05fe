// SPDX-License-Identifier: BSD-3-Clause
#include "trace/camera.hpp"

#include <algorithm>

#include "base/threads.hpp"
#include "optics/specular.hpp"

namespace straytrace {
namespace {

void aim(Camera& camera, Vec3 direction, Vec3 up) {
  camera.forward = unit(direction);
  Vec3 const side = cross(camera.forward, up);
  bool const usable = length(side) > 1e-9 * length(up);
  camera.right = usable ? unit(side) : any_normal(camera.forward);
  camera.up = cross(camera.right, camera.forward);
}

// The part of a ray outside all cuts; t_max < 0: nothing.
Ray clipped(Ray ray, std::vector<Cut> const& cuts, double& start) {
  double low = 0, high = ray.t_max;
  for (Cut const& cut : cuts) {
    double const slope = dot(ray.dir, cut.normal), ahead = cut.offset - dot(ray.origin, cut.normal);
    if (slope > 0)
      high = std::min(high, ahead / slope);
    else if (slope < 0)
      low = std::max(low, ahead / slope);
    else if (ahead < 0)
      high = -1;
  }
  start = low;
  return {ray.origin + low * ray.dir, ray.dir, high - low};
}

bool carries_nothing(Optic const& optic) {
  return !optic.has_interface && optic.reflect == 0 && optic.transmit == 0 && optic.laws == 0;
}

Look look_of(WorldView const& world, Surface const& surface, bool front) {
  Optic const &here = world.optics[front ? surface.front : surface.back],
              &other = world.optics[front ? surface.back : surface.front];
  if (carries_nothing(here)) return carries_nothing(other) ? Look::solid : Look::open;
  if (surface.volume == Surface::none) return Look::solid;
  double const n = world.media[world.volumes[surface.volume].medium].index;
  return specular_shares(world.interfaces, here, 1, front ? 1 : n, front ? n : 1, front).transmit > 0.01 ? Look::glass
                                                                                                         : Look::solid;
}

}  // namespace

Ray Camera::ray(double column, double row) const {
  double const x = (2 * column / columns - 1) * half_width, y = (1 - 2 * row / rows) * half_height;
  if (lens == Lens::perspective) return {eye, unit(forward + x * right + y * up)};
  if (lens == Lens::flat) return {eye + x * right + y * up, forward};
  double const angle = std::sqrt(x * x + y * y);
  if (angle == 0) return {eye, forward};
  if (angle > std::min(half_width, half_height)) return {eye, forward, 0};
  return {eye, unit(std::cos(angle) * forward + (std::sin(angle) / angle) * (x * right + y * up))};
}

Camera looking_at(Vec3 eye, Vec3 look, Vec3 up, double field, std::uint32_t columns, std::uint32_t rows) {
  Camera camera;
  camera.eye = eye;
  camera.columns = columns;
  camera.rows = rows;
  aim(camera, look - eye, up);
  camera.half_height = std::tan(0.5 * field);
  camera.half_width = camera.half_height * columns / rows;
  return camera;
}

Camera fisheye_at(Vec3 eye, Vec3 look, Vec3 up, double field, std::uint32_t columns, std::uint32_t rows) {
  Camera camera = looking_at(eye, look, up, 1, columns, rows);
  camera.lens = Camera::Lens::fisheye;
  double const per_pixel = field / std::min(columns, rows);
  camera.half_width = 0.5 * per_pixel * columns;
  camera.half_height = 0.5 * per_pixel * rows;
  return camera;
}

Box bounds_of(WorldView const& world, std::function<bool(SurfaceId)> const& wanted) {
  Box box;
  for (std::uint32_t id = 0; id < world.surfaces.size; ++id)
    if (wanted({id})) box.add(world.shapes.visit(world.surfaces[id].shape, [](auto const& s) { return s.bounds(); }));
  return box;
}

namespace {

struct Extent {
  Vec3 centre, half;
  int longest = 0;
  double second = 0;  // half of the second longest side
};
Extent extent_of(Box const& box) {
  Extent e{0.5 * (box.lower + box.upper), 0.5 * (box.upper - box.lower)};
  double const sides[] = {e.half.x, e.half.y, e.half.z};
  e.longest = int(std::max_element(sides, sides + 3) - sides);
  e.second = std::max(sides[(e.longest + 1) % 3], sides[(e.longest + 2) % 3]);
  return e;
}

}  // namespace

bool is_long(Box const& box) {
  Extent const e = extent_of(box);
  return (&e.half.x)[e.longest] > longest_aspect * e.second;
}

Framing framing(Box const& box, double field, std::uint32_t columns, std::uint32_t rows) {
  Extent const e = extent_of(box);
  Vec3 const outward = unit({-0.55, 0.5, -0.67});
  double const radius = std::max(length(e.half), 1e-6);
  double const narrow = std::atan(std::tan(0.5 * field) * std::min(1.0, double(columns) / rows));
  double const distance = radius / std::sin(narrow);
  Framing f{looking_at(e.centre + distance * outward, e.centre, {0, 1, 0}, field, columns, rows), {}};
  f.cuts.push_back({outward, dot(e.centre, outward) + 1.0001 * radius});
  return f;
}

Framing section(Box const& box, std::uint32_t columns, std::uint32_t rows) {
  static constexpr Vec3 forward[] = {{0, 0, -1}, {0, 0, -1}, {1, 0, 0}}, up[] = {{0, 1, 0}, {-1, 0, 0}, {0, 1, 0}};
  Extent const e = extent_of(box);
  Vec3 const view = forward[e.longest];
  double const deep = length(e.half), margin = 1.04;
  Framing f{looking_at(e.centre - (2 * deep) * view, e.centre, up[e.longest], 1, columns, rows), {}};
  f.camera.lens = Camera::Lens::flat;
  auto const reach = [&](Vec3 side) {
    return margin * (std::fabs(side.x) * e.half.x + std::fabs(side.y) * e.half.y + std::fabs(side.z) * e.half.z);
  };
  f.camera.half_width = reach(f.camera.right);
  f.camera.half_height = reach(f.camera.up);
  f.cuts.push_back({-view, -dot(e.centre, view)});
  return f;
}

std::vector<Look> looks_of(WorldView const& world) {
  std::vector<Look> looks;
  for (std::uint32_t id = 0; id < world.surfaces.size; ++id)
    for (bool const front : {true, false}) looks.push_back(look_of(world, world.surfaces[id], front));
  return looks;
}

Sight sight(WorldView const& world, Ray ray, Departure from, LookSettings const& settings) {
  Sight seen;
  double start = 0;
  ray = clipped(ray, settings.cuts, start);
  if (start > 0) from = {};
  while (ray.t_max > 0) {
    Hit const hit = world.closest(ray, from);
    if (!hit.surface.valid()) return seen;
    start += hit.distance;
    ray = {ray.origin + hit.distance * ray.dir, ray.dir, ray.t_max - hit.distance};
    from = {hit.surface, hit.piece};
    Seen here{hit.surface, hit.piece, start, ray.origin, world.normal(hit.surface, ray.origin, hit.piece), true};
    here.front = dot(ray.dir, here.normal) < 0;
    if (!here.front) here.normal = -here.normal;
    Look const look =
        settings.looks.empty() ? Look::solid : settings.looks[2 * hit.surface.value + (here.front ? 0 : 1)];
    if (look == Look::solid) {
      seen.solid = here;
      return seen;
    }
    if (look == Look::glass && seen.panes < Sight::most_glass) seen.glass[seen.panes++] = here;
  }
  return seen;
}

std::vector<Seen> seen_by(WorldView const& world, Camera const& camera, LookSettings const& settings) {
  std::vector<Seen> picture(std::size_t{camera.rows} * camera.columns);
  in_parallel(camera.rows, settings.threads, [&](std::size_t row) {
    for (std::uint32_t column = 0; column < camera.columns; ++column)
      picture[row * camera.columns + column] =
          sight(world, camera.ray(column + 0.5, double(row) + 0.5), camera.from, settings).solid;
  });
  return picture;
}

}  // namespace straytrace
