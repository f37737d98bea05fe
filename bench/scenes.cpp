// SPDX-License-Identifier: BSD-3-Clause
#include "scenes.hpp"

#include <cmath>

#include "base/rng.hpp"
#include "optics/lambertian.hpp"

namespace straytrace::bench {
namespace {

class Builder {
 public:
  explicit Builder(World& world) : world_(world) { world.add_optic({}); }
  void disk(double inner, double outer, Vec3 at, Vec3 axis = {0, 0, 1}) {
    Disk s;
    s.inner_radius = inner;
    s.outer_radius = outer;
    add(s, at, axis);
  }
  void cylinder(double radius, double from, double to, Vec3 at, Vec3 axis = {0, 0, 1}) {
    Cylinder s;
    s.radius = radius;
    s.from = from;
    s.to = to;
    add(s, at, axis);
  }
  void cap(double curvature, double radius, Vec3 at, Vec3 axis) {
    Cap s;
    s.curvature = curvature;
    s.inner_radius = 0;
    s.outer_radius = radius;
    add(s, at, axis);
  }
  void sphere(double radius, Vec3 at) {
    Sphere s;
    s.radius = radius;
    add(s, at, {0, 0, 1});
  }

 private:
  template <class Shape>
  void add(Shape s, Vec3 at, Vec3 axis) {
    s.place(facing_along(at, axis));
    world_.add_surface(s, 0, 0, {}, {});
  }
  World& world_;
};

BenchScene tube(char const* name, double length, double radius, int baffles, double aperture) {
  BenchScene scene;
  scene.name = name;
  scene.inward = true;
  Builder build(scene.world);
  build.cylinder(radius, 0, length, {});
  build.disk(0, radius, {});
  build.disk(0, radius, {0, 0, length}, {0, 0, -1});
  build.cap(1 / (0.6 * length), 0.17, {0, 0, 0.4}, {0, 0, 1});
  build.cap(1 / (0.6 * length), 0.17, {0, 0, length - 0.4}, {0, 0, -1});
  double const spacing = length / (baffles + 1);
  for (int k = 1; k <= baffles; ++k) build.disk(aperture, radius, {0, 0, k * spacing});
  scene.world.finish();
  scene.triangles = tessellate(scene.world, 64, spacing);
  return scene;
}

void add_lens(Builder& build, Vec3 at, Vec3 axis, double radius, double thickness, double curvature) {
  build.cap(curvature, radius, at - 0.5 * thickness * axis, axis);
  build.cap(curvature, radius, at + 0.5 * thickness * axis, -axis);
  double const sag = curvature * radius * radius / (1 + std::sqrt(1 - curvature * curvature * radius * radius));
  build.cylinder(radius, -0.5 * thickness + sag, 0.5 * thickness - sag, at, axis);
}

// Ring around a lens, post, foot and a knob: twelve faces.
void add_mount(Builder& build, Vec3 at, Vec3 axis, double radius) {
  Vec3 const up{0, 0, 1};
  build.disk(radius, 1.3 * radius, at - 0.007 * axis, axis);
  build.disk(radius, 1.3 * radius, at + 0.007 * axis, axis);
  build.cylinder(1.02 * radius, -0.007, 0.007, at, axis);
  build.cylinder(1.3 * radius, -0.007, 0.007, at, axis);
  Vec3 const foot = at - (1.3 * radius + 0.06) * up, knob = at + 1.45 * radius * up;
  build.cylinder(0.006, 0.01, 0.055, foot);
  build.disk(0, 0.006, foot + 0.056 * up);
  build.cylinder(0.02, 0, 0.01, foot);
  build.disk(0, 0.02, foot);
  build.disk(0.006, 0.02, foot + 0.01 * up);
  build.cylinder(0.004, 0, 0.01, knob, axis);
  build.disk(0, 0.004, knob + 0.01 * axis, axis);
  build.sphere(0.003, knob - 0.006 * axis);
}

}  // namespace

BenchScene tube3() { return tube("tube3", 3000, 0.5, 200, 0.4); }
BenchScene tube40() { return tube("tube40", 40000, 0.6, 500, 0.45); }

BenchScene optical_bench() {
  BenchScene scene;
  scene.name = "bench";
  Builder build(scene.world);
  Vec3 const half{1.6, 1.2, 0.3};
  for (double side : {-1.0, 1.0}) {  // faces of the box: discs that reach beyond its edges
    build.disk(0, 2.1, {side * half.x, 0, 0}, {-side, 0, 0});
    build.disk(0, 2.1, {0, side * half.y, 0}, {0, -side, 0});
    build.disk(0, 2.1, {0, 0, side * half.z}, {0, 0, -side});
  }
  scene.first_start = 6;
  for (int k = 0; k < 300; ++k) {
    Rng rng(3, std::uint64_t(k), 0, Stream::source);
    double const radius = 0.0127 * (1 + rng.uniform());
    Vec3 const at{-1.5 + 0.15 * (k % 20) + 0.1 * rng.uniform(), -1.1 + 0.15 * (k / 20) + 0.1 * rng.uniform(), 0};
    SinCos const turn = sincos_turn(rng.uniform());
    Vec3 const axis{turn.cos, turn.sin, 0};
    add_lens(build, at, axis, radius, 0.012, 1 / (0.06 + 0.2 * rng.uniform()));
    add_mount(build, at, axis, 1.05 * radius);
  }
  scene.world.finish();
  return scene;
}

namespace {

// Where a diffuse walk stands.
struct Place {
  Departure from;
  Vec3 point, normal;
};
Place start_of(BenchScene const& scene, WorldView const& view, std::uint64_t seed, std::uint64_t number) {
  auto const choices = std::uint32_t(view.surfaces.size) - scene.first_start;
  SurfaceId const first{scene.first_start + std::uint32_t(number % 2 ? 0 : number / 2 % choices)};
  Rng rng(seed, number, 0, Stream::source);
  double const u = rng.uniform(), v = rng.uniform();
  SurfacePoint const at =
      view.shapes.visit(view.surfaces[first.value].shape, [&](auto const& s) { return sample_of(s, u, v); });
  Vec3 const p = view.project(first, at.point, at.piece), n = view.normal(first, p, at.piece);
  return {Departure(first, at.piece), p, scene.inward && dot(n, p) > 0 ? -n : n};
}
constexpr std::uint32_t hops = 1000;  // of one walk

// Direction about the normal.
Vec3 drawn(std::uint64_t seed, std::uint64_t number, std::uint32_t event) {
  Rng rng(seed, number, event, Stream::direction);
  double const x = rng.uniform(), y = rng.uniform();
  return Lambertian{1}.sample({0, 0, 1}, x, y).wo;
}

}  // namespace

void walk(BenchScene const& scene, std::size_t count, std::uint64_t seed, Visit const& visit) {
  WorldView const view = scene.world.view();
  std::size_t done = 0;
  for (std::uint64_t number = 0; done < count; ++number) {
    auto [from, p, n] = start_of(scene, view, seed, number);
    for (std::uint32_t event = 1; event <= hops && done < count; ++event, ++done) {
      Vec3 const local = drawn(seed, number, event);
      Ray const ray{p, unit(Frame::around(n).to_world(local))};
      Hit const hit = view.closest(ray, from);
      visit(ray, from, hit);
      if (!hit.surface.valid()) break;
      from = {hit.surface, hit.piece};
      p = view.project(hit.surface, ray.origin + hit.distance * ray.dir, hit.piece);
      n = view.normal(hit.surface, p, hit.piece);
      if (dot(n, ray.dir) > 0) n = -n;
    }
  }
}

std::vector<BenchRay> walk_rays(BenchScene const& scene, std::size_t count, std::uint64_t seed) {
  std::vector<BenchRay> rays;
  walk(scene, count, seed, [&](Ray const& ray, Departure const& from, Hit const&) { rays.push_back({ray, from}); });
  return rays;
}

std::size_t bounce(BenchScene const& scene, std::size_t count, std::uint64_t seed) {
  std::size_t hits = 0;
  walk(scene, count, seed, [&](Ray const&, Departure const&, Hit const& hit) { hits += hit.surface.valid(); });
  return hits;
}

std::size_t bounce_together(BenchScene const& scene, std::size_t count, std::uint64_t seed) {
  struct Walk {
    std::uint64_t number = 0;
    std::uint32_t event = 0;
    Place at;
    Vec3 local;
    Ray ray;
    Hit hit;
  } walks[8];
  WorldView const view = scene.world.view();
  std::uint64_t number = 0;
  std::size_t hits = 0;
  for (std::size_t done = 0; done < count; done += std::size(walks)) {
    for (Walk& w : walks) {
      if (w.event % hops != 0 && w.hit.surface.valid()) continue;
      w.number = number++;
      w.event = 0;
      w.at = start_of(scene, view, seed, w.number);
    }
    for (Walk& w : walks) w.local = drawn(seed, w.number, ++w.event);
    for (Walk& w : walks) w.ray = {w.at.point, unit(Frame::around(w.at.normal).to_world(w.local))};
    for (Walk& w : walks) w.hit = view.closest(w.ray, w.at.from);
    for (Walk& w : walks)
      if (w.hit.surface.valid()) {
        w.at.from = {w.hit.surface, w.hit.piece};
        w.at.point = view.project(w.hit.surface, w.ray.origin + w.hit.distance * w.ray.dir, w.hit.piece);
      }
    for (Walk& w : walks)
      if (w.hit.surface.valid()) {
        Vec3 const n = view.normal(w.hit.surface, w.at.point, w.hit.piece);
        w.at.normal = dot(n, w.ray.dir) > 0 ? -n : n;
        ++hits;
      }
  }
  return hits;
}

std::vector<BenchRay> mirror_rays(std::size_t count) {
  std::vector<BenchRay> rays;
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(6, i, 0, Stream::direction);
    double const r = 0.17 * std::sqrt(rng.uniform()), angle = 1e-6 * std::pow(3e5, rng.uniform());
    SinCos const place = sincos_turn(rng.uniform()), heading = sincos_turn(rng.uniform());
    SinCos const polar = sincos_turn(angle / (2 * pi));
    rays.push_back(
        {{{r * place.cos, r * place.sin, 0.5}, {polar.sin * heading.cos, polar.sin * heading.sin, polar.cos}}, {}});
  }
  return rays;
}

}  // namespace straytrace::bench
