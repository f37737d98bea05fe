// SPDX-License-Identifier: BSD-3-Clause
// Closed surfaces are left exactly as often as they are entered: every line from outside crosses them an even number of
// times, alternately inwards and outwards, and comes out where it should.
#include <gtest/gtest.h>

#include <vector>

#include "contract/geometry/instances.hpp"

namespace straytrace::testing::geometry_closed {
namespace {

// Closed bodies of surfaces whose normals all point outwards.
struct Body {
  std::vector<Cylinder> cylinders;
  std::vector<Disk> disks;
  std::vector<Cone> cones;
  std::vector<Sphere> spheres;
  std::vector<Cap> caps;
  Vec3 centre;
  double size = 1;  // m, radius of a sphere about the centre that holds the body

  template <class F>
  void each(F f) const {
    int id = 0;
    for (auto const& s : cylinders) f(id++, s);
    for (auto const& s : disks) f(id++, s);
    for (auto const& s : cones) f(id++, s);
    for (auto const& s : spheres) f(id++, s);
    for (auto const& s : caps) f(id++, s);
  }
};

Body ball(double radius, Placement where) {
  Body b;
  b.spheres = {sphere(radius, where)};
  b.centre = where.at;
  b.size = radius;
  return b;
}
Body can(double radius, double length, Placement where) {
  Body b;
  Vec3 const half = (0.5 * length) * where.along;
  b.cylinders = {cylinder(radius, -length / 2, length / 2, where)};
  b.disks = {disk(0, radius, {where.at + half, where.along}), disk(0, radius, {where.at - half, -where.along})};
  b.centre = where.at;
  b.size = std::hypot(radius, length / 2);
  return b;
}
// A cone on its base, the tip down: the normal of a cone points away from the axis, that of the base along it.
Body top(double radius, double half_angle, Placement where) {
  Body b;
  b.cones = {cone(0, radius, half_angle, where)};
  Vec3 const base = where.at + (radius / std::tan(half_angle)) * where.along;
  b.disks = {disk(0, radius, {base, where.along})};
  b.centre = base;
  b.size = std::fmax(radius, radius / std::tan(half_angle));
  return b;
}
// A lens of two caps: their axes point to the centres of curvature, so both normals look inwards.
Body lens(double curvature, double radius, Placement where) {
  Body b;
  double const sag = curvature * cap(curvature, 0, radius).depth(radius);
  b.caps = {cap(curvature, 0, radius, {where.at - sag * where.along, where.along}),
            cap(curvature, 0, radius, {where.at + sag * where.along, -where.along})};
  b.centre = where.at;
  b.size = radius;
  return b;
}

struct Crossing {
  int surface = -1;
  double distance = infinity, slope = 0;
  Vec3 at;
};

Crossing next(Body const& body, Ray const& ray, int from, bool know_start) {
  Crossing c;
  body.each([&](int id, auto const& s) {
    double const t = s.distance(ray, know_start && id == from);
    if (!(t < c.distance)) return;
    Vec3 const p = ray.origin + t * ray.dir;
    c = {id, t, dot(s.normal(p), ray.dir), s.project(p)};
  });
  return c;
}

// Crossings of n random lines; `know_start` false: a tracer that forgets where it starts.
bool left_as_often_as_entered(Body const& body, int n, bool know_start = true) {
  Directions random(7);
  for (int i = 0; i < n; ++i) {
    double const far = body.size * (1.1 + 1000 * std::pow(random.uniform(), 8));
    Vec3 const d = random.direction(), aim = body.centre + (random.uniform() * body.size) * random.direction();
    Ray ray{aim - far * d, d};
    if (length(ray.origin - body.centre) <= body.size) continue;
    int from = -1, crossings = 0;
    double last = 0;
    for (; crossings < 10; ++crossings) {
      Crossing const c = next(body, ray, from, know_start);
      if (c.surface < 0) break;
      if (crossings > 0 && c.slope * last > 0) return false;  // twice inwards or twice outwards
      last = c.slope;
      from = c.surface;
      ray.origin = c.at;
    }
    if (crossings != 0 && crossings != 2) return false;  // all bodies here are convex
  }
  return true;
}

TEST(closed_shapes, are_left_as_often_as_entered) {
  for (Placement const& where : placements())
    for (Body const& b : {ball(1, where), ball(1e-3, where), can(0.5, 2, where), can(0.17, 0.2, where),
                          top(0.3, 0.7, where), lens(2, 0.2, where)}) {
      EXPECT_TRUE(left_as_often_as_entered(b, 20000));
      EXPECT_FALSE(left_as_often_as_entered(b, 20000, false)) << "a tracer that forgets where it starts";
    }
}

TEST(closed_shapes, controls_with_a_gap_are_rejected) {
  Body open = can(0.5, 2, {});
  open.disks.pop_back();
  EXPECT_FALSE(left_as_often_as_entered(open, 20000));
  Body short_wall = can(0.5, 2, {});
  short_wall.cylinders[0].to *= 0.999;
  EXPECT_FALSE(left_as_often_as_entered(short_wall, 200000));
  Body small_base = top(0.3, 0.7, {});
  small_base.disks[0].outer_radius *= 0.999;
  EXPECT_FALSE(left_as_often_as_entered(small_base, 200000));
}

}  // namespace
}  // namespace straytrace::testing::geometry_closed
