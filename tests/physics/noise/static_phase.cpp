// SPDX-License-Identifier: BSD-3-Clause
// Static phases that are stated: docs/theory/spectra.md, eq. N.26.
#include "noise/project/static_phase.hpp"

#include "noise/time_domain/realisations.hpp"
#include "noise/time_domain/time_domain.hpp"
#include "physics/noise/support.hpp"
#include "spectra/welch.hpp"

namespace straytrace::testing {
namespace {

constexpr double z = 11.810499;  // rad, peak

// h = a Im s + b Re s.
class StatedQuadratures final : public Interferometer {
 public:
  StatedQuadratures(std::complex<double> phase, std::complex<double> amplitude)
      : phase_(phase), amplitude_(amplitude) {}
  std::complex<double> strain_per_phase(PortId, double) const override { return phase_; }
  std::complex<double> strain_per_amplitude(PortId, double) const override { return amplitude_; }
  double copies(PortId) const override { return copies_; }
  std::string description() const override { return "both quadratures"; }
  double copies_ = 1;

 private:
  std::complex<double> phase_, amplitude_;
};

CouplingTable one_path() { return known_table({known_class(1, 1, {record(0, 1, {phase_sensitivity(0, 2, two_k)})})}); }
MotionSet sine() {
  MotionSet m = moving({Spectrum()});
  m.inputs = {tone(10, z / two_k)};
  return m;
}
NoiseSettings at(double phase, std::vector<double> edges) {
  NoiseSettings s = on(std::move(edges));
  s.static_phases = {{"body 0", phase}};
  return s;
}
std::vector<double> powers(Interferometer const& ifo, NoiseSettings const& s, MotionSet const& motion) {
  NoiseBudget const b = project_noise(one_path(), motion, ifo, s);
  std::vector<double> out;
  for (std::size_t i = 0; i < b.grid.size(); ++i) out.push_back(b.total.psd(i) * b.grid.width(i));
  return out;
}

TEST(StatedPhase, LinesOfASineT26) {
  std::vector<double> const edges = {5, 15, 25, 35, 45};
  std::vector<double> const zero = powers(UnitDetector(), at(0, edges), sine()),
                            mean = powers(UnitDetector(), on(edges), sine()),
                            quarter = powers(UnitDetector(), at(pi / 2, edges), sine());
  double const expected[] = {0.107690, 0, 0.094390, 0}, in_mean[] = {0.053845, 0.001910};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(zero[std::size_t(i)], expected[i], 1e-5) << i;
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(mean[std::size_t(i)], in_mean[i], 1e-5) << "control: the mean over phi_0";
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(zero[i] + quarter[i], 2 * mean[i], 1e-5) << i;
}

// Small motion: Im s has 2 cos^2 phi_0 of the mean and Re s 2 sin^2 phi_0, in step: h = |a cos phi_0 - b sin phi_0|^2.
TEST(StatedPhase, QuadraturesAddAsFields) {
  MotionSet const motion = moving({power_law_asd(1e-12, 10, 0, 1, 100)});
  std::complex<double> const a{1, 0.5}, b{0.3, -0.8};
  for (double const phase : {0.0, 0.4, pi / 4, 2.0}) {
    double const found = powers(StatedQuadratures(a, b), at(phase, {9, 11}), motion)[0],
                 mean = powers(StatedQuadratures(a, b), on({9, 11}), motion)[0] / (std::norm(a) + std::norm(b));
    EXPECT_NEAR(found / (2 * mean * std::norm(a * std::cos(phase) - b * std::sin(phase))), 1, 1e-4) << phase;
    if (phase == 0.4) {
      EXPECT_GT(std::fabs(found / (2 * mean * std::norm(a * std::cos(phase) + b * std::sin(phase))) - 1), 0.1)
          << "control: the sign of the cross spectrum";
    }
  }
}

// However small: a sine of 1e-4 down to 1e-12 rad has 2 cos^2 phi_0 of its mean, where 1 - J_0 is below rounding.
TEST(StatedPhase, SmallSines) {
  std::vector<double> const edges = {5, 15};
  for (double const peak : {1e-4, 1e-6, 1e-9, 1e-12}) {
    MotionSet motion = sine();
    motion.inputs = {tone(10, peak / two_k)};
    double const mean = powers(UnitDetector(), on(edges), motion)[0];
    EXPECT_NEAR(mean / (peak * peak / 4), 1, 1e-5) << peak;
    EXPECT_NEAR(powers(UnitDetector(), at(0, edges), motion)[0] / mean, 2, 1e-5) << peak;
    EXPECT_LT(powers(UnitDetector(), at(pi / 2, edges), motion)[0] / mean, 1e-5) << peak;
    EXPECT_NEAR(powers(UnitDetector(), at(pi / 4, edges), motion)[0] / mean, 1, 1e-5) << "control: " << peak;
  }
}

// Strong Gaussian motion against eq. 1.11 of both terms: S'/S vanishes where fringes wrap many times.
TEST(StatedPhase, DoesNotMatterWhereFringesWrap) {
  MotionSet const strong = moving({power_law_asd(3e-7, 1, -1, 0.3, 3)}),
                  weak = moving({power_law_asd(1e-12, 1, -1, 0.3, 30)});
  std::vector<double> const edges = {2, 3};
  EXPECT_NEAR(powers(UnitDetector(), at(0.3, edges), strong)[0] / powers(UnitDetector(), on(edges), strong)[0], 1,
              1e-3);
  EXPECT_NEAR(powers(UnitDetector(), at(0, edges), weak)[0] / powers(UnitDetector(), on(edges), weak)[0], 2, 1e-3)
      << "control: small motion";
}

// A series with the same static phase has the same spectrum: lines of the sine in 8 s.
TEST(StatedPhase, SeriesAgree) {
  CouplingTable const table = one_path();
  NoiseSettings const s = at(pi / 4, {5, 15, 25, 35, 45});
  TimeDomainSettings time;
  time.paths.routes = {0};
  time.paths.phases = known_phases(table, sine(), s.static_phases, UnitDetector());
  time.duration = 8;
  time.rate = 1024;
  StrayLight const light = stray_light(table, sine(), UnitDetector(), time);
  std::vector<double> const lines = powers(UnitDetector(), s, sine());
  for (int n = 1; n <= 4; ++n) {
    std::complex<double> sum = 0;
    std::vector<std::complex<double>> const& field = light.fields[0].field;
    for (std::size_t i = 0; i < field.size(); ++i)
      sum += field[i].imag() * std::polar(1.0, -2 * pi * 10 * n * double(i) / 1024);
    EXPECT_NEAR(2 * std::norm(sum / double(field.size())), lines[std::size_t(n - 1)], 1e-6) << n;
  }
}

TEST(StatedPhase, ManyPathsByFewRepresentatives) {
  std::vector<PathRecord> records;
  for (int i = 0; i < 500; ++i)
    records.push_back(record(std::uint64_t(i), 1.0 / 500, {phase_sensitivity(0, 2, two_k * (0.5 + i / 500.0))}));
  CouplingTable const table = known_table({known_class(1, 1, records)});
  MotionSet const motion = moving({power_law_asd(3e-8, 1, -1, 0.3, 3)});
  NoiseSettings const s = at(0, {1, 2, 3, 5, 8});
  PhaseSpectra const spectra(group_by_shape(motion), s.grid);
  std::vector<std::complex<double>> const few = phase_relation(spectra, motion, table.classes[0]);
  std::vector<PhasePair> same, opposite;
  for (PathRecord const& r : records) {
    std::vector<double> const kappa = kappa_of(motion, spectra.classes(), r.phase_sensitivities);
    std::vector<double> turned = kappa;
    for (double& k : turned) k = -k;
    same.push_back({r.weight, kappa, kappa});
    opposite.push_back({r.weight, kappa, turned});
  }
  PairSpectrum const all = pair_spectrum(spectra, same), turned = pair_spectrum(spectra, opposite);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_LT(std::abs(few[i] - turned.psd[i] / all.psd[i]), 5e-3) << i;
  EXPECT_GT(std::abs(few[0]), 0.05) << "there is something to see";
}

// Positions over a quarter of the wavelength: each is the spectrum of its phase, and the mean of their PSDs that of
// random phases (eq. 1.12, 1.13).
TEST(ScannedPhase, PositionsAndTheirMean) {
  std::vector<double> const edges = {5, 15, 25, 35, 45};
  StatedQuadratures const ifo({1, 0.5}, {0.3, -0.8});
  NoiseSettings s = on(edges);
  s.scanned = ::straytrace::noise::ScannedPhase{"body 0", 5};
  NoiseBudget const b = project_noise(one_path(), sine(), ifo, s);
  ASSERT_EQ(b.positions.size(), 5u);
  EXPECT_EQ(b.scanned_body, "body 0");
  for (::straytrace::noise::PositionCurve const& p : b.positions) {
    NoiseBudget const one = project_noise(one_path(), sine(), ifo, at(p.phase, edges));
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(p.asd[i] / one.total.asd[i], 1, 1e-9) << p.phase;
  }
  auto const mean = [&](std::size_t bin, std::size_t some) {
    double sum = 0;
    for (std::size_t k = 0; k < some; ++k) sum += b.positions[k].asd[bin] * b.positions[k].asd[bin];
    return sum / double(some);
  };
  PositionBand const band = position_band(b);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(mean(i, 5) / b.total.psd(i), 1, 1e-9) << i;
    EXPECT_LE(band.low[i], b.total.asd[i]);
    EXPECT_GE(band.high[i], b.total.asd[i]);
  }
  EXPECT_GT(std::fabs(mean(0, 2) / b.total.psd(0) - 1), 0.1) << "control: two of five";
  s.static_phases = {{"body 0", 0}};
  EXPECT_THROW(project_noise(one_path(), sine(), ifo, s), InputError) << "scanned and stated";
}

// Eq. N.27: s_0 (1 + (iJ + A) q). Mean over the phase: J^2 + A^2. Stated: |a (J cos + A sin) + b (A cos - J sin)|^2.
TEST(AmplitudeLever, SmallMotionInBothQuadratures) {
  CouplingTable table = one_path();
  double const j = two_k, amplitude = 0.4 * two_k;
  table.classes[0].records[0].amplitude_levers = {phase_sensitivity(0, 2, amplitude)};
  MotionSet const motion = moving({power_law_asd(1e-12, 10, 0, 1, 100)});
  std::complex<double> const a{1, 0.5}, b{0.3, -0.8};
  StatedQuadratures const ifo(a, b);
  auto const psd = [&](CouplingTable const& t, NoiseSettings const& s) {
    return project_noise(t, motion, ifo, s).total.psd(0);
  };
  double const phase_alone = psd(one_path(), on({9, 11})), mean = psd(table, on({9, 11}));
  EXPECT_NEAR(mean / phase_alone, 1 + 0.16, 1e-6);
  double const unit = phase_alone / (std::norm(a) + std::norm(b)) * 2 / (j * j);
  for (double const phi : {0.0, 0.4, pi / 4, 2.0}) {
    double const c = std::cos(phi), s = std::sin(phi), found = psd(table, at(phi, {9, 11}));
    EXPECT_NEAR(found / (unit * std::norm(a * (j * c + amplitude * s) + b * (amplitude * c - j * s))), 1, 1e-3) << phi;
    if (phi == 0.4) {
      EXPECT_GT(std::fabs(found / (unit * std::norm(a * (j * c - amplitude * s) + b * (amplitude * c + j * s))) - 1),
                0.1)
          << "control: the sign of the lever";
    }
  }
}

// A series of the same path: the line of a tone, static phase 0.6.
TEST(AmplitudeLever, SeriesAgree) {
  CouplingTable table = one_path();
  table.classes[0].records[0].amplitude_levers = {phase_sensitivity(0, 2, 0.5 * two_k)};
  MotionSet motion = moving({Spectrum()});
  motion.inputs = {tone(10, 1e-3 / two_k)};
  TimeDomainSettings time;
  time.paths.routes = {0};
  time.paths.phases = {0.6};
  time.duration = 8;
  time.rate = 1024;
  std::vector<std::complex<double>> const field = stray_light(table, motion, UnitDetector(), time).fields[0].field;
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < field.size(); ++i)
    sum += field[i].imag() * std::polar(1.0, -2 * pi * 10 * double(i) / 1024);
  double const line = 2 * std::norm(sum / double(field.size()));
  NoiseBudget const b = project_noise(table, motion, UnitDetector(), at(0.6, {5, 15}));
  EXPECT_NEAR(line / (b.total.psd(0) * 10), 1, 1e-3);
  EXPECT_NEAR(line / (0.5e-6 * std::pow(std::cos(0.6) + 0.5 * std::sin(0.6), 2)), 1, 1e-4);
}

// What the first order leaves out is a warning with its size.
TEST(AmplitudeLever, TooMuchMotionIsAWarning) {
  CouplingTable table = one_path();
  table.classes[0].records[0].phase_sensitivities = {phase_sensitivity(0, 2, 100)};
  table.classes[0].records[0].amplitude_levers = {phase_sensitivity(0, 2, 1e4)};
  auto const warned = [&](double rms) {
    MotionSet const motion = moving({power_law_asd(rms, 10, 0, 9.5, 10.5)});
    return !project_noise(table, motion, UnitDetector(), on({9, 11})).warnings.empty();
  };
  EXPECT_TRUE(warned(1e-4));
  EXPECT_FALSE(warned(1e-6)) << "control";
}

TEST(StatedPhase, WhatCannotBeStated) {
  CouplingTable table = known_table(
      {known_class(1, 1, {record(0, 1, {phase_sensitivity(0, 2, two_k), phase_sensitivity(1, 2, two_k)})})});
  MotionSet const motion = moving({Spectrum(), Spectrum()});
  EXPECT_THROW(known_phases(table, motion, {{"body 0", 0}, {"body 1", 1}}, UnitDetector()), InputError);
  StatedQuadratures arms(1, 0);
  arms.copies_ = 2;
  EXPECT_THROW(known_phases(table, motion, {{"body 0", 0}}, arms), InputError);
  EXPECT_TRUE(known_phases(table, motion, {{"body 0", 0}}, UnitDetector())[0]);
  table.classes[0].kind = ClassKind::edge;
  EXPECT_FALSE(known_phases(table, motion, {{"body 0", 0}}, UnitDetector())[0]) << "a mean over random light";
}

}  // namespace
}  // namespace straytrace::testing
