// SPDX-License-Identifier: BSD-3-Clause
// Exchange of light between patches of which most trace one line (docs/theory/sampling.md, eq. 1.23 and 1.24), against
// the table of which all lines are traced.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "support/shapes.hpp"
#include "support/trace_received.hpp"
#include "trace/importance/importance.hpp"
#include "trace/importance/steering_tables.hpp"

namespace straytrace::testing {
namespace {

// Many plates in a box, which hide each other in part; a spot lights the floor, a receiver lies in a corner.
World plates_in_box() {
  World world;
  BodyId const body = world.add_body("all", {});
  GroupId const group = world.add_group("all");
  std::uint32_t const black = black_optic(world), grey = lambertian_optic(world, 0.3);
  auto const plate = [&](double radius, Vec3 at, Vec3 facing, std::uint32_t front) {
    return world.add_surface(disk(0, radius, {at, unit(facing)}), front, grey, body, group);
  };
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      for (int k = 0; k < 5; ++k) {
        double const turn = 0.61803398875 * (i + 31 * j + 317 * k);
        SinCos const t = sincos_turn(turn - std::floor(turn));
        plate(0.05, {0.15 * i, 0.15 * j, 0.1 + 0.15 * k}, {t.cos, t.sin, 0.3}, grey);
      }
  SurfaceId const floor = plate(1.2, {0.5, 0.5, -0.02}, {0, 0, 1}, grey);
  plate(1.2, {0.5, 0.5, 0.9}, {0, 0, -1}, grey);
  receive_on(world, "eye", plate(0.03, {1.05, 1.05, 0}, {0, 0, 1}, black));
  world.add_footprint(spot(floor, {0, 0, -0.02}, {0, 0, -1}, Profile::even, 0.02));
  world.finish();
  return world;
}

ImportanceSettings settings_with(double decisive, double unseen) {
  ImportanceSettings settings;
  settings.decisive = decisive;
  settings.unseen = unseen;
  settings.most_targets = 1000;  // more than there are patches
  settings.pilot_histories = 0;
  return settings;
}

// All lines of all pairs.
std::vector<Exchange> full_table(World const& world, SteeringTables const& tables) {
  std::vector<std::uint32_t> const goals = goals_of(world.view());
  std::vector<Exchange> all = exchanges(world, tables, goals, 8, 1);
  std::vector<std::vector<std::uint32_t>> pairs(tables.patches.size());
  for (std::uint32_t i = 0; i < pairs.size(); ++i)
    for (std::uint32_t j = i; j < pairs.size(); ++j) pairs[i].push_back(j);
  trace_every_line(world, tables, pairs, 8, 1, all);
  return all;
}

// The largest second moment of a hop over all sides, with a quarter of the directions from the BSDF model: 1 is
// perfect. F and A from the full table, q from `drawn`.
double worst_hop(std::vector<Exchange> const& full, SteeringTables const& exact, SteeringTables const& drawn) {
  constexpr double alpha = 0.25;
  double worst = 0;
  for (std::size_t i = 0; i < full.size(); ++i) {
    PatchSide const& side = drawn.sides[i];
    if (full[i].diffuse.empty() || !full[i].by_law.empty()) continue;
    double first = 0, second = 0;
    for (std::uint32_t j = 0; j < drawn.patches.size(); ++j) {
      double const q = drawn.view().density(side, j) * drawn.patches[j].area;
      double share = 0, worth = 0;
      for (std::size_t s = 2 * j; s < 2 * j + 2; ++s) {
        share += full[i].diffuse.share(s);
        worth += full[i].diffuse.share(s) * exact.sides[s].adjoint;
      }
      if (!(worth > 0)) continue;
      first += worth;
      second += worth * worth / (alpha * share + (1 - alpha) * q);
    }
    if (first > 0) worst = std::max(worst, second / (first * first));
  }
  return worst;
}

TEST(Exchange, RowsFollowTheFullTable) {
  World const world = plates_in_box();
  SteeringTables const exact = make_importance(world, settings_with(0, 0.1)),
                       quick = make_importance(world, settings_with(1.0 / 256, 0.1));
  std::vector<Exchange> const full = full_table(world, exact);
  EXPECT_LT(worst_hop(full, exact, quick), 2);
  // Control: pairs whose one line is hidden are never looked at again.
  EXPECT_GT(worst_hop(full, exact, make_importance(world, settings_with(1.0 / 256, 0))), 2);
}

TEST(Exchange, AdjointFollowsTheFullTable) {
  World const world = plates_in_box();
  SteeringTables const exact = make_importance(world, settings_with(0, 0.1)),
                       quick = make_importance(world, settings_with(1.0 / 256, 0.1)),
                       rough = make_importance(world, settings_with(1, 0.1));
  auto const apart = [&](SteeringTables const& tables) {  // mean square of the logarithm of the ratio
    double sum = 0;
    int sides = 0;
    for (std::size_t i = 0; i < exact.sides.size(); ++i) {
      double const a = tables.sides[i].adjoint, b = exact.sides[i].adjoint;
      if (!(b > 0)) continue;
      sum += std::pow(std::log(std::max(a, 1e-9 * b) / b), 2);
      ++sides;
    }
    return std::sqrt(sum / sides);
  };
  EXPECT_LT(apart(quick), 0.1);
  EXPECT_GT(apart(rough), 0.1);  // control: one line for every pair
}

// Light that is exchanged is the same in both directions: area times share (docs/theory/sampling.md, eq. 1.22).
TEST(Exchange, IsReciprocal) {
  World const world = plates_in_box();
  SteeringTables const tables = make_strips(world);
  std::vector<Exchange> const all = full_table(world, tables);
  double worst = 0;
  int compared = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      if (i / 2 == j / 2 || all[i].diffuse.empty() || all[j].diffuse.empty()) continue;
      double const there = all[i].diffuse.share(j) * tables.patches[i / 2].area,
                   back = all[j].diffuse.share(i) * tables.patches[j / 2].area;
      if (!(there > 0) || std::max(all[i].diffuse.peak(j), all[j].diffuse.peak(i)) > 0.1) continue;  // cut off
      worst = std::max(worst, std::fabs(back / there - 1));
      ++compared;
    }
  EXPECT_GT(compared, 1000);
  EXPECT_LT(worst, 1e-5);
}

TEST(Exchange, IsTheSameForAnyNumberOfThreads) {
  World const world = plates_in_box();
  ImportanceSettings settings = settings_with(1.0 / 256, 0.1);
  settings.threads = 1;
  SteeringTables const one = make_importance(world, settings);
  settings.threads = 3;
  SteeringTables const three = make_importance(world, settings);
  ASSERT_EQ(one.targets.size(), three.targets.size());
  for (std::size_t i = 0; i < one.targets.size(); ++i) {
    EXPECT_EQ(one.targets[i].patch, three.targets[i].patch);
    EXPECT_EQ(one.targets[i].cumulative, three.targets[i].cumulative);
  }
  for (std::size_t i = 0; i < one.sides.size(); ++i) EXPECT_EQ(one.sides[i].adjoint, three.sides[i].adjoint);
}

// Efforts over ninety octaves, some of them equal and some zero. With ties the first patches are taken.
TEST(Exchange, TargetsAreThePatchesOfMostEffort) {
  std::vector<double> efforts;
  for (int i = 0; i < 1000; ++i) {
    double const golden = 0.61803398875 * i;
    efforts.push_back(i % 5 == 0 ? 0 : i % 7 == 0 ? 0x1p-20 : std::ldexp(golden - std::floor(golden), -(i % 90)));
  }
  std::vector<double> sorted = efforts;
  std::ranges::sort(sorted, std::greater<>());
  for (std::size_t const most : {1, 127, 128, 300, 799, 900}) {
    std::vector<Target> const list = targets_of(efforts, most);
    ASSERT_EQ(list.size(), std::min<std::size_t>(most, 800));
    std::vector<double> chosen;
    for (Target const& t : list) chosen.push_back(efforts[t.patch]);
    std::ranges::sort(chosen, std::greater<>());
    EXPECT_TRUE(std::ranges::equal(chosen, std::span(sorted).first(list.size()))) << most;
    EXPECT_NEAR(list.back().cumulative, 1, 1e-12);
  }
}

}  // namespace
}  // namespace straytrace::testing
