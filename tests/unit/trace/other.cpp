// SPDX-License-Identifier: BSD-3-Clause
// Rows `other`: summing routes does not remove their tails, and the id does not depend on the routes.
#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "support/trace_support.hpp"
#include "trace/tally/coupling_table.hpp"

namespace straytrace::testing::trace_other {
namespace {

using ::testing::StartsWith;

constexpr std::uint64_t blocks = 64, per_block = 400;

// Quantiles of x^-p above 1, cut off at 600, out of order: an infinite variance whose largest totals are missing.
double heavy(std::uint64_t i) {
  double const u = (double(i * 9973 % (blocks * per_block)) + 0.5) / double(blocks * per_block), least = 1.29e-4;
  return std::pow(least + (1 - least) * u, -1 / 1.4);
}

// Two routes without kept paths, hence without names, of ids `id` and `id` + 1: `one(i)` and `two(i)` are the totals of
// history i.
template <class One, class Two>
CouplingClass other_of(One&& one, Two&& two, std::uint64_t id = 7) {
  SumTree tree;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    BlockSums sums;
    sums.blocks = 1;
    sums.histories = per_block;
    ClassSums &first = sums.classes[id], &second = sums.classes[id + 1];
    for (std::uint64_t i = b * per_block; i < (b + 1) * per_block; ++i) {
      first.moments.add_score(one(i), i);
      second.moments.add_score(two(i), i);
    }
    for (ClassSums* route : {&first, &second}) {
      route->moments.close_block();
      route->replica_sum[b % replica_count] = route->moments.sum;
    }
    tree.add(0, b, std::move(sums));
  }
  World world;
  world.add_port("port");
  CouplingTable const table = make_coupling_table(SteeredWorld::as_given(world), tree.total(), 1, 1,
                                                  [](auto) { return std::vector<ReplayedScore>(); });
  EXPECT_EQ(table.classes.size(), 1u);
  EXPECT_EQ(table.classes[0].folded_routes, 2u);
  return table.classes[0];
}

// The row alone would pass: neither its replicas nor its moments see the tail. Controls: the tail carries less than
// half, and there is none.
TEST(Other, OfAHeavyTailIsNotResolved) {
  Estimate const row = other_of([](auto) { return 1.0; }, heavy).coupling;
  EXPECT_FALSE(row.trusted);
  EXPECT_THAT(row.why_not, StartsWith("mostly long routes: the largest histories fall as slowly as x^-2.5"));
  EXPECT_EQ(tail_objection(row), "");
  Estimate const less = other_of([](auto) { return 5.0; }, heavy).coupling;
  EXPECT_TRUE(less.trusted) << less.why_not;
  EXPECT_TRUE(other_of([](auto) { return 1.0; }, [](auto) { return 2.0; }).coupling.trusted);
}

// The reason names the larger of two.
TEST(Other, CountsItsHeavyTails) {
  Estimate const row = other_of(heavy, [](std::uint64_t i) { return 2 * heavy(i + 1); }).coupling;
  EXPECT_THAT(row.why_not, StartsWith("mostly long routes and 1 more: the largest"));
}

// Other routes in the row do not change its id, and it is the id of none of them; ends and C_rev do. Control: the least
// id of its routes changes.
TEST(Other, HasAnIdOfItsOwn) {
  auto const one = [](std::uint64_t) { return 1.0; };
  CouplingClass const a = other_of(one, one, 7), b = other_of(one, one, 70);
  EXPECT_EQ(a.hash, b.hash);
  EXPECT_EQ(a.hash, hash_of_other(0, a.reverse));
  auto const least = [](CouplingClass const& c) {
    std::uint64_t id = c.folded.at(0).hash;
    for (FoldedRoute const& f : c.folded) {
      EXPECT_NE(f.hash, c.hash);
      id = std::min(id, f.hash);
    }
    return id;
  };
  EXPECT_NE(least(a), least(b)) << "negative control";
  EXPECT_EQ((std::set{hash_of_other(0, 1), hash_of_other(0, 2), hash_of_other(1, 1), hash_of_other(1, 2)}.size()), 4u);
}

// Routes with too few scores are what the row is for.
TEST(Other, OfFewScoresIsResolved) {
  auto const rare = [](std::uint64_t i) { return i % per_block == i / per_block ? 500.0 : 0.0; };
  Estimate const row = other_of([](auto) { return 1.0; }, rare).coupling;
  EXPECT_GT(row.mean, 2);
  EXPECT_TRUE(row.trusted) << row.why_not;
}

}  // namespace
}  // namespace straytrace::testing::trace_other
