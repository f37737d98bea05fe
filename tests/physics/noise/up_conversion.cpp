// SPDX-License-Identifier: BSD-3-Clause
// Gaussian motion of any strength (docs/theory/spectra.md, eq. 7.7 to 7.10, case A5).
#include "physics/noise/support.hpp"

namespace straytrace::testing {
namespace {

std::vector<double> const around_1_and_10 = {0.98, 1.02, 9.9, 10.1};

TEST(UpConversion, GaussianLineOfTwoMicrometres) {  // A5: exact 0.1 %
  MotionSet const motion = moving({gaussian_line(0.2, 0.05, 2e-6)});
  Spectrum const& s = motion.inputs[0].spectrum;
  double const rms_velocity = std::sqrt(s.rate_power(infinity)), sigma = 2 * rms_velocity / wavelength;
  EXPECT_LT(deviation(rms_velocity, 2.5907e-6), 1e-4);
  EXPECT_LT(deviation(sigma, 4.8697), 1e-4);
  std::vector<double> const psd = fringe_psd(motion, around_1_and_10);
  EXPECT_LT(deviation(psd[0], 8.0235e-2), 1e-3);
  EXPECT_LT(deviation(psd[2], 9.9432e-3), 1e-3);
  auto const quasi_static = [&](double f) {
    return std::exp(-f * f / (2 * sigma * sigma)) / (std::sqrt(2 * pi) * sigma);
  };
  EXPECT_LT(deviation(quasi_static(1), 8.0215e-2), 1e-4);
  EXPECT_LT(deviation(quasi_static(10), 9.9473e-3), 1e-4);
  EXPECT_LT(deviation(psd[0], quasi_static(1)), 1e-3);  // eq. 7.8 is the limit of strong slow motion
  EXPECT_LT(deviation(psd[2], quasi_static(10)), 2e-3);
  // Controls: linear coupling, and 1 % too much motion.
  double const linear = two_k * two_k * s.power(9.9, 10.1) / 0.2 / 2;
  EXPECT_GT(deviation(linear, 9.9432e-3), 0.5);
  EXPECT_GT(deviation(fringe_psd(moving({gaussian_line(0.2, 0.05, 2.02e-6)}), around_1_and_10)[2], 9.9432e-3), 1e-2);
}

TEST(UpConversion, WeakMotionIsLinear) {  // eq. 7.9, tolerance 1e-4
  Spectrum const s = power_law_asd(1e-12, 10, -2, 1, 1000);
  std::vector<double> const edges = {3, 3.1, 10, 10.4, 100, 104};
  std::vector<double> const psd = fringe_psd(moving({s}), edges);
  for (std::size_t i : {0u, 2u, 4u}) {
    double const expected = two_k * two_k * s.power(edges[i], edges[i + 1]) / (edges[i + 1] - edges[i]) / 2;
    EXPECT_LT(deviation(psd[i], expected), 1e-4);
    EXPECT_GT(deviation(psd[i], 2 * expected), 0.4);  // control: without the mean over the static phase
  }
}

// Both sides of the border between linear coupling and the transform give the same spectrum up to the strength of the
// motion. Tolerance: three times the phase power that is taken to first order.
TEST(UpConversion, NoStepWhereTheTransformBegins) {
  double const variance = PhaseSpectra::weak / (two_k * two_k);
  Spectrum const unit = power_law_asd(1, 1, -2, 0.3, 1000);
  auto const per_motion = [&](double strength) {
    Spectrum const s = unit.scaled(strength * variance / unit.total());
    std::vector<double> psd = fringe_psd(moving({s}), {3, 3.1, 30, 31, 300, 310});
    for (double& x : psd) x /= strength;
    return psd;
  };
  std::vector<double> const below = per_motion(0.99), above = per_motion(1.01), strong = per_motion(3000);
  for (std::size_t i = 0; i < below.size(); ++i) {
    EXPECT_LT(deviation(above[i], below[i]), 3 * PhaseSpectra::weak);
  }
  EXPECT_GT(deviation(strong[0], below[0]), 3 * PhaseSpectra::weak);  // control: strong motion is not linear
}

TEST(UpConversion, PowerIsConserved) {  // eq. 7.10, tolerance 1e-4
  std::vector<double> const edges = {0.02, 0.04, 0.3, 3, 30, 300, 3000};
  for (double rms : {1e-10, 1e-8, 1e-7, 1e-6, 1e-5}) {
    MotionSet const motion = moving({gaussian_line(1, 0.2, rms)});
    PhaseSpectrum const s = fringes(motion, edges);
    double in_band = s.constant + s.psd[0] * edges[0];  // flat down to zero
    for (std::size_t i = 0; i < s.psd.size(); ++i) in_band += s.psd[i] * (edges[i + 1] - edges[i]);
    EXPECT_NEAR(in_band, 0.5, 1e-4) << rms;
    EXPECT_NEAR(s.constant, std::exp(-std::pow(two_k * rms, 2)) / 2, 1e-4) << rms;
    if (rms == 1e-7) {
      EXPECT_GT(std::fabs(in_band - s.constant - 0.5), 1e-2);  // control: constant part forgotten
    }
  }
}

// The lines of the transform are fine enough: ground motion that is strong at its lowest frequencies gives the same
// spectrum when the band, and with it the resolution, is changed. Tolerance 1 %, in bins of 4 %.
TEST(UpConversion, ResolutionDoesNotMatter) {
  MotionSet const motion = moving({power_law_asd(1e-6, 1, -2, 0.05, 1000)});
  PhaseSpectra const usual(group_by_shape(motion), FrequencyGrid{{3, 3.12, 10, 10.4, 30, 31.2, 100, 104}});
  PhaseSpectra const fine(group_by_shape(motion), FrequencyGrid{{3, 3.016, 3.12, 10, 10.4, 30, 31.2, 100, 104}});
  ASSERT_LT(fine.resolution(), 0.25 * usual.resolution());
  std::vector<double> const kappa = {two_k * two_k};
  std::vector<double> const a = usual(kappa).psd, b = fine(kappa).psd;
  EXPECT_LT(deviation(a[0], (b[0] * 0.016 + b[1] * 0.104) / 0.12), 0.01);
  for (std::size_t i = 1; i < a.size(); ++i) EXPECT_LT(deviation(a[i], b[i + 1]), 0.01) << i;
  EXPECT_GT(deviation(a[2], b[1]), 0.01);  // control: another bin
}

}  // namespace
}  // namespace straytrace::testing
