// SPDX-License-Identifier: BSD-3-Clause
// Stop rules that few histories meet: they are met by few, and stopping there favours no value
// (docs/theory/errors.md, Determinism).
#include "support/small_tube.hpp"
#include "trace/run/trace.hpp"

namespace straytrace::testing::early_checks {
namespace {

double error_of_total(CouplingTable const& table) {
  double worst = 0;
  for (CouplingClass const& c : table.classes)
    worst = std::max(worst, c.coupling.trusted ? c.coupling.std_error / c.coupling.mean : infinity);
  return worst;
}

TraceResult until(double wanted, std::uint64_t seed) {
  World world = two_plates();
  TraceSettings settings;
  settings.seed = seed;
  settings.histories = 1u << 20;
  settings.threads = 1;
  settings.wanted_error = wanted;
  settings.error = error_of_total;
  return trace_to_rule(SteeredWorld::as_given(world), settings, *test_backend());
}

TEST(EarlyChecks, FewHistoriesMeetALooseRule) {
  TraceResult const loose = until(0.2, 1), tight = until(0.02, 1);
  EXPECT_EQ(loose.stopped, Stopped::by_error);
  EXPECT_LT(loose.total.histories, 131072u);
  EXPECT_EQ(tight.stopped, Stopped::by_error);
  EXPECT_GT(tight.total.histories, 2 * loose.total.histories);
  // A stopped run equals the run of that many histories.
  World world = two_plates();
  world.block_size = block_size_of(loose.total.histories);
  EXPECT_TRUE(same(run_histories(world, loose.total.histories).total, loose.total));
  world.block_size = largest_block;  // control: other blocks, another result
  EXPECT_FALSE(same(run_histories(world, loose.total.histories).total, loose.total));
}

TEST(EarlyChecks, EverySizeMakesEnoughBlocks) {
  for (std::uint64_t n = 1000; n < 300000; n += 37) {
    std::uint64_t const size = block_size_of(n), blocks = blocks_of(n, size);
    ASSERT_GE(blocks, enough_blocks) << n;
    ASSERT_EQ(block_size_of(blocks * size), size) << n;  // a resumed run has the same blocks
  }
  EXPECT_EQ(block_size_of(std::uint64_t{1} << 36), largest_block);
}

double coupling(BlockSums const& sums, std::uint64_t route) {
  auto const at = sums.classes.find(route);
  return at == sums.classes.end() ? 0 : at->second.moments.sum / double(sums.histories);
}

// Blocks of 8 histories until the spread of what was seen is below 50 %, whenever that is.
double stopped_greedily(std::uint64_t route, std::uint64_t seed) {
  World world = two_plates();
  world.block_size = smallest_block;
  BlockSums all;
  for (std::uint64_t block = 0;; ++block) {
    all = merged(std::move(all), test_backend()->run_block(SteeredWorld::as_given(world), seed, block));
    if (!all.classes.contains(route) || block == 0) continue;
    Moments const& m = all.classes.at(route).moments;
    double const n = double(all.histories), mean = m.sum / n, error = std::sqrt((m.sum2 - m.sum * mean) / n / (n - 1));
    if (m.scored > 1 && error < 0.5 * mean) return mean;
  }
}

// Over many seeds, the mean of what is found where the rule of 20 % stops, of the least known route, in the error of
// that mean; a long run gives the true value. Negative control: a rule evaluated after every few histories, trusts two
// scores and stops at the first good-looking moment; of k scores it finds 1/k too much.
TEST(EarlyChecks, StoppingLeavesNoBias) {
  BlockSums const truth = run_histories(two_plates(), 1u << 21).total;
  std::uint64_t route = 0;
  double worst = 0;
  for (auto const& [hash, c] : truth.classes) {
    Estimate const e = estimate(c.moments, truth.histories, truth.blocks);
    if (e.trusted && e.std_error > worst * e.mean) {
      worst = e.std_error / e.mean;
      route = hash;
    }
  }
  Sampler early, greedy;
  for (std::uint64_t seed = 1; seed <= 100; ++seed)
    early.add(coupling(until(0.2, seed).total, route) / coupling(truth, route));
  for (std::uint64_t seed = 1; seed <= 400; ++seed) greedy.add(stopped_greedily(route, seed) / coupling(truth, route));
  expect_mean("stopped at looks", early.mean(), 1, 0.1);
  expect_rejected("stopped at once", greedy.mean(), 1);
}

}  // namespace
}  // namespace straytrace::testing::early_checks
