// SPDX-License-Identifier: BSD-3-Clause
// Histories in flight together leave the same sums as one after the other (docs/develop/architecture.md).
#include "trace/step/flight.hpp"

#include <gtest/gtest.h>

#include "support/mesh_shapes.hpp"
#include "support/shapes.hpp"
#include "support/trace_support.hpp"
#include "trace/tally/block_sink.hpp"

namespace straytrace::testing {
namespace {

// A bright room with a body in it: paths of very different lengths, split in three at the first.
World bright_room() {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const bright = lambertian_optic(world, 0.9), dark = lambertian_optic(world, 0.2);
  SurfaceId const lit =
      world.add_surface(Disk{{0, 0, -1}, {0, 0, 1}, 0, 0.5}, dark, dark, body, world.add_group("lit"));
  world.add_surface(mesh_of(bumpy(8, 0.1), facing_along({0.3, 0.2, 0.4}, {0, 0, 1}), 0.3), dark, dark, body,
                    world.add_group("rock"));
  world.add_surface(sphere(3), bright, bright, body, world.add_group("wall"));
  world.add_footprint(spot(lit, {0, 0, -1}, {0, 0, -1}, Profile::gaussian, 0.05, world.add_port("port")));
  world.limits.max_order = 300;
  world.limits.roulette_below = 0.3;
  world.limits.children = 3;
  world.finish();
  return world;
}

TEST(Flight, SameSumsAsOneByOne) {
  World const world = bright_room();
  WorldView const view = world.view();
  constexpr std::uint64_t first = 100, last = 1100;
  std::vector<HistoryTally> alone;
  for (std::uint64_t h = first; h < last; ++h) {
    alone.emplace_back(view, 1).begin(h);
    trace_history(view, 1, h, alone.back());
  }
  BlockSink by_one(view, world.groups().size(), 0), together(view, world.groups().size(), 0);
  BlockSink reversed(view, world.groups().size(), 0);
  for (HistoryTally const& t : alone) by_one.add(t);
  for (std::size_t i = alone.size(); i-- > 0;) reversed.add(alone[i]);

  std::vector<History> room = Flight<HistoryTally>::room();
  for (History& left : room) {  // by another history, in the middle of its path
    NullSink deaf;
    left.begin(7000);
    ASSERT_TRUE(begin(view, 2, left, deaf) && step(view, 2, left, deaf));
    ASSERT_GT(left.children, 0u);
  }
  std::vector<std::uint64_t> landed;
  Flight<HistoryTally> flight(view, 1, room);
  auto const land = [&](HistoryTally const& tally) {
    landed.push_back(tally.history());
    together.add(tally);
  };
  flight.run(first, 400, land);
  flight.run(400, last, land);

  ASSERT_EQ(landed.size(), last - first);
  for (std::size_t i = 0; i < landed.size(); ++i) EXPECT_EQ(landed[i], first + i);
  BlockSums const expected = by_one.finish();
  EXPECT_TRUE(same(expected, together.finish()));
  EXPECT_FALSE(same(expected, reversed.finish())) << "a control that adds the last history first";
  EXPECT_GT(expected.bounces, 10000u);
  std::uint64_t longest = 0;  // far longer than the others: they wait for it
  for (HistoryTally const& t : alone) longest = std::max(longest, t.bounces());
  EXPECT_GT(longest, 3 * expected.bounces / (last - first));
}

TEST(Flight, WithoutHistories) {
  World const world = bright_room();
  WorldView const view = world.view();
  std::vector<History> room = Flight<HistoryTally>::room();
  Flight<HistoryTally> flight(view, 1, room);
  flight.run(5, 5, [](HistoryTally const&) { FAIL(); });
}

}  // namespace
}  // namespace straytrace::testing
