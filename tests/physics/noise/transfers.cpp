// SPDX-License-Identifier: BSD-3-Clause
// One drive that reaches bodies through transfer functions (docs/theory/spectra.md, eq. 1.10, 7.12, 11.2): the phase
// has the PSD |sum of phase sensitivity times transfer function|^2 times that of the drive.
#include "base/math/rng.hpp"
#include "noise/classes/motion_classes.hpp"
#include "physics/noise/support.hpp"
#include "spectra/welch.hpp"

namespace straytrace::testing::noise_transfers {
namespace {

using Response = TransferFunction::Response;
using Shared = std::shared_ptr<TransferFunction const>;

Shared oscillator(double hz, double quality, Response damping) {
  return std::make_shared<TransferFunction const>(TransferFunction::oscillator(hz, quality, damping));
}

// Bodies 0, 1, ... along z on one drive, each through its own transfer function.
MotionSet driven(Spectrum const& drive, std::vector<Shared> const& transfers) {
  MotionSet set;
  MotionInput& input = set.inputs.emplace_back();
  input.spectrum = drive;
  for (std::uint32_t b = 0; b < transfers.size(); ++b) input.gains.push_back({BodyId{b}, 2, 1, transfers[b]});
  return set;
}

std::vector<PhaseSensitivity> along_z(std::vector<double> const& values) {
  std::vector<PhaseSensitivity> phase_sensitivities;
  for (std::uint32_t b = 0; b < values.size(); ++b) phase_sensitivities.push_back(phase_sensitivity(b, 2, values[b]));
  return phase_sensitivities;
}

double psd_at(MotionSet const& set, std::vector<PhaseSensitivity> const& phase_sensitivities, double hz) {
  std::vector<MotionClass> const classes = group_by_shape(set);
  std::vector<double> const kappa = kappa_of(set, classes, phase_sensitivities);
  double sum = 0;
  for (std::size_t c = 0; c < classes.size(); ++c) sum += kappa[c] * classes[c].reference.at(hz);
  return sum;
}

double power_of(MotionSet const& set, std::vector<PhaseSensitivity> const& phase_sensitivities, double low,
                double high) {
  std::vector<MotionClass> const classes = group_by_shape(set);
  std::vector<double> const kappa = kappa_of(set, classes, phase_sensitivities);
  double sum = 0;
  for (std::size_t c = 0; c < classes.size(); ++c) sum += kappa[c] * classes[c].reference.power(low, high);
  return sum;
}

// The sum over classes is the square of the sum of amplitudes, at all frequencies. Tolerance: knots, 1e-5 half way.
TEST(MotionThroughTransfers, ClassesAddUpToTheSquareOfTheSum) {
  Spectrum const drive = power_law_asd(1e-7, 1, -2, 0.05, 200);
  MotionSet const set = driven(drive, {nullptr, oscillator(0.6, 20, Response::inertial),
                                       oscillator(8, 50, Response::support), oscillator(21, 3, Response::support)});
  for (std::vector<double> const& a : {std::vector<double>{1, 0, 0, 0},
                                       {1, -1, 0, 0},
                                       {0.3, 2, -1, 0},
                                       {1, 1, 1, 1},
                                       {-2, 0.5, 0, 0.1},
                                       {0, 1, 0, -1}})
    for (double f : {0.07, 0.3, 0.59, 0.61, 1.3, 5.0, 7.9, 8.0, 8.1, 30.0, 150.0}) {
      std::vector<PhaseSensitivity> const phase_sensitivities = along_z(a);
      double const exact = set.sensitivity(0, phase_sensitivities, f) * drive.at(f);
      EXPECT_LT(deviation(psd_at(set, phase_sensitivities, f), exact), 3e-5) << f;
    }
}

// A bench hangs on the ground, and light goes between the two: below the resonance only f^2/f_0^2 of the motion is
// left.
TEST(MotionThroughTransfers, SuspendedBenchAgainstTheGround) {
  double const f0 = 0.6, q = 20;
  Spectrum const ground = power_law_asd(1e-7, 1, -2, 0.001, 100);
  MotionSet const set = driven(ground, {nullptr, oscillator(f0, q, Response::inertial)});
  std::vector<PhaseSensitivity> const between = along_z({-two_k, two_k});
  for (double f : {0.001, 0.003, 0.01, 0.1}) {  // H - 1 = (x^2 + i x/Q)/(1 - x^2 - i x/Q)
    double const x = f / f0, above = x * x * x * x + x * x / (q * q), below = std::pow(1 - x * x, 2) + x * x / (q * q);
    EXPECT_LT(deviation(psd_at(set, between, f), two_k * two_k * above / below * ground.at(f)), 1e-4) << f;
  }
  // At 50 Hz the bench is at rest and only the ground moves.
  EXPECT_LT(deviation(psd_at(set, between, 50), two_k * two_k * ground.at(50)), 1e-3);
  // Control: two independent bodies.
  double const apart = psd_at(set, along_z({-two_k, 0}), 0.01) + psd_at(set, along_z({0, two_k}), 0.01);
  EXPECT_GT(apart, 100 * psd_at(set, between, 0.01));
}

TEST(MotionThroughTransfers, CommonMotionCancels) {
  Spectrum const ground = power_law_asd(1e-6, 1, -2, 0.01, 100);
  Shared const table = oscillator(8, 100, Response::support);
  MotionSet const set = driven(ground, {table, table, nullptr});
  EXPECT_EQ(power_of(set, along_z({two_k, -two_k, 0}), 0.01, 100), 0);
  // Through two benches that differ by 1e-6 in stiffness: the difference of the two is small and known.
  MotionSet const pair = driven(ground, {table, oscillator(8 * (1 - 1e-6), 100, Response::support)});
  double const left = psd_at(pair, along_z({two_k, -two_k}), 8), x = 1e-6 * 100 * 2;
  EXPECT_LT(deviation(left / psd_at(pair, along_z({two_k, 0}), 8), x * x), 1e-3);
}

// Transfer functions of unlike origin agree on the sign of their phases: a resonance by formula and as a table, whose
// phases in a file are for exp(+2 pi i f t), hang on one ground.
TEST(MotionThroughTransfers, TableAndFormulaAgree) {
  TransferFunction const formula = TransferFunction::oscillator(8, 5, Response::support);
  std::vector<double> hz;
  std::vector<std::complex<double>> values;
  for (double f = 0.01; f < 200; f *= 1.01) {
    hz.push_back(f);
    values.push_back(formula(f));
  }
  Spectrum const ground = power_law_asd(1e-6, 1, -2, 0.02, 100);
  MotionSet const set = driven(ground, {std::make_shared<TransferFunction const>(formula),
                                        std::make_shared<TransferFunction const>("table", hz, values)});
  double const alone = power_of(set, along_z({1, 0}), 5, 12);
  EXPECT_LT(power_of(set, along_z({1, -1}), 5, 12), 1e-6 * alone);
  for (auto& v : values) v = std::conj(v);  // negative control
  MotionSet const turned = driven(ground, {std::make_shared<TransferFunction const>(formula),
                                           std::make_shared<TransferFunction const>("table", hz, values)});
  EXPECT_GT(power_of(turned, along_z({1, -1}), 5, 12), alone);
}

// --- against time series --------------------------------------------------------------------------------------------

// Motion of a mass on a spring, integrated sample by sample (trapezium rule, resonance prewarped).
std::vector<double> integrated(std::vector<double> const& support, double rate, double hz, double q, Response damping) {
  double const w = 2 * rate * std::tan(pi * hz / rate), drag = w / q;
  double const s = 2 * rate, a0 = s * s + drag * s + w * w, a1 = 2 * (w * w - s * s), a2 = s * s - drag * s + w * w;
  double const d = damping == Response::support ? drag * s : 0, b0 = w * w + d, b1 = 2 * w * w, b2 = w * w - d;
  std::vector<double> x(support.size());
  for (std::size_t i = 2; i < x.size(); ++i)
    x[i] = (b0 * support[i] + b1 * support[i - 1] + b2 * support[i - 2] - a1 * x[i - 1] - a2 * x[i - 2]) / a0;
  return x;
}

TEST(MotionThroughTransfers, AgreesWithTimeSeriesOfTwoFilteredCopies) {  // Welch, 5 standard errors
  constexpr double rate = 256;
  Rng rng(20260, 1, 0, Stream::source);
  std::vector<double> drive(std::size_t{1} << 19);
  for (double& x : drive) x = std::sqrt(-2 * std::log(rng.uniform())) * std::cos(2 * pi * rng.uniform());
  std::vector<double> const bench = integrated(drive, rate, 1.2, 5, Response::inertial),
                            baffle = integrated(drive, rate, 4, 8, Response::support);
  std::vector<double> phase(drive.size());
  for (std::size_t i = 0; i < phase.size(); ++i) phase[i] = 1.5 * bench[i] - baffle[i];
  WelchSpectrum const measured = welch(phase, rate, {8192, 0.5, Window::hann, true});

  Spectrum const white({0.1, rate / 2}, {2 / rate, 2 / rate});
  MotionSet const set = driven(white, {oscillator(1.2, 5, Response::inertial), oscillator(4, 8, Response::support)});
  std::vector<PhaseSensitivity> const phase_sensitivities = along_z({1.5, -1}), bench_alone = along_z({1.5, 0}),
                                      baffle_alone = along_z({0, -1});
  int rejected = 0;
  for (double centre : {0.5, 0.9, 1.5, 2.5, 3.2, 5.0, 8.0}) {  // off the peaks, which the window would widen
    double sum = 0, variance = 0, expected = 0, forgotten = 0;
    for (std::size_t k = 0; k < measured.hz.size(); ++k) {
      double const f = measured.hz[k];
      if (std::fabs(f - centre) > 0.02 * centre) continue;
      sum += measured.psd[k];
      variance += 3 * std::pow(measured.sigma[k], 2);  // neighbours within the window are not independent
      expected += psd_at(set, phase_sensitivities, f);
      forgotten += psd_at(set, bench_alone, f) + psd_at(set, baffle_alone, f);
    }
    ASSERT_GT(sum, 0);
    EXPECT_NEAR(sum, expected, 5 * std::sqrt(variance)) << centre << " Hz";
    rejected += std::fabs(sum - forgotten) > 5 * std::sqrt(variance);
  }
  EXPECT_GE(rejected, 2);  // control: the correlation forgotten
}

// Strong motion: up-conversion of light between a bench and the ground it hangs on sees the relative motion.
TEST(MotionThroughTransfers, FringesOfASuspendedBench) {
  Spectrum const swell = gaussian_line(0.15, 0.01, 3e-6);
  MotionSet const set = driven(swell, {nullptr, oscillator(0.6, 20, Response::inertial)});
  MotionSet alone;  // the relative motion by hand, as one body
  alone.inputs.push_back({"relative",
                          filtered(swell,
                                   [&](double f) {
                                     double const x = f / 0.6, q = 20;
                                     return (std::pow(x, 4) + x * x / (q * q)) /
                                            (std::pow(1 - x * x, 2) + x * x / (q * q));
                                   },
                                   {}),
                          0,
                          {{BodyId{0}, 2, 1}}});
  FrequencyGrid const grid{{0.3, 0.4, 1, 1.1, 2, 2.2}};
  PhaseSpectra const spectra(group_by_shape(set), grid), by_hand(group_by_shape(alone), grid);
  std::vector<double> const got = spectra(kappa_of(set, spectra.classes(), along_z({-two_k, two_k}))).psd,
                            expected = by_hand(kappa_of(alone, by_hand.classes(), along_z({two_k}))).psd;
  for (std::size_t i : {0u, 2u, 4u}) EXPECT_LT(deviation(got[i], expected[i]), 1e-4);
}

}  // namespace
}  // namespace straytrace::testing::noise_transfers
