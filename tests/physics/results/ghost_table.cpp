// SPDX-License-Identifier: BSD-3-Clause
// The table of ghosts keeps the requested number of rows, the strongest, and counts all of them.
#include "results/ghosts/ghost_table.hpp"

#include <gmock/gmock.h>

#include "support/trace_support.hpp"

namespace straytrace::testing::report_ghost_table {
namespace {

// Powers of the rows of ghosts that are kept of three, and the number counted.
std::pair<std::vector<double>, std::uint64_t> kept(std::size_t show) {
  World world;
  std::uint32_t const black = black_optic(world);
  SurfaceId const s = world.add_surface(disk(0, 0.1), black, black, world.add_body("a", {}), world.add_group("a"));
  world.add_footprint(spot(s, {}, {0, 0, -1}, Profile::gaussian, 1e-3));
  world.finish();
  BeamLaunch launch;
  launch.mode = circular_mode({0, 0, 1}, {0, 0, -1}, 1e-3, 0, world.wavelength);
  MainBeam const main(world, launch, {});
  GhostFamilies const families(world, launch, main, {}, GhostSum::independent);
  GhostTable table(world, launch, families, GhostRank::power, show);
  for (double const power : {0.1, 0.3, 0.2}) {
    Ghost g;
    g.number = std::uint64_t(100 * power);
    g.order = 1;
    g.where = GroupId{0};
    g.power = power;
    table.add(g);
  }
  GhostReport report;
  report.energy_balance.objects.resize(world.groups().size());
  table.fill(report);
  std::vector<double> powers;
  for (GhostRow const& row : report.rows) powers.push_back(row.ghost.power);
  return {powers, report.ghosts};
}

TEST(GhostTable, KeepsAsManyRowsAsAreShown) {
  EXPECT_EQ(kept(0), std::pair(std::vector<double>{}, std::uint64_t(3)));
  EXPECT_EQ(kept(2), std::pair(std::vector<double>({0.3, 0.2}), std::uint64_t(3)));  // control: not always none
  EXPECT_EQ(kept(9), std::pair(std::vector<double>({0.3, 0.2, 0.1}), std::uint64_t(3)));
}

}  // namespace
}  // namespace straytrace::testing::report_ghost_table
