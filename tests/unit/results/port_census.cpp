// SPDX-License-Identifier: BSD-3-Clause
// Objects met by the light that rejoins the mode, by noise (R3.31).
#include <gmock/gmock.h>

#include <cmath>

#include "results/route_table/route_choice.hpp"

namespace straytrace::testing::port_census {
namespace {

// A route whose noise power in the band and PSD at 10 Hz are `power`, with an error of a tenth.
PathRow row_of(std::string const& sequence, double power, ReplicaPattern const& pattern, std::size_t rank) {
  PathRow row;
  row.rank = rank;
  row.sequence = sequence;
  row.vertices = 3;
  row.resolved = true;
  row.power = {power, 0.1 * power};
  row.replicas = pattern;
  row.strain = {{std::sqrt(power), 0.05 * std::sqrt(power)}};
  row.coupling.mean = power;
  row.coupling.std_error = 0.1 * power;
  row.rms_phase = 1;
  return row;
}

ReplicaPattern first_up() {
  ReplicaPattern p = {};
  p[0] = std::sqrt(0.5);
  p[1] = -std::sqrt(0.5);
  return p;
}
ReplicaPattern first_down() {
  ReplicaPattern p = first_up();
  for (double& x : p) x = -x;
  return p;
}

// Routes that vary alike, or against each other with `second` turned.
PathTable table_of(ReplicaPattern const& second) {
  PathTable table;
  table.frequencies = {10};
  table.low = 1;
  table.high = 100;
  table.has_noise = true;
  table.rows = {row_of("ITM·S > baffles·S > ITM·S", 3, first_up(), 1),
                row_of("ITM·S > tube·S > baffles·S > ITM·S", 1, second, 2), row_of("other > ITM", 1, {}, 3)};
  PathRow faint = row_of("ITM·S > ring·S > ITM·S", 100, {}, 4);
  faint.resolved = false;
  table.rows.push_back(faint);
  table.unresolved = 1;
  return table;
}

MetObject const& of(std::vector<MetObject> const& all, std::string const& name) {
  auto const at = std::ranges::find(all, name, &MetObject::object);
  EXPECT_NE(at, all.end()) << name;
  return *at;
}

// Powers of all routes that meet an object add; their errors as the replicas say, linearly where they vary alike.
TEST(PortCensus, SumsRoutesByObject) {
  std::vector<MetObject> const met = objects_by_noise(table_of(first_up()));
  ASSERT_EQ(met.size(), 4u);  // not the ring, whose only route is unresolved
  MetObject const &baffles = of(met, "baffles"), &tube = of(met, "tube"), &rest = of(met, "");
  EXPECT_EQ(met.back().object, "");
  EXPECT_NEAR(baffles.share.value, 0.8, 1e-12);
  EXPECT_NEAR(tube.share.value, 0.2, 1e-12);
  EXPECT_NEAR(rest.share.value, 0.2, 1e-12);
  EXPECT_EQ(baffles.routes, (std::vector<std::size_t>{1, 2}));
  EXPECT_NEAR(baffles.strain[0].value, 2, 1e-12);
  EXPECT_NEAR(baffles.strain[0].sigma, 0.4 / (2 * 2), 1e-12);
  EXPECT_NEAR(baffles.coupling.sigma, 0.4, 1e-12);
  // d(4/5) with a change of 0.4 in both, and of 0.1 in the rest: (1 - s) 0.4/5 and s 0.1/5.
  EXPECT_NEAR(baffles.share.sigma, std::hypot(0.2 * 0.4, 0.8 * 0.1) / 5, 1e-12);
  // Control: against each other, their errors subtract.
  EXPECT_NEAR(of(objects_by_noise(table_of(first_down())), "baffles").coupling.sigma, 0.2, 1e-12);
}

TEST(PortCensus, SaysWhatItLeavesOut) {
  PathTable table = table_of(first_up());
  EXPECT_THAT(port_census_text(table, 2), ::testing::HasSubstr("1 unresolved route is not in it"));
  EXPECT_THAT(port_census_text(table, 2), ::testing::HasSubstr("and 2 more"));
  table.rows[1].kind = ClassKind::edge;  // an upper bound
  EXPECT_TRUE(of(objects_by_noise(table), "tube").coupling.at_most);
  EXPECT_FALSE(of(objects_by_noise(table), "").coupling.at_most);
}

}  // namespace
}  // namespace straytrace::testing::port_census
