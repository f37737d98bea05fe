// SPDX-License-Identifier: BSD-3-Clause
// The baffled tube of tests/support/baffled_tube.hpp, and paths that a technique misses (docs/theory/sampling.md).
#include "support/baffled_tube.hpp"

#include "base/errors.hpp"

namespace straytrace::testing {
namespace {

// The walls of the first 20 m, before the first ring, removed from every list.
SteeringTables without_near_wall(World const& world, SteeringTables tables, double alpha) {
  SteeringTables changed = tables;
  changed.targets.clear();
  for (PatchSide& side : changed.sides) {
    std::uint32_t const first = std::uint32_t(changed.targets.size());
    double total = 0;
    for (std::uint32_t i = side.first; i < side.first + side.count; ++i) {
      Target t = tables.targets[i];
      Strip const& strip = tables.strips[t.patch];
      bool const near_wall = world.groups()[world.surfaces()[strip.surface.value].group.value] == "wall" &&
                             strip.u_low * baffled_length < 20;
      if (near_wall) continue;
      total += t.share;
      changed.targets.push_back(t);
    }
    double so_far = 0;
    side.first = first;
    side.count = std::uint32_t(changed.targets.size()) - first;
    for (std::uint32_t i = first; i < changed.targets.size(); ++i) {
      changed.targets[i].share /= total;
      changed.targets[i].cumulative = so_far += changed.targets[i].share;
    }
    side.alpha = side.count > 0 ? alpha : 1;
  }
  changed.level = 0;
  return changed;
}

TEST(BaffledTube, EstimatorsAgreeScene11) { expect_estimators_agree(1 << 18, 1e-2); }

// The trap of section 15: the wall before the first ring, through which most light comes back, is on no list.
TEST(BaffledTube, MissedPathTrap) {
  World world = baffled_tube();
  TraceResult const law = run_histories(world, 1 << 18);
  SteeringTables const tables = make_importance(world);
  world.steer(without_near_wall(world, tables, 0.1));
  TraceResult const insured = run_histories(world, 1 << 19);
  expect_same("A ", received_by(insured, 0), received_by(law, 0));
  std::vector<std::string> const& warnings = insured.coupling.warnings;
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings[0].find("receiver A comes from 'wall'"), std::string::npos) << warnings[0];
  // exclusive lists: the energy balance see that light is missing
  world.steer(without_near_wall(world, tables, 0));
  EXPECT_THROW(run_histories(world, 1 << 18), NumericalError);
}

}  // namespace
}  // namespace straytrace::testing
