// SPDX-License-Identifier: BSD-3-Clause
#include "trace/camera/camera.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/process/threads.hpp"
#include "optics/coating/specular.hpp"
#include "trace/step/scatter.hpp"

namespace straytrace::trace {
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

Camera looking_at(Vec3 eye, Vec3 target, Vec3 up, double field, std::uint32_t columns, std::uint32_t rows) {
  Camera camera;
  camera.eye = eye;
  camera.columns = columns;
  camera.rows = rows;
  aim(camera, target - eye, up);
  camera.half_height = std::tan(0.5 * field);
  camera.half_width = camera.half_height * columns / rows;
  return camera;
}

Camera fisheye_at(Vec3 eye, Vec3 target, Vec3 up, double field, std::uint32_t columns, std::uint32_t rows) {
  Camera camera = looking_at(eye, target, up, 1, columns, rows);
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
    if (world.smooth(hit.surface)) {
      Vec3 const smooth = world.smooth_normal(hit.surface, ray.origin, hit.piece);
      here.normal = shading_normal(here.front ? smooth : -smooth, here.normal, ray.dir);
    }
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

namespace {

constexpr std::uint32_t finer = 2;  // rays per pixel along each side
constexpr Rgb background{0.97, 0.97, 0.97};

Rgb mix(Rgb a, Rgb b, double share) {
  return {a.r + share * (b.r - a.r), a.g + share * (b.g - a.g), a.b + share * (b.b - a.b)};
}

// Data of a ray that are kept until all its neighbours are known.
struct Dot {
  Rgb colour;
  Vec3 point, normal;
  double distance = infinity;
  std::uint32_t surface = WorldView::none, group = WorldView::none;
  std::uint64_t glass = 0;  // name of the panes before it
  Vec3 pane;                // normal of the first one
};

Dot dot_of(WorldView const& world, Sight const& s, Vec3 dir, Paint const& paint, double edge_on) {
  Dot d;
  d.colour = background;
  if (s.solid.surface.valid()) {
    double const facing = std::fabs(dot(dir, s.solid.normal));
    d.colour = mix({}, paint(s.solid), edge_on + (1 - edge_on) * facing);
    d.point = s.solid.point;
    d.normal = s.solid.normal;
    d.distance = s.solid.distance;
    d.surface = s.solid.surface.value;
    d.group = world.surfaces[d.surface].group.value;
  }
  for (int i = s.panes; i-- > 0;) {
    double const grazing = 1 - std::fabs(dot(dir, s.glass[i].normal));
    d.colour = mix(d.colour, paint(s.glass[i]), 0.13 + 0.6 * grazing * grazing * grazing);
    d.glass = d.glass * 1000003 + s.glass[i].surface.value + 1;
    d.pane = s.glass[i].normal;
  }
  return d;
}

// Strength of the line between two neighbours: outlines of groups, creases, one part of a surface before another.
double edge(Dot const& a, Dot const& b) {
  if (a.group != b.group) return 0.75;
  double ink = 0;
  if (a.surface != WorldView::none) {
    double const step = std::fabs(dot(b.point - a.point, a.normal));
    bool const crease = dot(a.normal, b.normal) < 0.8;
    bool const apart = step > 0.03 * std::min(a.distance, b.distance);
    if (crease || apart) ink = 0.5;
  }
  if (a.glass != b.glass || (a.glass != 0 && dot(a.pane, b.pane) < 0.8)) ink = std::max(ink, 0.4);
  return ink;
}

std::uint8_t byte(double x) { return std::uint8_t(std::lround(255 * std::clamp(x, 0.0, 1.0))); }

}  // namespace

std::vector<std::uint8_t> shaded(WorldView const& world, Camera const& camera, LookSettings const& settings,
                                 Paint const& paint, std::vector<bool>& visible, double edge_on) {
  std::size_t const wide = std::size_t{camera.columns} * finer;
  std::uint32_t const high = camera.rows * finer;
  std::vector<Dot> dots(wide * high);
  std::vector<std::atomic<bool>> seen(world.surfaces.size);
  in_parallel(high, settings.threads, [&](std::size_t row) {
    for (std::size_t column = 0; column < wide; ++column) {
      Ray const ray = camera.ray((double(column) + 0.5) / finer, (double(row) + 0.5) / finer);
      Sight const s = sight(world, ray, camera.from, settings);
      if (s.solid.surface.valid()) seen[s.solid.surface.value] = true;
      for (int i = 0; i < s.panes; ++i) seen[s.glass[i].surface.value] = true;
      dots[row * wide + column] = dot_of(world, s, ray.dir, paint, edge_on);
    }
  });
  visible.assign(seen.begin(), seen.end());
  std::vector<std::uint8_t> rgb(std::size_t{3} * camera.columns * camera.rows);
  in_parallel(camera.rows, settings.threads, [&](std::size_t row) {
    for (std::size_t column = 0; column < camera.columns; ++column) {
      Rgb sum;
      for (std::uint32_t k = 0; k < finer * finer; ++k) {
        std::size_t const x = column * finer + k % finer, y = row * finer + k / finer;
        Dot const& d = dots[y * wide + x];
        double ink = 0;
        if (x + 1 < wide) ink = edge(d, dots[y * wide + x + 1]);
        if (y + 1 < high) ink = std::max(ink, edge(d, dots[(y + 1) * wide + x]));
        Rgb const c = mix(d.colour, {0.1, 0.1, 0.12}, ink);
        sum = {sum.r + c.r, sum.g + c.g, sum.b + c.b};
      }
      std::uint8_t* const out = &rgb[3 * (row * camera.columns + column)];
      double const scale = 1.0 / (finer * finer);
      out[0] = byte(scale * sum.r);
      out[1] = byte(scale * sum.g);
      out[2] = byte(scale * sum.b);
    }
  });
  return rgb;
}

namespace {

constexpr std::uint32_t flash_rays = 3;  // rays per pixel along each side

// Whether a ray meets the sphere around the eye before the next surface, `free` metres away.
bool comes_back(Ray const& ray, Vec3 eye, double radius, double free) {
  double const along = dot(eye - ray.origin, ray.dir);
  return along > 0 && along < free + radius && length(ray.origin + along * ray.dir - eye) < radius;
}

struct FlashWay {
  PathState path;       // power: share that passes one way
  double distance = 0;  // m from the eye to the start of the ray
  int mirrors = 0;
};

// The next directions of the path; straight ahead through surfaces that are not drawn.
void follow(WorldView const& world, FlashWay const& way, Vertex const& at, Flash const& flash,
            std::vector<FlashWay>& waiting) {
  auto const leave = [&](double share, SpecularWay const& out) {
    double const power = way.path.power * share;
    if (!(power > flash.faintest)) return;
    FlashWay next = way;
    ++next.mirrors;
    next.path.power = power;
    next.path.from = {at.surface, at.piece, at.contact};
    next.path.ray.origin = at.point;
    next.path.media = at.before;
    leave_specular(world, next.path, at, out);
    waiting.push_back(next);
  };
  Vec3 const travel = way.path.ray.dir;
  for (bool const through : {false, true}) {
    if (at.optic->diffracts)
      for_each_order(world, at, travel, through, [&](SpecularWay const& order) { leave(order.share, order); });
    else
      leave(through ? at.transmit : at.reflect, specular_way(world, travel, at, through, 0));
  }
}

}  // namespace

FlashLight flash_along(WorldView const& world, Ray ray, Departure from, Vec3 eye, Flash const& flash,
                       std::vector<Look> const& looks) {
  FlashLight seen;
  FlashWay start;
  start.path.ray = ray;
  start.path.from = from;
  start.path.power = 1;
  std::vector<FlashWay> waiting{start};
  while (!waiting.empty()) {
    FlashWay way = waiting.back();
    waiting.pop_back();
    Hit const hit = world.closest(way.path.ray, way.path.from);
    double const free = hit.surface.valid() ? hit.distance : infinity;
    if (way.mirrors > 0 && comes_back(way.path.ray, eye, flash.radius, free)) {
      seen.glint += way.path.power / (pi * flash.radius * flash.radius);
      continue;
    }
    if (!hit.surface.valid()) continue;
    Vertex at = vertex_at(world, way.path, hit);
    way.distance += hit.distance;
    if (!looks.empty() && looks[2 * at.surface.value + (at.front ? 0 : 1)] == Look::open) {
      way.path.from = {at.surface, at.piece};
      way.path.ray.origin = at.point;
      waiting.push_back(way);
      continue;
    }
    if (!seen.first.valid()) seen.first = at.surface;
    lost_in_medium(world, way.path, hit.distance);
    evaluate_scattering(world, way.path, way.path.ray.dir, at);
    if (at.albedo > 0)
      seen.scattered += way.path.power * way.path.power *
                        scatter_eval(world.laws, *at.optic, at.wi, at.wi, at.n_in, at.n_out) * at.wi.z /
                        (way.distance * way.distance);
    if (way.mirrors < flash.most_mirrors) follow(world, way, at, flash, waiting);
  }
  return seen;
}

std::vector<FlashLight> flash_picture(WorldView const& world, Camera const& camera, Flash const& flash,
                                      LookSettings const& settings) {
  std::vector<FlashLight> picture(std::size_t{camera.rows} * camera.columns);
  in_parallel(camera.rows, settings.threads, [&](std::size_t row) {
    for (std::uint32_t column = 0; column < camera.columns; ++column) {
      FlashLight& pixel = picture[row * camera.columns + column];
      for (std::uint32_t k = 0; k < flash_rays * flash_rays; ++k) {
        Ray const ray =
            camera.ray(column + (k % flash_rays + 0.5) / flash_rays, double(row) + (k / flash_rays + 0.5) / flash_rays);
        if (!(ray.t_max > 0)) continue;
        FlashLight const one = flash_along(world, ray, camera.from, camera.eye, flash, settings.looks);
        pixel.scattered += one.scattered / (flash_rays * flash_rays);
        pixel.glint += one.glint / (flash_rays * flash_rays);
        if (k == flash_rays * flash_rays / 2) pixel.first = one.first;
      }
    }
  });
  return picture;
}

double solid_angle(Camera const& c, std::uint32_t column, std::uint32_t row) {
  double const x = (2 * (column + 0.5) / c.columns - 1) * c.half_width,
               y = (1 - 2 * (row + 0.5) / c.rows) * c.half_height,
               area = 4 * c.half_width * c.half_height / (double(c.columns) * c.rows), r = std::sqrt(x * x + y * y);
  if (c.lens == Camera::Lens::perspective) return area / std::pow(1 + r * r, 1.5);
  return r > 0 && c.lens == Camera::Lens::fisheye ? area * std::sin(std::min(r, pi)) / r : area;
}

}  // namespace straytrace::trace
