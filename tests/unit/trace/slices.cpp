// SPDX-License-Identifier: BSD-3-Clause
// Slices of a run and their merge: they cover each block once, sums with gaps list their blocks, and all of
// them together are the bits of one run (docs/guide/clusters.md).
#include <atomic>
#include <chrono>
#include <random>
#include <thread>

#include "support/small_tube.hpp"
#include "trace/run/runner.hpp"

namespace straytrace::testing::trace_slices {
namespace {

TEST(Slices, CoverEachBlockOnce) {
  for (std::uint64_t const of : {1ull, 2ull, 3ull, 7ull, 200ull, 999999ull})
    for (std::uint64_t const all : {0ull, 1ull, 5ull, 200ull, 1000003ull, 244140625ull}) {
      std::uint64_t next = 0, least = all, most = 0;
      for (std::uint64_t n = 1; n <= of; ++n) {
        BlockRange const range = Slice{n, of}.blocks(all);
        ASSERT_EQ(range.first, next) << n << '/' << of << " of " << all;
        ASSERT_LE(range.first, range.end);
        next = range.end;
        least = std::min(least, range.size());
        most = std::max(most, range.size());
      }
      EXPECT_EQ(next, all);
      EXPECT_LE(most - least, 1u);
    }
  // control: shares rounded down leave blocks out
  EXPECT_NE(7 * (200 / 7), 200);
}

TEST(Slices, TreesListTheirBlocks) {
  SumTree tree;
  for (std::uint64_t const block : {0, 1, 2, 5, 6, 7, 12}) tree.add(0, block, {});
  EXPECT_EQ(tree.done(), (std::vector<BlockRange>{{0, 3}, {5, 8}, {12, 13}}));
  EXPECT_EQ(tree.missing({0, 16}), (std::vector<BlockRange>{{3, 5}, {8, 12}, {13, 16}}));
  EXPECT_EQ(tree.missing({1, 3}), std::vector<BlockRange>{});
  EXPECT_EQ(tree.missing({4, 6}), (std::vector<BlockRange>{{4, 5}}));
  EXPECT_EQ(tree.missing({20, 22}), (std::vector<BlockRange>{{20, 22}}));
  EXPECT_EQ(tree.missing({3, 3}), std::vector<BlockRange>{});
}

// Threads take single blocks; ranks take nodes of the sum tree, not far ahead, so that a run that is stopped has few
// gaps.
TEST(Slices, QueueGivesEachBlockOnce) {
  BlockQueue block_queue({{3, 5}, {8, 23}});
  EXPECT_EQ(block_queue.take(), 3u);
  EXPECT_EQ(block_queue.take_node(7), (BlockRange{8, 12}));
  EXPECT_EQ(block_queue.take_node(7), (BlockRange{12, 16}));
  EXPECT_EQ(block_queue.take_node(9), (BlockRange{16, 20}));
  block_queue.give_back({9, 11});
  EXPECT_EQ(block_queue.left(), 6u);
  EXPECT_EQ(block_queue.take_node(2), (BlockRange{20, 22}));
  EXPECT_EQ(block_queue.take_node(2), (BlockRange{9, 10}));
  EXPECT_EQ(block_queue.take(), 10u);
  EXPECT_EQ(block_queue.take_node(0), (BlockRange{4, 5}));
  EXPECT_EQ(block_queue.take(), 22u);
  EXPECT_FALSE(block_queue.take());
  EXPECT_FALSE(block_queue.take_node(1));
}

// Replicas are numbers of blocks modulo 32 (noise bands by jackknife): those of a run with gaps are counted, not those
// of as many blocks from the first on.
TEST(Slices, ReplicasAreThoseOfTheBlocks) {
  std::mt19937 engine(5);
  SumTree tree;
  std::array<std::uint64_t, replica_count> counted = {};
  std::uint64_t blocks = 0;
  for (std::uint64_t block = 0; block < 200; ++block) {
    if (engine() % 3 == 0) continue;
    BlockSums one;
    one.blocks = 1;
    tree.add(0, block, one);
    ++counted[block % replica_count];
    ++blocks;
  }
  BlockSums const total = tree.total();
  EXPECT_EQ(total.blocks, blocks);
  EXPECT_EQ(total.replica_blocks, counted);
  std::array<std::uint64_t, replica_count> control = {};
  for (std::uint64_t block = 0; block < blocks; ++block) ++control[block % replica_count];
  EXPECT_NE(control, counted);
}

// A class that only later blocks have scored in: where the border of the halves lies inside them, its sum before the
// border is not known; a zero would be taken for a first half without light.
TEST(Slices, NoFirstHalfIsMadeUp) {
  auto const blocks_of = [](std::uint64_t route, std::uint64_t first, unsigned level) {
    BlockSums one;
    one.blocks = std::uint64_t(1) << level;
    one.classes[route].moments.sum = 1;
    SumTree tree;
    tree.add(level, first >> level, one);
    return tree;
  };
  SumTree tree = blocks_of(1, 7, 0);
  SumTree const later = blocks_of(2, 8, 3);
  for (auto const& [place, sums] : later.nodes()) tree.add(place.second, place.first >> place.second, sums);
  BlockSums const total = tree.total();  // 9 blocks, the border behind the fourth
  ASSERT_EQ(first_part(9), 4u);
  EXPECT_TRUE(std::isnan(total.classes.at(1).moments.first_sum));
  EXPECT_TRUE(std::isnan(total.classes.at(2).moments.first_sum));
}

constexpr std::uint64_t blocks = 11;

TraceSettings settings_for(Slice slice = {}, SumTree resume = {}) {
  TraceSettings settings;
  settings.histories = blocks * largest_block;
  settings.threads = 2;
  settings.slice = slice;
  settings.resume = std::move(resume);
  return settings;
}
TraceResult traced(TraceSettings const& settings) {
  return run_trace(SteeredWorld::as_given(two_plates()), settings, *make_backend("cpu"));
}

void add(SumTree& into, SumTree const& from) {
  for (auto const& [place, sums] : from.nodes()) into.add(place.second, place.first >> place.second, sums);
}

TEST(Slices, AllTogetherAreOneRun) {
  TraceResult const one = traced(settings_for());
  for (std::uint64_t const of : {2, 3, 20}) {
    SumTree all;
    for (std::uint64_t n = of; n >= 1; --n) {
      TraceResult const part = traced(settings_for({n, of}));
      EXPECT_EQ(part.total.blocks, (Slice{n, of}.blocks(blocks).size()));
      EXPECT_EQ(part.all_blocks, blocks);
      EXPECT_FALSE(part.checkpointed());
      add(all, part.tree);
    }
    TraceResult const merged = result_of(SteeredWorld::as_given(two_plates()), settings_for(), all);
    EXPECT_TRUE(same(merged.total, one.total)) << of;
    EXPECT_EQ(merged.coupling.replica_histories, one.coupling.replica_histories);
  }
  SumTree control;  // a part of another seed
  add(control, traced(settings_for({1, 2})).tree);
  TraceSettings other = settings_for({2, 2});
  other.seed = 2;
  add(control, traced(other).tree);
  EXPECT_FALSE(same(control.total(), one.total));
}

// A merged run with a gap is continued: only what is missing is traced.
TEST(Slices, GapsAreFilled) {
  TraceResult const one = traced(settings_for());
  SumTree some = traced(settings_for({1, 4})).tree;
  add(some, traced(settings_for({3, 4})).tree);
  std::uint64_t const had = some.total().blocks;
  ASSERT_EQ(some.missing({0, blocks}).size(), 2u);
  TraceResult const filled = traced(settings_for({}, some));
  EXPECT_LT(had, blocks);
  EXPECT_TRUE(same(filled.total, one.total));
  // When fewer histories are requested than it reaches, all gaps are filled: a run has none.
  TraceSettings fewer = settings_for({}, some);
  fewer.histories = 4 * largest_block;
  EXPECT_EQ(traced(fewer).tree.missing({0, some.done().back().end}).size(), 0u);
}

// A checkpoint resumes to the same bits; and none is made once all blocks are assigned, for a stop rule
// would then miss a look. The backend waits until the first checkpoint is there, so that there is one.
class Waiting final : public Backend {
 public:
  std::string_view name() const override { return "waiting"; }
  BlockSums run_block(SteeredWorld const& world, std::uint64_t seed, std::uint64_t block) const override {
    for (int i = 0; block == 5 && !seen && i < 1000; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return cpu_->run_block(world, seed, block);
  }
  mutable std::atomic<bool> seen{false};

 private:
  std::unique_ptr<Backend> cpu_ = make_backend("cpu");
};

TEST(Slices, CheckpointsResumeToTheSameBits) {
  Waiting const backend;
  std::vector<TraceResult> kept;
  TraceSettings settings = settings_for();
  settings.threads = 1;
  settings.checkpoint_seconds = 0;
  settings.checkpoint = [&](TraceResult const& so_far) {
    kept.push_back(so_far);
    backend.seen = true;
  };
  TraceResult const one = run_trace(SteeredWorld::as_given(two_plates()), settings, backend);
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_TRUE(kept[0].checkpointed());
  EXPECT_EQ(kept[0].stopped, Stopped::by_checkpoint);
  EXPECT_EQ(kept[0].total.blocks, 5u);
  EXPECT_EQ(kept[0].all_blocks, blocks);
  EXPECT_FALSE(same(kept[0].total, one.total));
  EXPECT_TRUE(same(traced(settings_for({}, kept[0].tree)).total, one.total));
}

}  // namespace
}  // namespace straytrace::testing::trace_slices
