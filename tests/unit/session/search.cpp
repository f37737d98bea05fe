// SPDX-License-Identifier: BSD-3-Clause
// The search of `straytrace optimise` on objectives whose optimum is known (docs/theory/optimisation.md, eq. O.7, O.8).
#include "session/optimise/search.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "base/math/rng.hpp"

namespace straytrace::session {
namespace {

using Point = std::vector<double>;
using Function = std::function<double(Point const&)>;

// `limits` are logarithms, met at 0 or below.
SearchProblem problem_of(std::vector<SearchRange> ranges, Point start, Function const& cost,
                         std::vector<Function> const& limits) {
  SearchProblem p;
  p.ranges = std::move(ranges);
  p.start = std::move(start);
  p.price = cost;
  p.tolerance = 1e-7;
  p.most = 400;
  p.evaluate = [cost, limits](Point const& x, int) {
    Candidate c{x, cost(x), {}, 0, 0};
    for (Function const& limit : limits) c.excess.push_back(limit(x));
    return std::optional(c);
  };
  return p;
}

double gap_cost(Point const& x) { return 2 * x[0] * x[0] + 1e4 * std::exp(-2 * x[0] * x[0] / (0.06 * 0.06)); }

TEST(Search, ApertureAgainstClipping) {  // eq. O.7: a, J
  SearchResult const r = search(problem_of({{0.05, 0.4}}, {0.2}, gap_cost, {}));
  ASSERT_TRUE(r.best());
  EXPECT_NEAR(r.best()->at[0] / 0.16342243, 1, 1e-5);
  EXPECT_NEAR(r.best()->objective / 0.05701378, 1, 1e-6);
  EXPECT_LT(r.all.size(), 80u);
}

TEST(Search, LengthAgainstDistance) {
  auto const cost = [](Point const& x) { return 50 * x[0] + 3e6 * std::pow(x[0], -4); };
  SearchResult const r = search(problem_of({{2, 100}}, {60}, cost, {}));
  ASSERT_TRUE(r.best());
  EXPECT_NEAR(r.best()->at[0] / 11.913579, 1, 1e-5);
  EXPECT_NEAR(r.best()->objective / 744.59869, 1, 1e-6);
}

// Cost sum c/beta^q of blacker surfaces under sum a beta^n <= S (eq. O.8).
struct Blackness {
  double a[2], c[2], n[2], q[2];
  double cost(Point const& x) const { return c[0] * std::pow(x[0], -q[0]) + c[1] * std::pow(x[1], -q[1]); }
  double light(Point const& x) const {
    return std::log((a[0] * std::pow(x[0], n[0]) + a[1] * std::pow(x[1], n[1])) / 1e-11);
  }
  SearchResult found(double sign) const {
    return search(problem_of({{1e-4, 0.1}, {1e-4, 0.1}}, {0.02, 0.02}, [this](Point const& x) { return cost(x); },
                             {[=, this](Point const& x) { return sign * light(x); }}));
  }
};

TEST(Search, PriceOfBlackness) {
  Blackness const linear{{3e-9, 5e-10}, {2, 0.3}, {1, 1}, {1, 1}};
  SearchResult const r = linear.found(1);
  ASSERT_TRUE(r.best());
  EXPECT_NEAR(r.best()->objective / 804.73666, 1, 1e-5);
  EXPECT_NEAR(r.best()->at[0] / 2.87824e-3, 1, 2e-3);
  EXPECT_NEAR(r.best()->at[1] / 2.73054e-3, 1, 2e-3);
  // The cost is inverse to S, so d cost/d ln S = -cost (eq. O.9).
  ASSERT_EQ(r.multipliers.size(), 1u);
  EXPECT_NEAR(r.multipliers[0].value / 804.73666, 1, 0.01);
  // Negative control: a limit of the wrong sign leaves the cheapest corner.
  SearchResult const wrong = linear.found(-1);
  ASSERT_TRUE(wrong.best());
  EXPECT_LT(wrong.best()->objective, 100);
}

TEST(Search, PriceOfBlacknessWithPowers) {
  Blackness const powers{{3e-9, 8e-7}, {2, 0.3}, {1, 2}, {1, 0.5}};
  SearchResult const r = powers.found(1);
  ASSERT_TRUE(r.best());
  EXPECT_NEAR(r.best()->objective / 621.67159, 1, 1e-5);
  EXPECT_NEAR(r.best()->at[0] / 3.30956e-3, 1, 2e-3);
  EXPECT_NEAR(r.best()->at[1] / 2.98570e-4, 1, 2e-3);
  // d cost/d ln S = -mu S, mu = c q/(n a beta^(n + q)) of either.
  double const price = 2 / (3e-9 * std::pow(3.30956e-3, 2)) * 1e-11;
  EXPECT_NEAR(r.multipliers.at(0).value / price, 1, 0.01);
}

// Cost x + 0.01/x with its optimum at 0.1: a limit beyond has no price, one before it that of the slope.
TEST(Search, PriceOfALimit) {
  for (double const limit : {0.2, 0.06}) {
    auto const cost = [](Point const& x) { return x[0] + 0.01 / x[0]; };
    auto const far = [=](Point const& x) { return std::log(x[0] / limit); };
    SearchResult const r = search(problem_of({{0.02, 0.4}}, {0.05}, cost, {far}));
    ASSERT_TRUE(r.best());
    EXPECT_NEAR(r.best()->at[0], std::min(limit, 0.1), 1e-3);
    EXPECT_NEAR(r.multipliers.at(0).value, limit > 0.1 ? 0 : 0.01 / limit - limit, 1e-3) << limit;
  }
}

// Costs that fall by more than the first penalty where a limit is broken (eq. O.3): x^-30 above x = 0.02, x1^-40 x2^-2
// under a limit on the product. The multiplier is the exponent.
TEST(Search, SteepCosts) {
  auto const steep = [](Point const& x) { return std::pow(x[0], -30); };
  SearchResult const r =
      search(problem_of({{1e-3, 0.1}}, {0.01}, steep, {[](Point const& x) { return std::log(x[0] / 0.02); }}));
  ASSERT_TRUE(r.best());
  EXPECT_NEAR(r.best()->at[0] / 0.02, 1, 1e-5);
  EXPECT_NEAR(r.multipliers.at(0).value / r.best()->objective, 30, 0.1);
  EXPECT_LT(r.all.size(), 80u);

  auto const two = [](Point const& x) { return std::pow(x[0], -40) * std::pow(x[1], -2); };
  auto const product = [](Point const& x) { return std::log(x[0] * x[1] / 0.01); };
  SearchResult const q = search(problem_of({{0.05, 0.5}, {0.05, 0.5}}, {0.08, 0.08}, two, {product}));
  ASSERT_TRUE(q.best());
  EXPECT_NEAR(q.best()->at[0], 0.2, 1e-4);
  EXPECT_NEAR(q.best()->at[1], 0.05, 1e-4);
}

// The multiplier of the price of blackness (eq. O.8, O.9) with a measured limit: its error from the replicas, which all
// candidates share, against its scatter over 24 seeds. Control: without deviations it has no error.
TEST(Search, ErrorsOfMultipliers) {
  Blackness const linear{{3e-9, 5e-10}, {2, 0.3}, {1, 1}, {1, 1}};
  double square = 0, off = 0;
  constexpr int seeds = 24;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    std::vector<std::array<double, 2>> gains(replica_count);  // of a replica: a power of either surface
    for (std::size_t k = 0; k < gains.size(); ++k)
      for (std::uint64_t i : {0, 1})
        gains[k][i] = 0.05 * (Rng(seed, k, i, Stream::source).uniform() < 0.5 ? -1 : 1) / std::sqrt(32.0);
    SearchProblem p =
        problem_of({{1e-4, 0.1}, {1e-4, 0.1}}, {0.02, 0.02}, [&](Point const& x) { return linear.cost(x); }, {});
    p.tolerance = 1e-3;
    p.evaluate = [&](Point const& x, int) {
      Candidate c{x, linear.cost(x), {linear.light(x)}, 0, 0};
      for (auto const& gain : gains) {
        c.deviations.push_back(gain[0] * std::log(x[0] / 3e-3) + gain[1] * std::log(x[1] / 3e-3));
        c.excess[0] += c.deviations.back();
      }
      c.excess_deviations = {c.deviations};
      return std::optional(c);
    };
    SearchResult const r = search(p);
    ASSERT_TRUE(r.best());
    WithError const m = r.multipliers.at(0);
    double const truth = 804.73666;
    ASSERT_GT(m.sigma, 0);
    square += std::pow((m.value - truth) / m.sigma, 2) / seeds;
    off += m.sigma / truth / seeds;
  }
  EXPECT_GT(off, 0.005);
  EXPECT_LT(off, 0.1);
  EXPECT_GT(std::sqrt(square), 0.6);
  EXPECT_LT(std::sqrt(square), 1.5);
  EXPECT_EQ(linear.found(1).multipliers.at(0).sigma, 0);
}

// Noise of 5 % that all points share does not move the optimum; of its own for each point it does (negative control).
TEST(Search, CommonNoiseLeavesTheOptimum) {
  int far = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    auto const noise = [seed](std::uint64_t point) {
      return 1 + 0.05 * std::sqrt(12.0) * (Rng(seed, point, 0, Stream::source).uniform() - 0.5);
    };
    auto const common = [&](Point const& x) { return noise(0) * gap_cost(x); };
    auto const own = [&](Point const& x) { return noise(std::uint64_t(1e12 * x[0])) * gap_cost(x); };
    SearchResult const together = search(problem_of({{0.05, 0.4}}, {0.2}, common, {}));
    EXPECT_NEAR(together.best()->at[0] / 0.16342243, 1, 1e-3);
    far += std::fabs(search(problem_of({{0.05, 0.4}}, {0.2}, own, {})).best()->at[0] / 0.16342243 - 1) > 1e-3;
  }
  EXPECT_GE(far, 6);
}

// Noise that a walk along the aperture makes in each replica, of variance 1/histories: more of them where it hides the
// predicted gain (eq. O.10). Controls: the first histories alone find another optimum; the largest number from the
// beginning costs more.
TEST(Search, HistoriesGrowWhereTheErrorHidesTheGain) {
  enum { coarse, growing, fine };
  double off[3] = {}, spent[3] = {};
  for (std::uint64_t seed = 1; seed <= 8; ++seed)
    for (int const way : {coarse, growing, fine}) {
      auto const walk = [seed](int level, std::uint64_t replica, double x) {
        double sum = 0;
        for (std::uint64_t n = 0; n < std::uint64_t(2000 * x); ++n)
          sum += Rng(seed, n, replica + 100 * std::uint64_t(level), Stream::source).uniform() < 0.5 ? -1 : 1;
        return 1e-3 * std::pow(0.5, level) * sum;
      };
      SearchProblem p = problem_of({{0.05, 0.4}}, {0.35}, {}, {});
      p.price = {};
      p.levels = way == growing ? 4 : 1;
      p.tolerance = 2e-3;
      p.evaluate = [&](Point const& x, int level) {
        level = way == fine ? 3 : level;
        Candidate c{x, std::log(gap_cost(x)), {}, 0, 0};
        double square = 0;
        for (std::uint64_t r = 0; r < 32; ++r) {
          c.deviations.push_back(walk(level, r, x[0]) / 32);
          c.objective += c.deviations.back();
          square += std::pow(c.deviations.back(), 2);
        }
        c.sigma = std::sqrt(square);
        spent[way] += std::pow(4, level) / 8;
        return std::optional(c);
      };
      SearchResult const r = search(p);
      ASSERT_TRUE(r.closest());
      off[way] += std::fabs(r.closest()->at[0] / 0.16342243 - 1) / 8;
    }
  EXPECT_LT(off[growing], 0.6 * off[coarse]) << off[fine];
  EXPECT_LT(spent[growing], 0.8 * spent[fine]) << spent[coarse];
}

// Baffles by the shadow rule, a count with steps (eq. 8.16); the noise falls with the rim. Compared with a scan of the
// range in steps of 2 um.
TEST(Search, StepsOfACount) {
  auto const count = [](Point const& x) {
    double const ratio = (0.5 + 0.31) / (x[0] + 0.31), reach = 10e3 * ratio / (1 + ratio);
    return 2 * std::ceil(std::log(reach / 32.35) / std::log(ratio));
  };
  for (double const line : {0.05, 0.04, 0.033}) {
    auto const noise = [=](Point const& x) { return std::log(0.0492 * std::pow(x[0] / 0.3495, -1.96) / line); };
    double cheapest = infinity, rim = 0;
    for (double a = 0.30; a <= 0.49; a += 2e-6)
      if (noise({a}) <= 0 && count({a}) <= cheapest) {
        cheapest = count({a});
        rim = a;
      }
    SearchProblem p = problem_of({{0.30, 0.49}}, {0.42}, count, {noise});
    p.tolerance = 0.01;
    SearchResult const r = search(p);
    ASSERT_TRUE(r.best()) << line;
    EXPECT_EQ(r.best()->objective, cheapest) << line;
    EXPECT_NEAR(r.best()->at[0], rim, 2e-5) << line;  // the quietest of this count
    double const multiplier = r.multipliers.at(0).value;
    EXPECT_TRUE(multiplier == 0 || std::isnan(multiplier)) << "steps have no slope";
    EXPECT_LT(r.all.size(), 40u) << line;
  }
}

TEST(Search, WholeNumbers) {
  auto const cost = [](Point const& x) { return 800 * x[0] + 20 / x[1]; };
  auto const noise = [](Point const& x) { return std::log(3 / x[0] + 2 * x[1]); };
  double cheapest = infinity;
  for (double n = 1; n <= 60; ++n)
    for (double b = 0.01; b <= 1; b *= 1.00001)
      if (noise({n, b}) <= 0) cheapest = std::min(cheapest, cost({n, b}));
  SearchResult const r = search(problem_of({{1, 60, true}, {0.01, 1}}, {30, 0.1}, cost, {noise}));
  ASSERT_TRUE(r.best());
  EXPECT_NEAR(r.best()->objective / cheapest, 1, 1e-4);
  EXPECT_EQ(r.best()->at[0], std::round(r.best()->at[0]));
}

// From a start that breaks a relation, where nothing is measured. Control: without the relation the start is measured.
TEST(Search, StartsWhereNothingIsMeasured) {
  for (bool const related : {true, false}) {
    SearchProblem p = problem_of({{0.1, 10}, {0.1, 10}}, {9, 9}, {}, {});
    p.evaluate = [=](Point const& x, int) {
      double const relation = (x[0] - 2) / std::max(x[0], 2.0);
      bool const measured = !related || relation <= 0;
      Candidate c{x, measured ? std::log(x[1] / x[0] + x[0] / 8) : not_a_number, {relation}, 0, 0};
      if (!related) c.excess = {-1};
      return std::optional(c);
    };
    p.price = {};
    SearchResult const r = search(p);
    ASSERT_TRUE(r.best());
    EXPECT_NEAR(r.best()->at[0], std::sqrt(0.8), 0.01);
    EXPECT_NEAR(r.best()->at[1], 0.1, 1e-4);
    EXPECT_EQ(std::isnan(r.all.front().objective), related);
  }
}

TEST(Search, NothingMeetsTheLimit) {
  auto const cost = [](Point const& x) { return x[0]; };
  auto const noise = [](Point const& x) { return std::log(2 / x[0]); };
  SearchResult const r = search(problem_of({{0.1, 1}}, {0.5}, cost, {noise}));
  EXPECT_FALSE(r.best());
  ASSERT_TRUE(r.closest());
  EXPECT_NEAR(r.closest()->at[0], 1, 1e-6);  // the end of the range
}

TEST(Search, StopsBetweenEvaluations) {
  SearchProblem p = problem_of({{0.05, 0.4}}, {0.2}, gap_cost, {});
  auto const whole = p.evaluate;
  int left = 4;
  p.evaluate = [&](Point const& x, int) { return left-- > 0 ? whole(x, 0) : std::nullopt; };
  SearchResult const r = search(p);
  EXPECT_TRUE(r.stopped);
  EXPECT_EQ(r.all.size(), 4u);
}

}  // namespace
}  // namespace straytrace::session
