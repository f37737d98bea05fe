// SPDX-License-Identifier: BSD-3-Clause
// Moments and their verdicts (docs/theory/errors.md), exact merging (docs/develop/architecture.md), kept records
// (docs/theory/errors.md).
#include <algorithm>
#include <random>
#include <set>
#include <stdexcept>

#include "support/trace_support.hpp"
#include "trace/tally/block_sink.hpp"
#include "trace/tally/history_tally.hpp"

namespace straytrace::testing {
namespace {

// Blocks of `per_block` histories with the given totals, merged in order.
Moments moments_of(std::vector<double> const& totals, std::size_t per_block) {
  Moments all;
  for (std::size_t first = 0; first < totals.size(); first += per_block) {
    Moments block;
    for (std::size_t i = first; i < std::min(first + per_block, totals.size()); ++i) block.add(totals[i], i);
    block.block_sum2 = block.sum * block.sum;
    all = merged(all, block);
  }
  return all;
}

TEST(Moments, KnownSample) {
  std::vector<double> const x{1, 2, 0, 4,
                              8};  // mean 3, sum of squared deviations 40, of fourth powers 16 + 1 + 81 + 1 + 625
  Moments const m = moments_of(x, 5);
  Estimate const e = estimate(m, 5, 1);
  EXPECT_DOUBLE_EQ(e.mean, 3);
  EXPECT_DOUBLE_EQ(e.std_error, std::sqrt(40.0 / (5 * 4)));
  EXPECT_DOUBLE_EQ(e.variance_of_variance, 724.0 / 1600 - 0.2);
  EXPECT_DOUBLE_EQ(e.largest_share, 8.0 / 15);
  EXPECT_DOUBLE_EQ(e.effective_scores, 225.0 / 85);
  EXPECT_EQ(e.scored, 4u);
  EXPECT_EQ(m.largest_history, 4u);
  Estimate const control = estimate(m, 4, 1);  // without the zero: the classical bias
  EXPECT_NE(control.mean, 3);
  EXPECT_NE(control.std_error, e.std_error);
}

// From 32 blocks on the blocks are the samples. Independent histories: both errors agree to the 13 % that 32 blocks
// know.
TEST(Moments, BlockErrorAndHistoryError) {
  std::mt19937_64 engine(3);
  std::exponential_distribution<double> draw;
  std::vector<double> x(32 * 256);
  for (double& value : x) value = draw(engine);
  Moments const m = moments_of(x, 256);
  double const by_block = estimate(m, x.size(), 32).std_error, by_history = estimate(m, x.size(), 31).std_error;
  EXPECT_NEAR(by_history, 1 / std::sqrt(double(x.size())), 0.05 * by_history);
  EXPECT_NEAR(by_block, by_history, 0.4 * by_history);
  // Histories of a block that are all alike: only the block error sees that there are 32 samples, not 8192.
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = x[i / 256 * 256];
  Moments const alike = moments_of(x, 256);
  double const ratio = estimate(alike, x.size(), 32).std_error / estimate(alike, x.size(), 31).std_error;
  EXPECT_NEAR(ratio, 16, 1);
}

// A share of 5e-5 of the histories scores nothing, and none of them was drawn. Strata dealt the others evenly: the
// blocks agree exactly, the mean is off by 5e-5, and the error of a route covers that. Scores that vary keep their
// error. Control: the spread of the blocks alone.
TEST(Moments, ErrorOfARouteIsAtLeastOneHistory) {
  std::size_t const n = 32 * 256;
  std::vector<double> equal(n, 0.0);
  for (std::size_t i = 0; i < n; i += 4) equal[i] = 2;
  Moments const m = moments_of(equal, 256);
  double const truth = 0.5 * (1 - 5e-5);
  Estimate const route = estimate_of_light(m, n, 32);
  EXPECT_DOUBLE_EQ(route.std_error, 2.0 / double(n));
  EXPECT_LT(std::fabs(route.mean - truth), route.std_error);
  EXPECT_GT(std::fabs(route.mean - truth), 1000 * estimate(m, n, 32).std_error) << "negative control";
  std::mt19937_64 engine(3);
  std::exponential_distribution<double> draw;
  for (double& value : equal) value = draw(engine);
  Moments const varied = moments_of(equal, 256);
  EXPECT_EQ(estimate_of_light(varied, n, 32).std_error, estimate(varied, n, 32).std_error);
  EXPECT_TRUE(std::isnan(estimate_of_light({}, n, 32).std_error));
}

std::string verdict(std::vector<double> const& x, std::size_t blocks = 32) {
  return estimate(moments_of(x, x.size() / blocks), x.size(), blocks).why_not;
}
TEST(Moments, ReasonsInWords) {
  std::vector<double> x(32 * 100, 1.0);
  for (std::size_t i = 0; i < x.size(); i += 2) x[i] = 2;
  EXPECT_EQ(verdict(x), "");
  EXPECT_TRUE(estimate(moments_of(x, 100), x.size(), 32).trusted);
  EXPECT_EQ(verdict(x, 20), "only 20 blocks of histories were run (32 are needed)");
  EXPECT_EQ(verdict(x, 1), "only 1 block of histories was run (32 are needed)");
  std::vector<double> none(3200), few(3200), uneven = x, spiky = x;
  EXPECT_EQ(verdict(none), "no history has scored");
  EXPECT_TRUE(std::isnan(estimate(moments_of(none, 100), 3200, 32).std_error));  // never "0 +- 0"
  for (int i = 0; i < 99; ++i) few[std::size_t(32 * i)] = 1;
  EXPECT_EQ(verdict(few), "only 99 histories have scored");
  uneven[7] = 600;
  EXPECT_TRUE(verdict(uneven).ends_with("effective scores"));
  spiky[7] = 270;
  EXPECT_EQ(verdict(spiky), "one history carries 5 % of the sum");
  std::vector<double> tail(32 * 10000, 1.0);
  tail[5] = 3000;
  EXPECT_EQ(verdict(tail).substr(0, 20), "variance of variance");
}

// A small scene with every kind of event.
World small_world() {
  World world;
  BodyId const body = world.add_body("all", {});
  Optic mixed;
  mixed.reflect = 0.4;
  mixed.laws = 1;
  mixed.law[0] = world.add_law(Lambertian{0.4});
  std::uint32_t const shiny = world.add_optic(mixed), black = black_optic(world);
  SurfaceId const low = world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, shiny, black, body, world.add_group("low"));
  SurfaceId const high =
      world.add_surface(Disk{{0, 0, 1}, {0, 0, -1}, 0, 1}, shiny, black, body, world.add_group("high"));
  world.add_footprint(spot(low, {}, {0, 0, -1}, Profile::gaussian, 0.3, world.add_port("low")));
  world.add_footprint(spot(high, {0, 0, 1}, {0, 0, 1}, Profile::even, 0.5, world.add_port("high")));
  world.finish();
  return world;
}

TEST(SumTree, BitsDoNotDependOnTheOrderOfBlocks) {
  World const world = small_world();
  auto const backend = make_backend("cpu");
  std::vector<BlockSums> blocks;
  for (std::uint64_t b = 0; b < 13; ++b) blocks.push_back(backend->run_block(SteeredWorld::as_given(world), 1, b));
  std::vector<std::uint64_t> order(blocks.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  SumTree straight;
  for (std::uint64_t const b : order) straight.add(0, b, blocks[b]);
  EXPECT_EQ(straight.nodes().size(), 3u);  // 8 + 4 + 1
  EXPECT_EQ(straight.total().histories, 13 * largest_block);
  std::mt19937_64 engine(4);
  bool plain_sum_differs = false;
  for (int round = 0; round < 5; ++round) {
    std::shuffle(order.begin(), order.end(), engine);
    SumTree tree;
    BlockSums plain;  // control: blocks added as they come
    for (std::uint64_t const b : order) {
      tree.add(0, b, blocks[b]);
      plain = merged(std::move(plain), blocks[b]);
    }
    EXPECT_TRUE(same(tree.total(), straight.total()));
    plain_sum_differs = plain_sum_differs || !same(plain, straight.total());
  }
  EXPECT_TRUE(plain_sum_differs);
}

TEST(SumTree, DuplicateBlocksAreErrors) {
  SumTree tree;
  tree.add(0, 4, {});
  EXPECT_THROW(tree.add(0, 4, {}), std::logic_error);
  tree.add(0, 5, {});
  EXPECT_THROW(tree.add(0, 4, {}), std::logic_error);  // inside the node of 4 and 5
  EXPECT_THROW(tree.add(2, 1, {}), std::logic_error);  // around it
  EXPECT_NO_THROW(tree.add(1, 3, {}));
  EXPECT_NO_THROW(tree.add(0, 0, {}));
  EXPECT_EQ(tree.nodes().size(), 2u);
}

// Priority sampling: the sum of max(coupling, threshold) over the kept scores of any subset is unbiased.
TEST(Records, SubsetSumsAreUnbiased) {
  std::mt19937_64 engine(9);
  std::uniform_real_distribution<double> uniform;
  std::vector<double> scores(3000);
  double truth = 0;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    scores[i] = std::pow(uniform(engine), 3);
    if (i % 3 == 0) truth += scores[i];
  }
  Sampler subset, without_threshold;
  for (int round = 0; round < 400; ++round) {
    ClassSums sums;
    for (std::size_t i = 0; i < scores.size(); ++i)
      sums.kept.push_back({i, 0, 0, scores[i], scores[i] / (1 - uniform(engine))});
    keep_largest(sums);
    ASSERT_EQ(sums.kept.size(), records_per_class);
    double estimated = 0, wrong = 0;
    for (ScoreAddress const& s : sums.kept)
      if (s.history % 3 == 0) {
        estimated += std::max(s.coupling, sums.threshold);
        wrong += s.coupling;
      }
    subset.add(estimated);
    without_threshold.add(wrong);
  }
  expect_mean("subset", subset.mean(), truth, 3e-2 * truth);
  expect_rejected("without threshold", without_threshold.mean(), truth);
}

TEST(Records, KeptSetIsTheSameHoweverItIsMerged) {
  std::mt19937_64 engine(10);
  std::uniform_real_distribution<double> uniform;
  std::vector<ClassSums> parts(8);
  ClassSums whole;
  for (std::size_t i = 0; i < 4000; ++i) {
    double const score = uniform(engine);
    ScoreAddress const s{i, 1, 2, score, score / (1 - uniform(engine))};
    parts[i % 8].kept.push_back(s);
    whole.kept.push_back(s);
  }
  keep_largest(whole);
  BlockSums all;
  for (ClassSums& part : parts) {
    keep_largest(part);
    BlockSums block;
    block.classes[1] = part;
    all = merged(std::move(all), block);
  }
  EXPECT_TRUE(same(all.classes[1], whole));
}

// Records of a traced class: weights sum to the class mean and represent the right paths.
TEST(Records, WeightsOfATracedClass) {
  World const world = small_world();
  Sampler share;
  double truth = 0, total = 0;
  struct Split : Silent {
    WorldView view;
    double analog = 0, all = 0;
    void score(PathState const& p, Vertex const& v, std::uint32_t lit, std::uint32_t number, Vertex const& y,
               double f) {
      if (route_of(view, p, v, lit, number, y.surface).vertices != 2 || lit == p.source ||
          view.lit[lit].surface.value != 1)
        return;
      all += f;
      if (is_hit(number)) analog += f;
    }
  } split;
  split.view = world.view();
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    TraceResult const r = run_histories(world, 2 * largest_block, seed);
    walk(
        world, 2 * largest_block, split, [] {}, seed);
    CouplingClass const* c = find_route(r, "low·S > high·S");
    ASSERT_NE(c, nullptr);
    ASSERT_EQ(c->records.size(), records_per_class);
    double sum = 0, analog = 0;
    for (PathRecord const& p : c->records) {
      sum += p.weight;
      if (is_hit(p.connection)) analog += p.weight;
    }
    EXPECT_NEAR(sum, c->coupling.mean, 1e-12 * sum);
    share.add(analog / sum);
  }
  truth = split.analog;
  total = split.all;
  expect_mean("analog share", share.mean(), truth / total, 4e-2);
  expect_rejected("share by number of records", share.mean(), 0.5);
}

}  // namespace
}  // namespace straytrace::testing
