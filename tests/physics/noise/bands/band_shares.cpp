// SPDX-License-Identifier: BSD-3-Clause
// Shares of uncertain inputs in the band of ln h, by samples (docs/theory/decisions.md, eq. D.12 to D.14).
#include "noise/bands/input_band.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing::noise_band_shares {
namespace {

// S = 0.5 s1 s2 + 0.3 s1^2 + 0.15 s2^2 + 0.05 s1; one standard deviation is a factor.
UncertainPsd polynomial(double factor_1, double factor_2) {
  return {{{1, 1}, {2, 0}, {0, 2}, {1, 0}},
          {{0.5}, {0.3}, {0.15}, {0.05}},
          {},
          {std::log(factor_1), std::log(factor_2)},
          {false}};
}
// e = (1.15, 0.8)/2 of h.
double linear_band(double factor_1, double factor_2) {
  return 0.5 * std::hypot(1.15 * std::log(factor_1), 0.8 * std::log(factor_2));
}

// Indices of ln S from 4e6 random draws: 0.926 and 0.067. Controls: first order has 0.935, shares of the standard
// deviations alone 0.875; it is good enough here, so that nothing is sampled with the true band.
TEST(BandShares, AreFirstOrderSobolIndicesOfTheLogarithm) {
  EXPECT_NEAR(linear_band(2, 1.3), 0.41214, 1e-5);
  BandShares const s = sampled_shares(polynomial(2, 1.3), {1e-3});
  ASSERT_TRUE(s.sampled[0]);
  EXPECT_NEAR(s.share[0][0], 0.926, 2e-3);
  EXPECT_NEAR(s.share[1][0], 0.067, 2e-3);
  EXPECT_GT(std::fabs(s.share[0][0] - std::pow(std::log(2) / std::hypot(std::log(2), std::log(1.3)), 2)), 0.04)
      << "control";
  EXPECT_GT(std::fabs(s.share[0][0] - std::pow(1.15 * std::log(2) / 2 / 0.41214, 2)), 5e-3) << "control";
  EXPECT_FALSE(sampled_shares(polynomial(2, 1.3), {linear_band(2, 1.3)}).sampled[0]) << "control";
  EXPECT_TRUE(sampled_shares(polynomial(20, 1.3), {linear_band(20, 1.3)}).sampled[0]);
}

// Nearly one term: ln S is a straight line, for which eq. D.5 and D.6 are exact.
TEST(BandShares, OfAStraightLineAreThoseOfFirstOrder) {
  double const a = std::log(2), b = std::log(1.5), band = 0.5 * std::hypot(a, 2 * b),
               share = std::pow(0.5 * a / band, 2);
  BandShares const s = sampled_shares({{{1, 2}, {1, 1}}, {{3e-50}, {3e-56}}, {}, {a, b}, {false}}, {1e-12});
  ASSERT_TRUE(s.sampled[0]);
  EXPECT_NEAR(s.band[0] / band, 1, 3e-3);
  EXPECT_NEAR(s.share[0][0], share, 1e-3);
  EXPECT_NEAR(s.share[0][0] + s.share[1][0], 1, 3e-3);
  EXPECT_NEAR(s.halving[0][0], 1 - std::sqrt(1 - 0.75 * share), 1e-3);
}

UncertainPsd of_motions(std::vector<Spectrum> const& spectra, std::vector<PhaseSensitivity> const& path,
                        double factor) {
  MotionSet motion = moving(spectra);
  for (MotionInput& in : motion.inputs) in.uncertainty = factor;
  CouplingTable const table = known_table({known_class(1, 1e-20, {record(0, 1e-20, path)})});
  return uncertain_psd(table, {}, motion, motion_causes(motion), UnitDetector(),
                       on({1, 1.02, 9.99, 10.01, 19.99, 20.01}));
}

// Slow motion with a fringe spectrum of width w = 10 Hz: ln h = -t/2 - a exp(-2 t), a = f^2/(4 w^2), with
// var = u^2/4 + a^2 (e^(8 u^2) - e^(4 u^2)) - 2 a u^2 e^(2 u^2) (eq. 7.8). At f = w the elasticity is 0, so that first
// order has no band. Control: half of the variance.
TEST(BandShares, OfWrappedMotionHaveTheirClosedForm) {
  double const u = std::log(1.2);
  UncertainPsd const psd = of_motions({around_zero(10 / two_k)}, {phase_sensitivity(0, 2, two_k)}, 1.2);
  BandShares const s = sampled_shares(psd, {10, 10, 0.008 * u, 10, 1.5 * u});
  EXPECT_TRUE(s.sampled[2] && s.sampled[4]);
  EXPECT_FALSE(s.sampled[3]) << "control: its band is wide";
  for (auto const& [bin, a] : {std::pair{2, 0.25}, std::pair{4, 1.0}}) {
    double const q = u * u,
                 variance = q / 4 + a * a * (std::exp(8 * q) - std::exp(4 * q)) - 2 * a * q * std::exp(2 * q);
    EXPECT_NEAR(s.band[std::size_t(bin)] / std::sqrt(variance), 1, 0.05) << bin;
    EXPECT_NEAR(s.share[0][std::size_t(bin)], 1, 0.02);
    EXPECT_NEAR(s.halving[0][4], 0.55, 0.05);
  }
}

// Weak motions of two bodies add their powers; strong ones of one path do not.
TEST(BandShares, AreNotKnownWhereMotionsDoNotAdd) {
  std::vector<PhaseSensitivity> const path{phase_sensitivity(0, 2, two_k), phase_sensitivity(1, 2, two_k)};
  for (double const phase : {1e-3, 4.0}) {
    UncertainPsd const psd = of_motions({around_zero(phase / two_k), around_zero(phase / two_k)}, path, 1.5);
    BandShares const s = sampled_shares(psd, std::vector<double>(5, 1e-4));
    for (std::size_t const bin : {0, 2}) {
      if (bin == 2 && phase < 1) continue;  // no light moves that fast
      EXPECT_TRUE(s.sampled[bin]);
      EXPECT_EQ(psd.not_additive[bin], phase > 1) << phase;
      EXPECT_EQ(std::isnan(s.band[bin]), phase > 1);
    }
    // S = x1^2 + x2^2: each half of the variance, but for the curvature.
    if (phase < 1) {
      EXPECT_NEAR(s.share[0][0], 0.5, 0.03);
    }
  }
}

}  // namespace
}  // namespace straytrace::testing::noise_band_shares
