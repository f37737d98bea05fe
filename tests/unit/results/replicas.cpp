// SPDX-License-Identifier: BSD-3-Clause
// Sums of routes that have histories in common, and what rows `other` are made of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "results/receivers/receivers.hpp"
#include "results/route_table/route_sums.hpp"
#include "support/recorded.hpp"
#include "unit/results/synthetic.hpp"

namespace straytrace::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A route with the numbers of its reverse goes up and down with it: the error of their sum is 2 e, for the printed sum
// and for the figure of merit alike. Control: two routes that share nothing, sqrt(2) e.
TEST(ReplicaSum, SumsIncludeTheCorrelationOfRoutes) {
  TraceResult trace = trace_result();
  auto& classes = trace.coupling.classes;
  classes.resize(2);
  classes[1].coupling = classes[0].coupling;
  double const mean = classes[0].coupling.mean, e = classes[0].coupling.std_error;
  for (bool mirrored : {true, false}) {
    for (std::size_t r = 0; r < replica_count; ++r) {
      double const up = 0.1 * (r % 2 ? 1 : -1), pairs = 0.1 * (r / 2 % 2 ? 1 : -1);
      classes[0].replica_sum[r] = (1 + up) * mean * 4736;
      classes[1].replica_sum[r] = (1 + (mirrored ? up : pairs)) * mean * 4736;
    }
    classes[1].by_reverse = mirrored;
    double const wanted = (mirrored ? 2 : std::sqrt(2.0)) * e;
    PathTable const t = path_table(trace.coupling, nullptr, nullptr, {});
    EXPECT_NEAR(t.total_coupling.sigma / wanted, 1, 1e-12);
    double const relative = wanted / (2 * mean), seconds = trace.seconds;
    EXPECT_NEAR(merits(content(trace, nullptr)).front().value * relative * relative * seconds, 1, 1e-12);
    bool const said =
        path_text(t, 5).find("1 route was taken from the reversed route (reciprocity)") != std::string::npos;
    EXPECT_EQ(said, mirrored);
  }
}

// d(a/(a + b)) = ((1 - s) da - s db)/(a + b): routes that go up and down together keep their shares. Control: two that
// share nothing.
TEST(ReplicaSum, SharesIncludeTheCorrelationWithTheirTotal) {
  ReplicaPattern up, pairs;
  for (std::size_t r = 0; r < replica_count; ++r) {
    up[r] = (r % 2 ? 1 : -1) / std::sqrt(double(replica_count));
    pairs[r] = (r / 2 % 2 ? 1 : -1) / std::sqrt(double(replica_count));
  }
  for (ReplicaPattern const& other : {up, pairs, ReplicaPattern{}}) {
    ReplicaSum const a({3, 0.3}, up), b({1, 0.1}, other);
    ReplicaSum total = a;
    total.add(b);
    WithError const share = b.share_of(total);
    EXPECT_DOUBLE_EQ(share.value, 0.25);
    EXPECT_NEAR(share.sigma, other == up ? 0 : std::hypot(0.75 * 0.1, 0.25 * 0.3) / 4, 1e-12);
    EXPECT_NEAR(a.share_of(total).sigma, share.sigma, 1e-12);
    EXPECT_NEAR(total.share_of(total).sigma, 0, 1e-12);
  }
}

// Deviations of a row are scaled to its own error, which comes from all blocks: a sum of one row has the error of that
// row.
TEST(ReplicaSum, OneRowKeepsItsError) {
  TraceResult trace = trace_result();
  auto& c = trace.coupling.classes.front();
  for (std::size_t r = 0; r < replica_count; ++r) c.replica_sum[r] *= 1 + 0.01 * spread(r);
  ReplicaPattern const pattern = pattern_of(trace.coupling, c);
  double square = 0;
  for (double const x : pattern) square += x * x;
  EXPECT_NEAR(square, 1, 1e-12);
  WithError const sum = ReplicaSum({c.coupling.mean, c.coupling.std_error}, pattern).result();
  EXPECT_NEAR(sum.sigma / c.coupling.std_error, 1, 1e-12);
  trace.coupling.replica_histories[3] = 0;  // control: without a replica nothing is known of what routes share
  EXPECT_EQ(pattern_of(trace.coupling, c), ReplicaPattern{});
}

// A row `other` lists its routes and the reasons, for people and for programs.
TEST(Folded, RowsNameTheirLargestRoutesWithTheReason) {
  TraceResult trace = trace_result();
  CouplingClass& other = trace.coupling.classes[6];
  PathTable table = path_table(trace.coupling, nullptr, nullptr, {});
  std::string const text = path_text(table, 12);
  EXPECT_THAT(text, HasSubstr("other > arm sums 9 routes without a row of their own; the largest 2:\n"
                              "  long routes: 1.000(10)e-23: more vertices than 'route_vertices' names\n"));
  EXPECT_THAT(text, HasSubstr(": about 4e-24: only 14 histories have scored\n"));
  auto const json = nlohmann::json::parse(path_json(table, content(trace, nullptr)));
  std::size_t rows = 0;
  for (auto const& row : json["routes"]) {
    if (!row.contains("folded")) continue;
    ++rows;
    EXPECT_EQ(row["folded_routes"], 9);
    EXPECT_EQ(row["folded"].size(), 2u);
    EXPECT_EQ(row["folded"][1]["why"], "only 14 histories have scored");
    EXPECT_TRUE(row["folded"][1]["coupling"].is_null());
    EXPECT_DOUBLE_EQ(double(row["folded"][0]["coupling"]["value"]), 1e-23);
  }
  EXPECT_EQ(rows, 1u);
  other.folded.clear();  // control: nothing was folded
  table = path_table(trace.coupling, nullptr, nullptr, {});
  EXPECT_THAT(path_text(table, 12), Not(HasSubstr("without a row")));
}

}  // namespace
}  // namespace straytrace::test
