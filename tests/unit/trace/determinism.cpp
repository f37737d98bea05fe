// SPDX-License-Identifier: BSD-3-Clause
// A result is a function of scene, seed and number of histories (docs/develop/architecture.md); and when a trace stops.
#include <atomic>

#include "support/small_tube.hpp"

namespace straytrace::testing::trace_determinism {
namespace {

constexpr std::uint64_t blocks = 5;

BlockSums total(World const& world, std::uint64_t seed, unsigned threads) {
  return run_histories(world, blocks * largest_block, seed, threads).total;
}

TEST(Determinism, ThreadsSeedAndBruteForce) {
  World world = small_tube();
  BlockSums const one = total(world, 1, 1);
  EXPECT_TRUE(same(one, total(world, 1, 2)));
  EXPECT_TRUE(same(one, total(world, 1, 3)));
  EXPECT_FALSE(same(one, total(world, 2, 2)));  // negative control
  world.limits.brute_force = true;
  EXPECT_TRUE(same(one, total(world, 1, 2)));
  EXPECT_GT(one.classes.size(), 10u);
}

// R3.33: 1, 4 and 16 threads.
TEST(Determinism, AnyNumberOfThreadsR3_33) {
  World const world = small_tube();
  auto const run = [&](unsigned threads, std::uint64_t seed) {
    return run_histories(world, 20 * largest_block, seed, threads).total;
  };
  BlockSums const one = run(1, 1);
  EXPECT_TRUE(same(one, run(4, 1)));
  EXPECT_TRUE(same(one, run(16, 1)));
  BlockSums nudged = one;  // control: one bit of one sum
  nudged.emitted.sum = std::nextafter(nudged.emitted.sum, infinity);
  EXPECT_FALSE(same(one, nudged));
}

// The cpu backend, with the stop flag raised after some blocks.
class Interrupting final : public Backend {
 public:
  Interrupting(std::uint64_t after, std::atomic<bool>& stop) : after_(after), stop_(stop) {}
  std::string_view name() const override { return "interrupting"; }
  BlockSums run_block(SteeredWorld const& world, std::uint64_t seed, std::uint64_t block) const override {
    if (++done_ >= after_) stop_ = true;
    return cpu_->run_block(world, seed, block);
  }

 private:
  std::uint64_t after_;
  std::atomic<bool>& stop_;
  mutable std::atomic<std::uint64_t> done_{0};
  std::unique_ptr<Backend> cpu_ = test_backend();
};

TEST(Determinism, InterruptedAndResumed) {
  World const world = small_tube();
  std::atomic<bool> stop = false;
  TraceSettings settings;
  settings.histories = blocks * largest_block;
  settings.threads = 2;
  settings.stop = &stop;
  TraceResult const part = run_trace(SteeredWorld::as_given(world), settings, Interrupting(2, stop));
  EXPECT_EQ(part.stopped, Stopped::by_signal);
  EXPECT_TRUE(part.checkpointed());
  EXPECT_GE(part.total.blocks, 2u);
  EXPECT_LT(part.total.blocks, blocks);
  stop = false;
  settings.resume = part.tree;
  TraceResult const whole = run_trace(SteeredWorld::as_given(world), settings, *test_backend());
  EXPECT_EQ(whole.stopped, Stopped::by_histories);
  EXPECT_TRUE(same(whole.total, total(world, 1, 1)));
  EXPECT_FALSE(same(part.total, whole.total));
  EXPECT_EQ(whole.coupling.histories, blocks * largest_block);
}

TEST(Determinism, OutOfTimeKeepsTheHistoriesSoFar) {
  TraceSettings settings;
  settings.histories = blocks * largest_block;
  settings.threads = 1;
  settings.max_seconds = 0;
  TraceResult const r = run_trace(SteeredWorld::as_given(small_tube()), settings, *test_backend());
  EXPECT_EQ(r.stopped, Stopped::by_time);
  EXPECT_TRUE(r.checkpointed());
}

// Blocks after which a rule with these errors is evaluated; requested: below 1.
std::vector<std::uint64_t> looks(std::vector<double> const& errors, Stopped& why) {
  std::vector<std::uint64_t> seen;
  TraceSettings settings;
  settings.histories = 200 * largest_block;
  settings.threads = 2;
  settings.wanted_error = 1;
  settings.error = [&](CouplingTable const& table) {
    seen.push_back(table.histories / largest_block);
    return seen.size() <= errors.size() ? errors[seen.size() - 1] : 2;
  };
  why = run_trace(SteeredWorld::as_given(one_plate()), settings, *test_backend()).stopped;
  return seen;
}

TEST(StopRule, IsEvaluatedAtFixedBlockCounts) {
  std::vector<std::uint64_t> counts;
  for (std::uint64_t b = 0; counts.size() < 8; counts.push_back(b)) b = next_check(b);
  EXPECT_EQ(counts, (std::vector<std::uint64_t>{32, 45, 64, 91, 128, 181, 256, 362}));
  EXPECT_EQ(next_check(63), 64u);
  EXPECT_EQ(next_check(64), 91u);
}

TEST(StopRule, MustHoldTwiceInARow) {
  Stopped why;
  EXPECT_EQ(looks({0.5, 0.5}, why), (std::vector<std::uint64_t>{32, 45}));
  EXPECT_EQ(why, Stopped::by_error);
  EXPECT_EQ(looks({0.5, 2, 0.5, 0.5}, why), (std::vector<std::uint64_t>{32, 45, 64, 91}));
  EXPECT_EQ(why, Stopped::by_error);
  EXPECT_EQ(looks({0.5, 2, 0.5, 2}, why).back(), 200u);  // a rule that stops at the first good moment would end at 32
  EXPECT_EQ(why, Stopped::by_histories);
}

}  // namespace
}  // namespace straytrace::testing::trace_determinism
