// SPDX-License-Identifier: BSD-3-Clause
// Whether a curve lies below a line in all bins at once (docs/theory/optimisation.md, eq. O.2).
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <gtest/gtest.h>

#include <cmath>

#include "base/math/rng.hpp"
#include "session/optimise/evaluator.hpp"

namespace straytrace::session {
namespace {

constexpr int replicas = 32;

double gaussian(std::uint64_t seed, std::uint64_t number) {
  return boost::math::quantile(boost::math::normal(), Rng(seed, number, 1, Stream::source).uniform());
}

// A curve that is 1 in every bin, as 32 replicas measure it; of the noise a part is common to all bins.
NoiseBudget measured(std::uint64_t seed, std::size_t bins, double common) {
  NoiseBudget b;
  b.grid = logarithmic_grid(10, 100, double(bins));
  std::vector<std::vector<double>> sums(replicas, std::vector<double>(bins));
  for (int r = 0; r < replicas; ++r)
    for (std::size_t i = 0; i < bins; ++i)
      sums[std::size_t(r)][i] = 0.1 * (std::sqrt(common) * gaussian(seed, std::uint64_t(r)) +
                                       std::sqrt(1 - common) * gaussian(seed, 100 + std::uint64_t(r) * bins + i));
  b.total.without.assign(replicas, std::vector<double>(bins));
  for (std::size_t i = 0; i < bins; ++i) {
    double mean = 0, square = 0;
    for (auto const& own : sums) mean += own[i] / replicas;
    b.total.asd.push_back(1 + mean);
    for (int r = 0; r < replicas; ++r) {
      double const d = (sums[std::size_t(r)][i] - mean) / std::sqrt(double(replicas) * (replicas - 1));
      // The PSD without this replica, so that it changes the ASD by d.
      b.total.without[std::size_t(r)][i] = -2 * b.total.asd[i] * d * std::sqrt(replicas / (replicas - 1.0));
      square += d * d;
    }
    b.total.sigma.push_back(std::sqrt(square));
  }
  return b;
}

// With Student's t for 31 degrees of freedom.
double student(double probability) { return boost::math::quantile(boost::math::students_t(replicas - 1), probability); }

TEST(Confidence, FactorOfOneBin) {
  EXPECT_NEAR(factor_of_all(deviations(measured(1, 1, 0).total), 0.95), student(0.95), 1e-9);
  EXPECT_NEAR(student(0.95), 1.696, 1e-3);
}

TEST(Confidence, FactorOfEqualBinsIsThatOfOne) {
  EXPECT_NEAR(factor_of_all(deviations(measured(1, 20, 1).total), 0.95), student(0.95), 0.05);
}

// Replicas that act on one bin each: independent errors, whose largest exceeds z with 1 - Phi(z)^2.
TEST(Confidence, FactorOfIndependentBins) {
  std::vector<std::vector<double>> single(replicas, std::vector<double>(2));
  for (int r = 0; r < replicas; ++r) single[std::size_t(r)][std::size_t(r % 2)] = gaussian(3, std::uint64_t(r));
  double const expected = student(std::sqrt(0.95));
  EXPECT_NEAR(factor_of_all(single, 0.95), expected, 0.07);
  EXPECT_GT(expected - student(0.95), 0.25);  // negative control: the factor of one bin
}

// A candidate on the line is accepted in 5 % of 400 seeds, at most 33 (5 % and 3 sigma). Without the factor in half.
TEST(Confidence, AcceptanceOnTheLine) {
  for (auto const& [bins, common] : {std::pair<std::size_t, double>{1, 0}, {40, 0.9}}) {
    int accepted = 0, plain = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
      NoiseBudget const b = measured(seed, bins, common);
      LineVerdict const v = compared(b, std::vector<double>(bins, 1.0), 0.95);
      accepted += v.excess <= 0;
      plain += *std::max_element(b.total.asd.begin(), b.total.asd.end()) <= 1;
    }
    EXPECT_LE(accepted, 33) << bins;
    EXPECT_GT(plain, 50) << bins;
    EXPECT_GE(accepted, bins == 1 ? 7 : 0);
  }
}

// Unresolved routes with a hundredth of the power count tenfold; control: resolved ones do not.
TEST(Confidence, UnresolvedRoutesCountTenfold) {
  NoiseBudget b = measured(1, 3, 0);
  double const resolved = compared(b, {1, 1, 1}, 0.95).excess;
  b.unresolved = {"other: only 40 effective scores"};
  b.unresolved_hint = 0.01;
  LineVerdict const v = compared(b, {1, 1, 1}, 0.95);
  EXPECT_NEAR(v.excess - resolved, 0.5 * std::log(1.09), 1e-12);
  EXPECT_TRUE(v.ratio.incomplete);
}

TEST(Confidence, BinsWithoutALineAreLeftOut) {
  NoiseBudget b = measured(1, 3, 0);
  b.total.asd[1] = 100;
  LineVerdict const v = compared(b, {1, not_a_number, 2}, 0.95);
  EXPECT_EQ(v.hz, b.grid.centre(0));
  EXPECT_LT(v.ratio.value, 1.2);
  EXPECT_TRUE(std::isnan(compared(b, {not_a_number, not_a_number, not_a_number}, 0.95).excess));
}

}  // namespace
}  // namespace straytrace::session
