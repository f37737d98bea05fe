// SPDX-License-Identifier: BSD-3-Clause
#include "scenes.hpp"

#include <cmath>

#include "base/math/rng.hpp"

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

}  // namespace straytrace::bench
