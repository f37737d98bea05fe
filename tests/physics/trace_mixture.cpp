// SPDX-License-Identifier: BSD-3-Clause
// The mixture of scatter law and targets (estimators.md 6, 8): scene 16, and what a wrong table does to the books.
#include <gtest/gtest.h>

#include "base/message.hpp"
#include "shapes.hpp"
#include "trace/estimate/importance.hpp"
#include "trace_support.hpp"

namespace straytrace::testing {
namespace {

constexpr double rho = 0.9;

// A closed sphere of two hemispheres, lit evenly on a spot of one of them: power arriving per emitted 1/(1 - rho).
World two_caps() {
  World world;
  std::uint32_t const white = lambertian_optic(world, rho), black = black_optic(world);
  BodyId const body = world.add_body("sphere", {});
  SurfaceId const below =
      world.add_surface(cap(1, 0, 1, {{0, 0, -1}, {0, 0, 1}}), white, black, body, world.add_group("below"));
  world.add_surface(cap(1, 0, 1, {{0, 0, 1}, {0, 0, -1}}), white, black, body, world.add_group("above"));
  world.add_footprint(spot(below, {0, 0, -1}, {0, 0, -1}, Profile::even, 0.3));
  world.limits.max_order = 400;
  world.limits.roulette_below = 1e-3;
  world.finish();
  return world;
}

// Targets of uneven shares on four strips of each cap, and adjoints that make the window work. `hole`: strip 4 is on no
// list.
SteeringTables uneven(double alpha, bool hole = false) {
  SteeringTables t;
  for (std::uint32_t surface = 0; surface < 2; ++surface) {
    t.first_of_surface.push_back(std::uint32_t(t.strips.size()));
    double const edges[] = {0, 0.1, 0.35, 0.4, 1};
    for (int i = 0; i < 4; ++i)
      t.strips.push_back({{surface}, edges[i], edges[i + 1], (edges[i + 1] - edges[i]) * 2 * pi});
  }
  t.first_of_surface.push_back(8);
  double const shares[] = {0.02, 0.2, 0.05, 0.2, hole ? 0 : 0.03, 0.25, 0.01, 0.24};
  double so_far = 0;
  for (std::uint32_t i = 0; i < 8; ++i)
    if (shares[i] > 0) t.targets.push_back({i, shares[i], so_far += shares[i]});
  for (int side = 0; side < 16; ++side) t.sides.push_back({1 + 0.1 * side, alpha, 0, std::uint32_t(t.targets.size())});
  t.level = 1;
  return t;
}

SampleMean arriving(World& world, TraceResult const& r) {
  SampleMean const a = arrived(world, r, "below"), b = arrived(world, r, "above");
  return {a.mean + b.mean, a.std_error + b.std_error, a.n};  // errors of the two are correlated: added, not squared
}

TEST(Mixture, ArrivingPowerScene16) {
  for (double const alpha : {0.1, 0.5, 0.9}) {
    World world = two_caps();
    world.steer(uneven(alpha));
    TraceResult const r = run_histories(world, 1 << 17);
    expect_mean("arriving power, 1/(1 - rho)", arriving(world, r), 10, 0.5);
    double sum = 0;
    for (Moments const& column : r.total.ledger) sum += column.sum;
    EXPECT_NEAR(sum / r.total.emitted.sum, 1, 1e-12);
    for (Fate const fate : {Fate::sampling, Fate::window}) {
      Estimate const e = estimate(r.total.ledger[int(fate)], r.total.histories, r.total.blocks);
      EXPECT_GT(e.std_error, 0);
      EXPECT_LT(std::fabs(e.mean), 5 * e.std_error);
    }
  }
}

// Twin: patch areas wrong by a few per cent leave a mean in `sampling`, which the books refuse.
TEST(Mixture, WrongAreasAreRefused) {
  World world = two_caps();
  SteeringTables tables = uneven(0.1);
  for (Strip& s : tables.strips) s.area *= 1.03;
  world.steer(tables);
  EXPECT_THROW(run_histories(world, 1 << 17), NumericalError);
}

// Twin: nothing is ever drawn by the law, and one strip is on no list (alpha = 0 with a hole).
TEST(Mixture, ExclusiveListsAreRefused) {
  World world = two_caps();
  world.steer(uneven(0, true));
  EXPECT_THROW(run_histories(world, 1 << 17), NumericalError);
}

}  // namespace
}  // namespace straytrace::testing
