// SPDX-License-Identifier: BSD-3-Clause
// A quiet body under strong slow motion: the transform alone would show its own rounding (docs/theory/spectra.md,
// eq. 7.14).
#include "noise/wrapped/phase_spectra.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing {
namespace {

Spectrum const slow = gaussian_line(0.2, 0.05, 2e-6);
Spectrum const quiet = power_law_asd(1e-16, 100, -3, 20, 1000);  // suspended: 1e-16 m/sqrt(Hz) at 100 Hz

// Half the mean of S_H over the Gaussian spread of the fringe frequency (eq. 7.8), one-sided S_H, direct sum.
double expected(double f) {
  double const sigma = 2 * std::sqrt(slow.rate_power(infinity)) / wavelength;
  double sum = 0, norm = 0;
  for (double g = -8 * sigma; g <= 8 * sigma; g += sigma / 200) {
    double const w = std::exp(-g * g / (2 * sigma * sigma));
    sum += w * quiet.at(std::fabs(f + g));
    norm += w;
  }
  return two_k * two_k * sum / norm / 2;
}

TEST(DynamicRange, QuietBodyUnderStrongSlowMotion) {  // tolerance 1e-3, at levels down to 1e-24 1/Hz
  std::vector<double> const edges = {99.5, 100.5, 399, 401, 799, 801};
  for (MotionSet const& motion : {moving({slow + quiet}), [] {
                                    MotionSet two = moving({slow, quiet});
                                    two.inputs[1].gains[0].body = BodyId{0};
                                    return two;
                                  }()}) {
    std::vector<double> const psd = fringe_psd(motion, edges);
    EXPECT_LT(psd[0], 1e-17);
    EXPECT_LT(deviation(psd[0], expected(100)), 1e-3);
    EXPECT_LT(deviation(psd[2], expected(400)), 1e-3);
    EXPECT_LT(deviation(psd[4], expected(800)), 1e-3);
  }
  // Control: one transform of everything loses the quiet motion altogether.
  MotionClass const whole{slow + quiet, 0, {}};
  double const kappa = two_k * two_k;
  SlowPhase const all{1000, std::sqrt(kappa * whole.reference.rate_power(infinity)) / (2 * pi), {}};
  auto const covariance = [&](LagGrid const& lags) {
    return ClassCovariances().sum({&whole, 1}, {&kappa, 1}, 1000, lags);
  };
  WrappedSpectrum const plain = transform(all, covariance, 0.01);
  auto const k = static_cast<std::size_t>(std::lround(100 / plain.spacing));
  double const at_100 = k < plain.density.size() ? plain.density[k] : 0;  // it may end before
  EXPECT_GT(deviation(at_100, expected(100)), 0.5);
}

// Motion by 8 mm, R(0) = 1e10: a Gaussian of the fringe frequencies (eq. 7.8), and all of the power. Control: R(0) and
// R(tau) as two numbers, whose difference lost its digits.
TEST(DynamicRange, VeryStrongSlowMotion) {
  double const kappa = 1e10 / slow.total();
  MotionClass const swing{slow, 0, {}};
  SlowPhase const phase{1, std::sqrt(kappa * slow.rate_power(infinity)) / (2 * pi), {}};
  ClassCovariances covariances;
  auto const exact = [&](LagGrid const& lags) { return covariances.sum({&swing, 1}, {&kappa, 1}, 1, lags); };
  WrappedSpectrum const low = transform(phase, exact, 0.01);
  EXPECT_LT(std::fabs(total(low) - 0.5), 1e-9);
  double const sigma = phase.fringe_rate;
  for (double const x : {0.5, 1.0, 2.0}) {
    double const density = low.density[std::size_t(x * sigma / low.spacing + 0.5)];
    EXPECT_LT(deviation(density, std::exp(-x * x / 2) / (std::sqrt(2 * pi) * sigma)), 1e-2)
        << x;  // lines 0.04 Hz apart
  }
  auto const rounded = [&](LagGrid const& lags) {
    Covariance r = exact(lags);
    r.fall.clear();
    return r;
  };
  EXPECT_GT(std::fabs(total(transform(phase, rounded, 0.01)) - 0.5), 1e-7);
}

// The rounding of a slow line returns at the other end of a long grid, as its mirror image. It is no fast fringe.
TEST(DynamicRange, MirrorImageOfASlowLineIsRounding) {
  LagGrid const lags{0.01, std::size_t{1} << 22};
  double const peak = 0.2;  // rad^2
  std::vector<double> c(lags.size());
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = peak * std::cos(2 * pi * lags.turns(0.5, i));
  double norm2 = 0;  // over a whole period, as transform() takes it
  for (double const x : c) norm2 += 2 * x * x;
  double const rounding = 64 * std::sqrt(norm2);
  WrappedSpectrum low;
  EXPECT_TRUE(transform_lags(c, lags, rounding, low));
  EXPECT_LE(low.density.size(), 3 * lags.size() / 4);
  EXPECT_LT(deviation(low.density[50] * lags.spacing, peak / 2), 1e-12);
  // Control: a weak line that is there.
  for (std::size_t i = 0; i < c.size(); ++i) c[i] += 1e-15 * std::cos(2 * pi * lags.turns(0.01 * 2090000, i));
  EXPECT_FALSE(transform_lags(c, lags, rounding, low));
}

TEST(DynamicRange, WeakLineUnderStrongSlowMotion) {  // a calibration line is spread as the fringes are; tolerance 2e-3
  MotionSet motion = moving({slow});
  double const z = 1e-7, sigma = 2 * std::sqrt(slow.rate_power(infinity)) / wavelength;
  motion.inputs.push_back(tone(100, z / two_k));
  std::vector<double> const psd = fringe_psd(motion, {99.9, 100.1, 104.9, 105.1});
  double const peak = z * z / 4 / (std::sqrt(2 * pi) * sigma);
  EXPECT_LT(deviation(psd[0], peak), 2e-3);
  EXPECT_LT(deviation(psd[2], peak * std::exp(-25 / (2 * sigma * sigma))), 2e-3);
  EXPECT_GT(deviation(psd[0], z * z / 4 / 0.2), 0.5);  // control: an unspread line
}

}  // namespace
}  // namespace straytrace::testing
