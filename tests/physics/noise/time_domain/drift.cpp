// SPDX-License-Identifier: BSD-3-Clause
// A steady drift turns the static phase: C(tau) cos(2 pi f_d tau), f_d = |J.v|/2pi (docs/theory/spectra.md, eq. 7.1).
#include "physics/noise/support.hpp"

namespace straytrace::testing {
namespace {

MotionInput drift(double velocity) {
  MotionInput d;
  d.name = "drift";
  d.gains = {{BodyId{0}, 2, velocity}};
  d.drift = true;
  return d;
}

double const hz_per_velocity = 2 / wavelength;

TEST(Drift, UnmovedLightBecomesALine) {
  MotionSet m = moving({});
  m.inputs = {drift(20.0 / hz_per_velocity)};
  PhaseSpectrum const s = fringes(m, {10, 19.9, 20.1, 30});
  EXPECT_NEAR(s.psd[1] * 0.2, 0.5, 1e-12);
  EXPECT_EQ(s.psd[0], 0);
  EXPECT_EQ(s.psd[2], 0);
  EXPECT_EQ(s.constant, 0);
  EXPECT_NEAR(s.total, 0.5, 1e-12);
}

TEST(Drift, ShiftsTheFringesBothWays) {  // of slow strong motion: half of eq. 7.8 about f_d, half about -f_d; 1e-3
  Spectrum const slow = gaussian_line(0.2, 0.05, 2e-6);
  double const sigma = 2 * std::sqrt(slow.rate_power(infinity)) / wavelength, f_d = 8;
  MotionSet m = moving({slow});
  m.inputs.push_back(drift(-f_d / hz_per_velocity));
  std::vector<double> const psd = fringe_psd(m, {3.99, 4.01, 7.99, 8.01, 14.99, 15.01});
  auto const bell = [&](double f) { return std::exp(-f * f / (2 * sigma * sigma)) / (std::sqrt(2 * pi) * sigma); };
  for (auto [bin, f] : {std::pair{0, 4.0}, {2, 8.0}, {4, 15.0}}) {
    EXPECT_LT(deviation(psd[bin], (bell(f - f_d) + bell(f + f_d)) / 2), 2e-3) << f;
    EXPECT_GT(deviation(psd[bin], bell(f - f_d)), 0.01);  // control: one side alone
  }
}

TEST(Drift, CarriesWeakMotionWithIt) {  // sidebands of a line at f_d: z^2/4 shared by f_d - f and f_d + f
  MotionSet m = moving({});
  double const z = 1e-3;
  m.inputs = {drift(20.0 / hz_per_velocity), tone(5, z / two_k)};
  PhaseSpectrum const s = fringes(m, {14.9, 15.1, 19.9, 20.1, 24.9, 25.1});
  EXPECT_LT(deviation(s.psd[0] * 0.2, z * z / 8), 1e-5);
  EXPECT_LT(deviation(s.psd[4] * 0.2, z * z / 8), 1e-5);
  EXPECT_NEAR(s.psd[2] * 0.2, 0.5, 1e-6);
}

// Motion at 30 Hz, strong enough to stay in the exponent, under a drift of 10 Hz: its first order is at 20 and 40
// Hz, half each of e^-R I_1(R) (eq. 7.7 for a narrow line); at 30 Hz there is nothing of it, and at 50 and 70 Hz the
// second.
TEST(Drift, MovesTheShareOfFirstOrder) {
  double const z2 = 0.05;  // rad^2
  MotionSet m = moving({gaussian_line(30, 0.05, std::sqrt(z2) / two_k)});
  std::vector<double> const edges = {19, 21, 29, 31, 39, 41, 49, 51};
  PhaseSpectrum const still = fringes(m, edges);
  m.inputs.push_back(drift(10 / hz_per_velocity));
  PhaseSpectrum const s = fringes(m, edges);
  double const first = std::exp(-z2) * std::cyl_bessel_i(1, z2);
  for (std::size_t const bin : {0u, 4u}) {
    EXPECT_NEAR(s.psd[bin] * 2 / (first / 2), 1, 2e-3);
    EXPECT_NEAR(s.linear[bin] / s.psd[bin], 1, 1e-3);
    EXPECT_LT(still.linear[bin], 1e-3 * s.linear[bin]) << "control: without the drift";
  }
  EXPECT_LT(s.linear[2], 1e-6 * s.linear[0]);
  EXPECT_GT(still.linear[2], s.linear[0]) << "control: first order left where it was";
  EXPECT_GT(s.psd[6], 0);
  EXPECT_LT(s.linear[6], 1e-3 * s.psd[6]);
}

// Paths whose phase sensitivities differ share lines between neighbouring nodes: power and mean frequency stay.
TEST(Drift, PathsOfDifferentPhaseSensitivitiesKeepTheirPower) {
  MotionSet m = moving({});
  m.inputs = {drift(20.0 / hz_per_velocity)};
  std::vector<PathRecord> records;
  double mean = 0;
  for (int i = 0; i < 500; ++i) {
    double const phase_sensitivity_i = two_k * (1 + 0.0005 * i);
    records.push_back(record(std::uint64_t(i) * 4096, 1, {phase_sensitivity(0, 2, phase_sensitivity_i)}));
    mean += 20 * phase_sensitivity_i / two_k / 500;
  }
  CouplingTable const table = known_table({known_class(1, 1, records)});
  NoiseSettings const settings = on(logarithmic_grid(15, 30, 400).edges);
  NoiseTrace const t = project_noise(table, m, UnitDetector(), settings).total;
  double power = 0, moment = 0;
  for (std::size_t i = 0; i < t.asd.size(); ++i) {
    double const p = t.asd[i] * t.asd[i] * settings.grid.width(i);
    power += p;
    moment += p * settings.grid.centre(i);
    EXPECT_LT(std::isnan(t.linear_share[i]) ? 0 : t.linear_share[i], 1e-12);
  }
  EXPECT_NEAR(power, 0.5, 1e-9);
  EXPECT_LT(deviation(moment / power, mean), 1e-3);
}

}  // namespace
}  // namespace straytrace::testing
