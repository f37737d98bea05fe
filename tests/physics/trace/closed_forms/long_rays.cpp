// SPDX-License-Identifier: BSD-3-Clause
// Rays of 10 km and scenes far from the origin (docs/theory/sampling.md): an edge 1 um off the ray, a corner
// cube, and the rigid motion of a whole scene by 1e5 m with an arbitrary rotation.
#include <random>

#include "support/shapes.hpp"
#include "support/trace_support.hpp"

namespace straytrace::testing::trace_long_rays {
namespace {

// 1e5 m away and turned somehow.
Pose far_away() {
  Frame const f = Frame::around(unit({0.4, -0.7, 0.59}));
  double const c = std::cos(1.1), s = std::sin(1.1);
  return {{6e4, -7e4, 4e4}, c * f.e1 + s * f.e2, c * f.e2 - s * f.e1, f.e3};
}
Ray moved(Pose const& to, Ray const& r) { return {to.point(r.origin), unit(to.direction(r.dir)), r.t_max}; }

// A world of black or mirrored surfaces, placed in a frame of the test's choice.
class Zoo {
 public:
  explicit Zoo(Pose const& frame) : frame_(frame), body_(world.add_body("all", {})), group_(world.add_group("all")) {}
  template <class Shape>
  void add(Shape shape, Pose const& where) {
    shape.place(nested(frame_, where));
    std::uint32_t const black = black_optic(world);
    world.add_surface(shape, black, black, body_, group_);
  }
  World world;

 private:
  Pose frame_;
  BodyId body_;
  GroupId group_;
};

// Rims of every kind along 10 km, each 1 um outside the ray along z; `shifted`: that one is moved by 2 um into it.
int first_hit(Pose const& frame, int shifted) {
  Zoo zoo(frame);
  int number = 0;
  double z = 1000;
  Pose const along{{}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, across{{}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  auto const rim = [&](auto const& shape, double radius, bool hole, Pose pose) {
    double const gap = number++ == shifted ? -1e-6 : 1e-6;
    pose.origin = {0, hole ? radius - gap : radius + gap, z};
    zoo.add(shape, pose);
    z += 1100;
  };
  rim(disk(0, 0.5), 0.5, false, along);
  rim(disk(0.5, 0.6), 0.5, true, along);
  rim(cylinder(0.3, -0.1, 0.1), 0.3, false, across);
  rim(cone(0.4, 0.6, pi / 4), 0.4, true, along);
  rim(cap(1 / 1683.0, 0, 0.175), 0.175, false, along);
  rim(cap(-0.5, 0.1, 0.2), 0.1, true, along);
  rim(rectangle(1, 1), 0.5, false, along);
  rim(sphere(0.25), 0.25, false, along);
  zoo.add(disk(0, 1), {{0, 0, 1e4}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  zoo.world.finish();
  Hit const hit = zoo.world.view().closest(moved(frame, {{}, {0, 0, 1}}), {});
  return hit.surface.valid() ? int(hit.surface.value) : -1;
}
TEST(LongRays, EdgesOneMicrometreAwayScene14) {
  for (Pose const& frame : {Pose{}, far_away()}) {
    EXPECT_EQ(first_hit(frame, -1), 8);  // the screen at 10 km
    for (int i = 0; i < 8; ++i) EXPECT_EQ(first_hit(frame, i), i);
  }
}

// Thirty shapes of many kinds within 40 m, seen from 10 km and from among them.
void fill(Zoo& zoo) {
  std::mt19937_64 engine(14);
  std::uniform_real_distribution<double> uniform(-1, 1);
  auto const pose = [&] {
    Vec3 const at{20 * uniform(engine), 20 * uniform(engine), 20 * uniform(engine)};
    return facing_along(at, unit({uniform(engine), uniform(engine), uniform(engine)}));
  };
  for (int i = 0; i < 3; ++i) {
    zoo.add(disk(0.2, 4), pose());
    zoo.add(cap(0.1, 0, 5), pose());
    zoo.add(cylinder(3, -2, 2), pose());
    zoo.add(cone(1, 4, 0.8), pose());
    zoo.add(sphere(2.5), pose());
    zoo.add(rectangle(6, 5, 1, 2), pose());
    zoo.add(polygon(6, 4), pose());
    zoo.add(cuboid(4, 3, 5), pose());
    zoo.add(torus(3, 1), pose());
    zoo.add(conic(0.1, -1, 0, 4), pose());
  }
  zoo.world.finish();
}
struct Comparison {
  int same = 0, other = 0;
  double largest = 0;  // m between hit points, where light does not graze
};
Comparison compare(Pose const& frame, int rays) {
  Zoo here({}), there(frame);
  fill(here);
  fill(there);
  WorldView const a = here.world.view(), b = there.world.view();
  std::mt19937_64 engine(15);
  std::normal_distribution<double> normal;
  Comparison c;
  for (int i = 0; i < rays; ++i) {
    Vec3 const target{8 * normal(engine), 8 * normal(engine), 8 * normal(engine)};
    Vec3 const along = unit({normal(engine), normal(engine), normal(engine)});
    Ray const ray{target - (i % 2 ? 1e4 : 5.0) * along, along}, other = moved(far_away(), ray);
    Hit const one = a.closest(ray, {}), two = b.closest(other, {});
    ++(one.surface == two.surface ? c.same : c.other);
    if (!one.surface.valid() || one.surface != two.surface) continue;
    Vec3 const p = ray.origin + one.distance * ray.dir, q = other.origin + two.distance * other.dir;
    if (std::fabs(dot(a.normal(one.surface, p), along)) < 0.05) continue;
    c.largest = std::fmax(c.largest, length(far_away().local_point(q) - p));
  }
  return c;
}
// Control: a frame turned by 1e-10 rad more.
TEST(LongRays, RigidMotionOfAWholeSceneScene14) {
  Comparison const c = compare(far_away(), 40000);
  EXPECT_EQ(c.other, 0);
  EXPECT_GT(c.same, 0);
  EXPECT_LT(c.largest, 1e-9);
  Pose turned = far_away();
  turned.e1 = turned.e1 + 1e-10 * turned.e2;
  turned.e2 = turned.e2 - 1e-10 * turned.e1;
  EXPECT_GT(compare(turned, 4000).largest, 1e-9);
}

// Light goes 10 km to a corner cube and back, here and 1e5 m away. Control: one mirror tilted by 1e-9 rad.
double corner_cube(Pose const& frame, double tilt, Vec3& end) {
  Zoo zoo(frame);
  Frame const cube = Frame::around(unit({0.3, -0.5, 0.8}));
  Vec3 const centre{0, 0, 1e4};
  for (Vec3 const normal : {cube.e1, cube.e2, unit(cube.e3 + tilt * cube.e1)})
    zoo.add(disk(0, 5), facing_along(centre, normal));
  zoo.world.finish();
  WorldView const view = zoo.world.view();
  Vec3 const along = -unit(cube.e1 + 0.8 * cube.e2 + 0.7 * cube.e3);
  Ray ray = moved(frame, {centre - 1e4 * along + 0.3 * cube.e1 - 0.05 * cube.e2, along});
  Vec3 const before = ray.dir;
  Departure from;
  for (int i = 0; i < 3; ++i) {
    Hit const hit = view.closest(ray, from);
    if (!hit.surface.valid()) return infinity;
    Vec3 const p = view.project(hit.surface, ray.origin + hit.distance * ray.dir);
    ray = {p, unit(reflected(ray.dir, view.normal(hit.surface, p)))};
    from = {hit.surface};
  }
  EXPECT_FALSE(view.closest(ray, from).surface.valid());
  end = frame.local_point(ray.origin + 1e4 * ray.dir);
  return length(ray.dir + before);
}
TEST(LongRays, CornerCubeScene14) {
  Vec3 here, there;
  EXPECT_LT(corner_cube({}, 0, here), 1e-12);
  EXPECT_LT(corner_cube(far_away(), 0, there), 1e-12);
  EXPECT_LT(length(here - there), 1e-8);  // directions carry 1e-12 over 10 km
  EXPECT_GT(corner_cube(far_away(), 1e-9, there), 1e-12);
  EXPECT_GT(length(here - there), 1e-8);
}

}  // namespace
}  // namespace straytrace::testing::trace_long_rays
