// SPDX-License-Identifier: BSD-3-Clause
// Tail slope and halves of an estimate (docs/theory/errors.md): known distributions, merging in any order, and
// verdicts.
#include <algorithm>
#include <random>

#include "support/trace_support.hpp"

namespace straytrace::testing::trace_diagnostics {
namespace {

constexpr std::size_t per_block = 1000, scored = 100 * tail_size;

BlockSums block_of(std::vector<double> const& totals, std::size_t block) {
  BlockSums sums;
  sums.blocks = 1;
  sums.histories = per_block;
  Moments& m = sums.classes[7].moments;
  for (std::size_t i = block * per_block; i < std::min((block + 1) * per_block, totals.size()); ++i)
    m.add_score(totals[i], i);
  m.close_block();
  return sums;
}
BlockSums summed(std::vector<double> const& totals) {
  SumTree tree;
  for (std::size_t b = 0; b * per_block < totals.size(); ++b) tree.add(0, b, block_of(totals, b));
  return tree.total();
}
Estimate estimate_of(BlockSums const& sums) {
  return estimate(sums.classes.at(7).moments, sums.histories, sums.blocks);
}

// Density (p - 1) x^-p above 1.
std::vector<double> pareto(double p, std::size_t n, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform;
  std::vector<double> x(n);
  for (double& value : x) value = std::pow(1 - uniform(engine), -1 / (p - 1));
  return x;
}

// Hill's estimate of the exponent: standard error (p - 1)/sqrt(200). Control: an exponent half as large again.
TEST(TailSlope, OfPowerLaws) {
  for (double const p : {2.2, 3.0, 5.0}) {
    double const slope = estimate_of(summed(pareto(p, 4 * scored, 1))).tail_slope, error = (p - 1) / std::sqrt(200.0);
    EXPECT_NEAR(slope, p, 4 * error);
    EXPECT_GT(std::fabs(slope - 1.5 * p), 4 * error);
  }
  std::mt19937_64 engine(2);
  std::exponential_distribution<double> draw;
  std::vector<double> light(scored);
  for (double& x : light) x = draw(engine);
  EXPECT_GT(estimate_of(summed(light)).tail_slope, 5);
  EXPECT_TRUE(estimate_of(summed(std::vector<double>(scored, 2.0))).tail_slope == infinity);
}

// A tail of infinite variance whose largest totals happen to be missing: nothing else objects.
TEST(TailSlope, Status) {
  std::vector<double> open = pareto(2.4, 2 * scored, 3);
  std::erase_if(open, [](double value) { return value > 600; });
  open.resize(39 * per_block);
  Estimate const heavy = estimate_of(summed(open));
  EXPECT_LT(heavy.variance_of_variance, 0.1);
  EXPECT_LT(heavy.largest_share, 0.05);
  EXPECT_FALSE(heavy.trusted);
  EXPECT_LT(heavy.tail_slope, 3);
  EXPECT_EQ(heavy.why_not.substr(0, 43), "the largest histories fall as slowly as x^-");
  // with too few scores the largest are not a tail, and are not tested
  open.resize(scored - per_block);
  EXPECT_TRUE(std::isnan(estimate_of(summed(open)).tail_slope));
  EXPECT_EQ(estimate_of(summed(pareto(5, 2 * scored, 3))).why_not, "");
}

// The slope of 200 totals is known to (p - 1)/sqrt(200): rows fail when it is below 3 by two errors. A
// log-normal spread of 1.5 has finite variance and good error bars, and a slope of 3 in 20 000 scores. Control: the
// limit at 3 itself rejects most of such rows, and keeps those that are too low.
TEST(TailSlope, LimitIncludesItsError) {
  std::mt19937_64 engine(11);
  std::normal_distribution<double> draw;
  int sound = 0, rejected = 0, below = 0, inside = 0;
  Sampler shift, control;
  double const exact = std::exp(1.5 * 1.5 / 2);
  for (int run = 0; run < 200; ++run) {
    std::vector<double> x(40 * per_block);
    for (double& value : x) value = 0;
    for (std::size_t i = 0; i < scored; ++i) x[2 * i] = std::exp(1.5 * draw(engine));
    Estimate const e = estimate_of(summed(x));
    bool const tail = e.why_not.starts_with("the largest histories");
    if (!e.trusted && !tail) continue;  // failed for another reason
    ++sound;
    rejected += tail;
    double const z = (2 * e.mean - exact) / (2 * e.std_error);
    if (!tail) {
      shift.add(z);
      inside += std::fabs(z) < 2;
    }
    if (e.tail_slope < 3)
      ++below;
    else
      control.add(z);
  }
  EXPECT_GT(sound, 150);
  EXPECT_LT(rejected, sound / 10);
  EXPECT_GT(inside, (sound - rejected) * 0.88);
  EXPECT_GT(shift.mean().mean, -0.4);
  EXPECT_GT(below, sound / 2);
  EXPECT_LT(control.mean().mean, -0.4);
}

TEST(TailSlope, KeptTotalsDoNotDependOnOrder) {
  std::vector<double> const x = pareto(3, 40 * per_block, 5);
  std::vector<double> largest = x;
  std::sort(largest.begin(), largest.end(), std::greater<>());
  largest.resize(tail_size);
  std::vector<std::size_t> order(40);
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::mt19937_64 engine(6);
  for (int round = 0; round < 5; ++round) {
    SumTree tree;
    for (std::size_t const b : order) tree.add(0, b, block_of(x, b));
    EXPECT_EQ(tree.total().classes.at(7).moments.tail, largest);
    EXPECT_TRUE(same(tree.total(), summed(x)));
    std::shuffle(order.begin(), order.end(), engine);
  }
}

// The border lies between 1/3 and 2/3 of the blocks, in the middle at powers of two, at any position in the tree.
TEST(Halves, FirstPartOfTheBlocks) {
  std::vector<double> x(130 * per_block);
  std::mt19937_64 engine(7);
  std::exponential_distribution<double> draw;
  for (double& value : x) value = draw(engine);
  SumTree tree;
  double first = 0;
  std::vector<double> sum_to{0};
  for (std::uint64_t n = 1; n <= 130; ++n) {
    BlockSums block = block_of(x, n - 1);
    sum_to.push_back(first += block.classes[7].moments.sum);
    tree.add(0, n - 1, std::move(block));
    std::uint64_t const part = first_part(n);
    EXPECT_NEAR(tree.total().classes.at(7).moments.first_sum, sum_to[part], 1e-9 * sum_to[part]) << n;
    if (n < 2) continue;
    EXPECT_GT(3 * part, n - 1) << n;
    EXPECT_LT(3 * part, 2 * n + 1) << n;
    bool const power_of_two = (n & (n - 1)) == 0;
    EXPECT_TRUE(2 * part == n || !power_of_two) << n;
  }
}

// A source that grows by 10 % half-way. Control: one that goes up and down with every block has equal halves.
TEST(Halves, Status) {
  std::mt19937_64 engine(8);
  std::exponential_distribution<double> draw;
  std::vector<double> grows(64 * per_block), alternates(64 * per_block);
  for (std::size_t i = 0; i < grows.size(); ++i) {
    double const x = 1 + 0.3 * draw(engine);
    grows[i] = x * (i < grows.size() / 2 ? 1 : 1.1);
    alternates[i] = x * (i / per_block % 2 ? 1 : 1.1);
  }
  Estimate const e = estimate_of(summed(grows));
  EXPECT_LT(e.halves, -5);
  EXPECT_EQ(e.why_not.substr(0, 37), "its first and second half differ by 8");
  EXPECT_LT(std::fabs(estimate_of(summed(alternates)).halves), 5);
  EXPECT_TRUE(estimate_of(summed(alternates)).trusted);
}
// Equal halves differ by one standard error on average.
TEST(Halves, OfEqualSources) {
  Sampler square;
  std::mt19937_64 engine(9);
  std::exponential_distribution<double> draw;
  for (int run = 0; run < 100; ++run) {
    std::vector<double> x(40 * per_block);
    for (double& value : x) value = draw(engine);
    double const z = estimate_of(summed(x)).halves;
    square.add(z * z);
  }
  expect_mean("mean square", square.mean(), 1, 2);
  expect_rejected("twice the error", scaled(square.mean(), 0.25), 1);
}

}  // namespace
}  // namespace straytrace::testing::trace_diagnostics
