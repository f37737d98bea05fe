// SPDX-License-Identifier: BSD-3-Clause
// Sorting out surfaces by the rings they lie in loses no hit: at rims, at grazing incidence, from afar
// (docs/develop/performance.md). The control without widening loses hits; and the test is worth its time: nearly all it
// lets pass is hit.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/math/rng.hpp"
#include "support/shapes.hpp"
#include "world/search/search.hpp"

namespace straytrace::world_surface_pack {
namespace {

using testing::cap, testing::cone, testing::cylinder, testing::disk, testing::sphere;

struct Counts {
  int hits = 0, lost = 0, passed = 0, rays = 0;
};

// Rays at points of one shape, every other one near a rim of it; every fourth starts close to its plane.
template <class Shape>
void shoot(Shape const& shape, double hall, double widen, std::uint64_t seed, Counts& counts) {
  Vec3 const origin{900, -200, 40};
  Bvh8::View tree;
  tree.origin = origin;
  tree.largest = hall;
  tree.root = {{-hall, -hall, -hall}, {hall, hall, hall}};
  SurfacePack pack{};
  pack.set(3, search_item(shape), origin, hall, widen);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Rng rng(seed, i, 0, Stream::direction);
    double u = rng.uniform(), v = rng.uniform();
    if (i % 2 == 0) u = u < 0.5 ? 1e-12 * u : 1 - 1e-12 * u;
    Vec3 const at = shape.sample(u, v);
    Vec3 from = Vec3{rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5};
    from = origin + (i % 8 == 1 ? 50 : 2) * hall * from;
    if (i % 4 == 0) from = at + hall * (rng.uniform() * any_normal(shape.axis) + (1e-3 * rng.uniform()) * shape.axis);
    Ray ray{from, unit(at - from)};
    if (i % 5 == 0) ray.dir = unit(ray.dir + 1e-3 * Vec3{rng.uniform(), rng.uniform(), rng.uniform()});
    double const t = shape.distance(ray, false);
    bool const hit = t < infinity;
    double const limit = hit && i % 3 == 0 ? std::nextafter(t, infinity) : infinity;
    bvh8_detail::Probe probe;
    bool const near = probe.set(tree, ray, limit);
    bool const passes = near && (pack.may_be_hit(probe, bvh8_detail::rounded_up(limit - probe.shift)) & 8u);
    counts.hits += hit;
    counts.lost += hit && near && !passes;
    counts.passed += passes;
    ++counts.rays;
  }
}

Counts count(double widen) {
  Counts counts;
  std::uint64_t seed = 0;
  for (double hall : {1.0, 100.0})
    for (int k = 0; k < 12; ++k) {
      Rng rng(9, std::uint64_t(k), 0, Stream::source);
      auto const within = [&](double a, double b) { return a + (b - a) * rng.uniform(); };
      Vec3 const at = Vec3{900, -200, 40} + hall * Vec3{within(-0.5, 0.5), within(-0.5, 0.5), within(-0.5, 0.5)};
      Vec3 const axis = k < 3 ? Vec3{k == 0 ? 1. : 0., k == 1 ? 1. : 0., k == 2 ? 1. : 0.}
                              : unit({within(-1, 1), within(-1, 1), within(-1, 1)});
      double const size = hall * within(0.002, 0.2);
      testing::Placement const pose{at, axis};
      shoot(disk(0.4 * size, size, pose), hall, widen, ++seed, counts);
      shoot(cylinder(size, -0.3 * size, size, pose), hall, widen, ++seed, counts);
      shoot(cylinder(0.01 * size, 0, 5 * size, pose), hall, widen, ++seed, counts);
      shoot(cap(0.5 / size, 0.1 * size, size, pose), hall, widen, ++seed, counts);
      shoot(cone(0.3 * size, size, 0.5, pose), hall, widen, ++seed, counts);
      shoot(sphere(size, pose), hall, widen, ++seed, counts);
    }
  return counts;
}

TEST(surface_pack, loses_no_hit) {
  Counts const c = count(1);
  EXPECT_GT(c.hits, c.rays / 2);
  EXPECT_EQ(c.lost, 0);
}

TEST(surface_pack, control_without_widening_loses_hits) { EXPECT_GT(count(0).lost, 100); }

TEST(surface_pack, rejects_most_misses) {
  Counts const c = count(1);
  EXPECT_LT(c.passed, 1.5 * c.hits);
}

}  // namespace
}  // namespace straytrace::world_surface_pack
