// SPDX-License-Identifier: BSD-3-Clause
// The numbers of requirements R3.11 to R3.16 and R3.20, each with a variant that must miss them.
#include <gtest/gtest.h>

#include "base/math/rng.hpp"
#include "geometry/shape_types.hpp"
#include "support/shapes.hpp"

namespace straytrace {
namespace {

using testing::cap, testing::cone, testing::cylinder, testing::disk, testing::sphere;

double apart(Vec3 a, Vec3 b) { return length(a - b); }

TEST(geometry_numbers, sphere_r3_11) {
  Sphere const s = sphere(1, {{0, 0, 5}});
  Ray const ray{{0, 0.6, 0}, {0, 0, 1}};
  EXPECT_NEAR(s.distance(ray, false), 4.2, 1e-15);
  EXPECT_LT(apart(s.normal({0, 0.6, 4.2}), {0, 0.6, -0.8}), 1e-15);
  EXPECT_NEAR(s.distance({{0, 0.6, 4.2}, {0, 0, 1}}, true), 1.6, 1e-15);  // exit
  EXPECT_GT(std::fabs(sphere(1.001, {{0, 0, 5}}).distance(ray, false) - 4.2), 1e-4);
}

// A line that touches a sphere at its own start point has no second root elsewhere.
TEST(geometry_numbers, tangent_at_the_start_point) {
  for (double r : {1e-3, 1.0, 1683.0})
    for (Vec3 n : {unit({0.3, -0.5, 0.7}), unit({1, 0.02, 1e-3}), Vec3{0, 0, 1}}) {
      Frame const f = Frame::around(n);
      for (Vec3 d : {f.e1, f.e2, -f.e1, unit(f.e1 + f.e2)}) {
        double const t = sphere(r).distance({r * n, d}, false);
        EXPECT_TRUE(t == infinity || t < 1e-7 * r) << t;
      }
    }
}

TEST(geometry_numbers, cap_r3_12) {
  double const high = cap(1 / 1683.0, 0, 0.175).extent().high;
  EXPECT_NEAR(high, 9.098e-6, 5e-10);  // sag of a 0.35 m mirror of RoC 1683 m
  EXPECT_NEAR(high, 0.175 * 0.175 / (2 * 1683), 1e-13);
  EXPECT_TRUE(impossible(cap(1 / 0.17, 0, 0.175)).what.size() > 0);  // aperture wider than the sphere
  EXPECT_TRUE(impossible(cap(1 / 1683.0, 0, 0.175)).what.empty());
}

TEST(geometry_numbers, cap_keeps_the_hemisphere_at_its_vertex) {
  Cap const c = cap(1, 0, 0.5);
  EXPECT_NEAR(c.distance({{0, 0, 1}, {0, 0, -1}}, false), 1, 1e-15);
  EXPECT_EQ(c.distance({{0, 0, 1}, {0, 0, 1}}, false), infinity);  // the far pole of the same sphere
  EXPECT_EQ(c.distance({{0.6, 0, 1}, {0, 0, -1}}, false), infinity);
}

TEST(geometry_numbers, cylinder_r3_13) {
  Cylinder const c = cylinder(0.6, 0, 3000);
  double const angle = 4e-4;
  double const t = c.distance({{0, 0, 0}, {std::sin(angle), 0, std::cos(angle)}}, false);
  EXPECT_NEAR(t * std::cos(angle), 1499.99992, 1e-6);
  EXPECT_EQ(c.distance({{0.1, 0, 0}, {0, 0, 1}}, false), infinity);  // parallel to the axis
  EXPECT_EQ(c.distance({{0.6, 0, 0}, {0, 0, 1}}, false), infinity);
  EXPECT_GT(std::fabs(cylinder(0.6001, 0, 3000).distance({{0, 0, 0}, {std::sin(angle), 0, std::cos(angle)}}, false) *
                          std::cos(angle) -
                      1499.99992),
            0.1);
}

TEST(geometry_numbers, annulus_r3_15) {
  Disk const d = disk(0.176, 0.4);
  EXPECT_EQ(d.distance({{0.1759, 0, -1}, {0, 0, 1}}, false), infinity);
  EXPECT_EQ(d.distance({{0.1761, 0, -1}, {0, 0, 1}}, false), 1);
  EXPECT_EQ(d.distance({{0, 0.3999, 1}, {0, 0, -1}}, false), 1);
  EXPECT_EQ(d.distance({{0, 0.4001, 1}, {0, 0, -1}}, false), infinity);
}

// Base R = 1 at z = 0, tip at z = H = 1: the rim of zero radius is placed at the tip and opens downwards.
TEST(geometry_numbers, cone_r3_16) {
  Cone const c = cone(0, 1, pi / 4, {{0, 0, 1}, {0, 0, -1}});
  EXPECT_NEAR(c.distance({{2, 0, 0.5}, {-1, 0, 0}}, false), 1.5, 1e-15);
  EXPECT_LT(apart(c.normal({0.5, 0, 0.5}), unit({1, 0, 1})), 1e-15);
  // Parallel to a generator: one root, linear. The line x + z = 0 meets the cone at (-0.5, 0, 0.5).
  EXPECT_NEAR(c.distance({{0, 0, 0}, unit({-1, 0, 1})}, false), std::sqrt(0.5), 1e-14);
}

// Gradient of rho^2 - R^2 (1 - z/H)^2: along (H/R, 1) in (rho, z), not (R/H, 1).
TEST(geometry_numbers, cone_normals_at_other_half_angles) {
  for (double half : {20 * pi / 180, 35 * pi / 180, 70 * pi / 180}) {
    double const r = 1, h = 1 / std::tan(half);
    Cone const c = cone(0, r, half, {{0, 0, h}, {0, 0, -1}});
    Vec3 const p{0.5 * r, 0, 0.5 * h};
    EXPECT_LT(apart(c.normal(p), unit({h / r, 0, 1})), 1e-14);
    EXPECT_GT(apart(c.normal(p), unit({r / h, 0, 1})), 0.1);
  }
}

// R3.20: 1e7 hits inside a sphere of radius 1683 m whose centre lies at 3 km, no self-hit. After every bounce the chord
// is 2 R cos(angle of reflection). The control forgets the start surface.
int self_hits(int bounces, bool know_start) {
  Sphere const s = sphere(1683, {{0, 0, 3000}});
  Rng rng(1, 0, 0, Stream::direction);
  Vec3 p = s.project({100, 20, 4000});
  int self = 0;
  for (int i = 0; i < bounces; ++i) {
    double const z = std::sqrt(1 - rng.uniform()), r = std::sqrt(1 - z * z);
    SinCos const a = sincos_turn(rng.uniform());
    Vec3 const n = s.normal(p), d = Frame::around(-n).to_world({r * a.cos, r * a.sin, z});
    double const t = s.distance({p, d}, know_start), chord = 2 * 1683 * z;
    self += !(std::fabs(t - chord) < 1e-9);
    p = s.project(p + chord * d);
  }
  return self;
}

TEST(geometry_numbers, ten_million_hits_without_a_self_hit_r3_20) {
  EXPECT_EQ(self_hits(10'000'000, true), 0);
  EXPECT_GT(self_hits(100'000, false), 1000);
}

TEST(geometry_numbers, impossible_shapes_are_errors) {
  EXPECT_FALSE(impossible(disk(0.4, 0.3)).what.empty());
  EXPECT_FALSE(impossible(disk(0.4, 0.4)).suggestion.empty());
  EXPECT_FALSE(impossible(cylinder(1, 2, 1)).what.empty());
  EXPECT_FALSE(impossible(cone(0.5, 0.4, 0.3)).what.empty());
  EXPECT_FALSE(impossible(cap(0, 0.3, 0.2)).what.empty());
  EXPECT_TRUE(impossible(disk(0.3, 0.4)).what.empty());
  EXPECT_TRUE(impossible(cylinder(1, 1, 2)).what.empty());
  EXPECT_TRUE(impossible(cone(0.4, 0.5, 0.3)).what.empty());
  EXPECT_TRUE(impossible(sphere(1)).what.empty());
}

}  // namespace
}  // namespace straytrace
