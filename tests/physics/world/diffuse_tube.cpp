// SPDX-License-Identifier: BSD-3-Clause
// Zero lost rays and zero wrong hits in 1e7 diffuse bounces of the closed baffled tube at 3 km and at 40 km
// (docs/develop/performance.md): every hit of the search structure is checked against 80-bit arithmetic that is given
// between which baffles the ray starts. Everything is a Lambertian wall, so every direction occurs at every place.
#include <gtest/gtest.h>

#include <string>

#include "support/exact_tube.hpp"
#include "support/recorded.hpp"

namespace straytrace::world_diffuse_tube {
namespace {

using namespace testing;

void expect_exact(Tube const& tube, long long bounces, std::uint64_t seed) {
  TubeScene const scene(tube);
  WorldView const view = scene.world.view();
  Tally const t = walk(scene, bounces, seed, [&](Ray const& r, SurfaceId from) { return view.closest(r, from); });
  EXPECT_EQ(t.bounces, bounces);
  EXPECT_GT(t.seen.size(), 0.95 * view.surfaces.size);  // nearly every baffle was met
  EXPECT_TRUE(exact_to_rounding(t)) << "lost " << t.lost << ", wrong " << t.wrong << ", self " << t.self
                                    << ", worst error " << t.worst_error;
  ::testing::Test::RecordProperty("worst_error", std::to_string(t.worst_error));
}

TEST(diffuse_tube, ten_million_bounces_over_3_km) { expect_exact(tube3, 10'000'000, 1); }
TEST(diffuse_tube, ten_million_bounces_over_40_km) { expect_exact(tube40, 10'000'000, 2); }

// Negative control: a tracer without the number of its start surface hits it again at zero distance.
TEST(diffuse_tube, control_without_the_start_surface_is_rejected) {
  for (Tube const& tube : {tube3, tube40}) {
    TubeScene const scene(tube);
    WorldView const view = scene.world.view();
    Tally const t = walk(scene, 100'000, 3, [&](Ray const& r, SurfaceId) { return view.closest(r, {}); });
    EXPECT_FALSE(exact_to_rounding(t));
    EXPECT_GT(t.self, 1000);
  }
}

// A walk through a search structure whose clear apertures are `widening` times the true ones.
Tally walk_with_apertures(Tube const& tube, double widening) {
  TubeScene const scene(tube);
  WorldView view = scene.world.view();
  View<TubeItem const> const true_items = view.tree.tubes.items;
  std::vector<TubeItem> items(true_items.data, true_items.data + true_items.size);
  for (TubeItem& item : items) {
    item.clear2 *= widening * widening;
    for (double& skip : item.skip2) skip *= widening * widening;
  }
  view.tree.tubes.items = {items.data(), items.size()};
  return walk(scene, 200'000, 4, [&](Ray const& r, SurfaceId from) { return view.closest(r, from); });
}

// Negative control: apertures 1 % too wide skip the inner edges of the baffles.
TEST(diffuse_tube, control_with_wider_apertures_is_rejected) {
  for (Tube const& tube : {tube3, tube40}) {
    EXPECT_TRUE(exact_to_rounding(walk_with_apertures(tube, 0.999999)));
    Tally const t = walk_with_apertures(tube, 1.01);
    EXPECT_FALSE(exact_to_rounding(t));
    EXPECT_GT(t.wrong, 10);
  }
}

}  // namespace
}  // namespace straytrace::world_diffuse_tube
