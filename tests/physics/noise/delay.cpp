// SPDX-License-Identifier: BSD-3-Clause
// Delay of each body (docs/theory/time_domain.md, eq. N.29, N.30): bodies that move alike interfere.
#include "noise/classes/delayed_paths.hpp"
#include "physics/noise/time_domain/time_support.hpp"

namespace straytrace::testing::noise_delay {
namespace {

struct Hit {
  std::uint32_t body;
  double phase_sensitivity, metres;  // over 2k; of light from there to where it rejoins
};

PathRecord path(double length, std::vector<Hit> const& hits) {
  std::vector<PhaseSensitivity> all;
  for (Hit const& h : hits) {
    if (all.empty() || all.back().body.value != h.body) all.push_back({BodyId{h.body}});
    all.back().d[2] += two_k * h.phase_sensitivity;
    all.back().moment[2] += two_k * h.phase_sensitivity * h.metres / speed_of_light;
  }
  PathRecord r = record(0, 1, all);
  r.path_length = length;
  return r;
}

// One input moves both bodies along z, by 1e-18 m/sqrt(Hz) or 1e-15 m: to first order.
MotionSet alike(bool tone_only, double hz) {
  MotionSet set;
  set.bodies = {"mirror", "baffle"};
  std::vector<Gain> const gains{{BodyId{0}, 2, 1}, {BodyId{1}, 2, 1}};
  if (tone_only)
    set.inputs.push_back({"tone", {}, hz, {{BodyId{0}, 2, 1e-15}, {BodyId{1}, 2, 1e-15}}});
  else
    set.inputs.push_back({"ground", Spectrum({1, 2e4}, {1e-36, 1e-36}), 0, gains});
  return set;
}

double asd(PathRecord const& r, MotionSet const& motion, double hz, double band_high, bool delay) {
  NoiseSettings s = on({1, hz * (1 - 1e-4), hz * (1 + 1e-4), band_high});
  s.delay = delay;
  return project_noise(known_table({known_class(1, 1, {r})}), motion, UnitDetector(), s).total.asd[1];
}

// N.30: mirror -> baffle at l -> mirror, of -2k on the mirror after 2 l and 2k on the baffle after l.
PathRecord out_and_back(double l) { return path(2 * l, {{0, -1, 2 * l}, {1, 1, l}}); }

// 2 sin(pi f l/c), of one lever.
TEST(Delay, MirrorAndBaffleThatMoveAlikeT27) {
  PathRecord const both = out_and_back(1500), lever = path(3000, {{1, 1, 1500}});
  double const expected = 0.0314364;
  EXPECT_NEAR(2 * std::sin(pi * 1000 * 1500 / speed_of_light), expected, 1e-5 * expected);
  for (bool const tone_only : {true, false}) {
    MotionSet const motion = alike(tone_only, 1000);
    double const one = asd(lever, motion, 1000, 2000, true);
    EXPECT_NEAR(asd(both, motion, 1000, 2000, true) / one, expected, 1e-5 * expected) << tone_only;
    EXPECT_NEAR(one / asd(lever, motion, 1000, 2000, false), 1, 1e-6) << "a delay alone makes no noise";
    EXPECT_EQ(asd(both, motion, 1000, 2000, false), 0) << "negative control: frozen";
  }
}

// Two hits 6 km of path apart, at 10 kHz: |cos(omega tau/2)|.
TEST(Delay, TwoHitsFarApartT27) {
  PathRecord const two = path(6000, {{0, 0.5, 6000}, {1, 0.5, 0}}), lever = path(6000, {{1, 1, 0}});
  double const expected = 0.808761;
  for (bool const tone_only : {true, false}) {
    MotionSet const motion = alike(tone_only, 1e4);
    double const one = asd(lever, motion, 1e4, 1.1e4, true);
    EXPECT_NEAR(asd(two, motion, 1e4, 1.1e4, true) / one, expected, 1e-5 * expected) << tone_only;
    EXPECT_NEAR(asd(two, motion, 1e4, 1.1e4, false) / one, 1, 1e-6) << "negative control: frozen";
  }
}

// Both hits on one body act after their mean delay, without the factor cos(omega tau/2): it differs from 1 by less than
// (omega tau)^2/8.
TEST(Delay, HitsOnOneBodyActTogether) {
  MotionSet const motion = alike(true, 1e4);
  PathRecord const one = path(6000, {{0, 0.5, 6000}, {0, 0.5, 0}}), lever = path(6000, {{0, 1, 0}});
  double const ratio = asd(one, motion, 1e4, 1.1e4, true) / asd(lever, motion, 1e4, 1.1e4, true);
  double const omega_tau = 2 * pi * 1e4 * 6000 / speed_of_light;
  EXPECT_NEAR(ratio, 1, 1e-6);
  EXPECT_LT(1 - std::cos(omega_tau / 2), omega_tau * omega_tau / 8);
  EXPECT_NEAR(1 - std::cos(omega_tau / 2), 1 - 0.808761, 1e-6);
}

// Light meets a body twice from opposite sides, 3 km apart: the levers cancel and the moment does not. To first order
// in the delay, omega tau. Control: frozen.
TEST(Delay, OppositeHitsOnOneBody) {
  MotionSet const motion = alike(true, 100);
  PathRecord const opposite = path(6000, {{0, 1, 4000}, {0, -1, 1000}}), lever = path(6000, {{0, 1, 0}});
  double const omega_tau = 2 * pi * 100 * 3000 / speed_of_light, one = asd(lever, motion, 100, 200, true);
  EXPECT_NEAR(asd(opposite, motion, 100, 200, true) / one / omega_tau, 1, omega_tau * omega_tau);
  EXPECT_EQ(asd(opposite, motion, 100, 200, false), 0);
}

// What is neglected without delays is stated where it matters, as the ratio of both budgets.
TEST(Delay, EffectIsTheRatioOfBothBudgets) {
  MotionSet motion = alike(false, 1000);
  motion.inputs[0].gains[1].value = 1.1;  // not quite alike
  CouplingTable const table = known_table({known_class(1, 1, {out_and_back(1500)})});
  NoiseSettings s = on(logarithmic_grid(10, 1000, 20).edges);
  NoiseBudget const frozen = project_noise(table, motion, UnitDetector(), s);
  s.delay = true;
  NoiseBudget const late = project_noise(table, motion, UnitDetector(), s);
  DelayEffect const e = delay_effect(table, motion, UnitDetector(), frozen);
  std::size_t const bin = s.grid.bin_of(e.hz);
  EXPECT_TRUE(e.matters());
  EXPECT_NEAR(late.total.asd[bin] / frozen.total.asd[bin], e.factor, 1e-3 * e.factor);
  EXPECT_GT(e.factor, 1.04);
  EXPECT_FALSE(
      delay_effect(known_table({known_class(1, 1, {path(3000, {{1, 1, 1500}})})}), motion, UnitDetector(), frozen)
          .matters())
      << "negative control: one body";
}

// The same of a line alone.
TEST(Delay, EffectOnALine) {
  MotionSet motion = alike(true, 700);
  motion.inputs[0].gains[1].value = 1.02e-15;
  CouplingTable const table = known_table({known_class(1, 1, {out_and_back(1500)})});
  NoiseSettings s = on(logarithmic_grid(10, 1000, 20).edges);
  NoiseBudget const frozen = project_noise(table, motion, UnitDetector(), s);
  s.delay = true;
  NoiseBudget const late = project_noise(table, motion, UnitDetector(), s);
  DelayEffect const e = delay_effect(table, motion, UnitDetector(), frozen);
  std::size_t const bin = s.grid.bin_of(700);
  EXPECT_EQ(s.grid.bin_of(e.hz), bin);
  EXPECT_TRUE(e.matters());
  EXPECT_NEAR(late.total.asd[bin] / frozen.total.asd[bin], e.factor, 1e-3 * e.factor);
  EXPECT_FALSE(
      delay_effect(known_table({known_class(1, 1, {path(3000, {{1, 1, 1500}})})}), motion, UnitDetector(), frozen)
          .matters())
      << "negative control: one body";
}

TimeDomainSettings in_time(double rate, Delay delay, unsigned threads = 1) {
  TimeDomainSettings s;
  s.paths = {{0}, 0, 7, 0, {0.0}};
  s.duration = 1;
  s.rate = rate;
  s.band_low = 1;
  s.band_high = 2000;
  s.delay = delay;
  s.threads = threads;
  return s;
}

// The series of a path at static phase 0: its phase. Of a tone, the amplitude of T27; control: frozen.
TEST(Delay, SeriesOfMirrorAndBaffleThatMoveAlike) {
  CouplingTable const table = known_table({known_class(1, 1, {out_and_back(1500)})});
  MotionSet const motion = alike(true, 1000);
  auto const amplitude = [&](Delay delay) {
    StrayLight const light = stray_light(table, motion, UnitDetector(), in_time(8192, delay));
    std::complex<double> sum = 0;
    for (std::size_t i = 0; i < light.times.samples; ++i)
      sum += light.fields.at(0).field[i].imag() * std::polar(2.0, 2 * pi * 1000 * double(i) / light.times.rate);
    return std::abs(sum) / double(light.times.samples) / (two_k * 1e-15);
  };
  EXPECT_NEAR(amplitude(Delay::by_hit), 0.0314364, 1e-5 * 0.0314364);
  EXPECT_LT(amplitude(Delay::none), 1e-9);
}

// h of either quadrature, a quarter turn apart: the static phase does not scatter the power of weak motion.
class BothQuadratures final : public Interferometer {
 public:
  std::complex<double> strain_per_phase(PortId, double) const override { return 1; }
  std::complex<double> strain_per_amplitude(PortId, double) const override { return {0, 1}; }
  double copies(PortId) const override { return 1; }
  std::string description() const override { return "both quadratures"; }
};

// Series against spectra, Gaussian motion of 0.9 rad rms, both bodies on one ground.
TEST(Delay, SeriesAgreeWithSpectra) {
  MotionSet motion = alike(false, 1000);
  motion.inputs[0].spectrum = Spectrum({0.5, 5, 120}, {1e-13, 1e-15, 1e-15});
  CouplingTable const table = known_table({known_class(1, 1, {out_and_back(150e3)})});  // 1 ms: delays act at 100 Hz
  DelayedPaths const late = with_delays(table, motion, 400);
  BothQuadratures const detector;
  Simulation s{late.table, late.motion, &detector, {10.125, 40.125, 80.125, 160.125, 300.125}, 8, 1024, 4, 100};
  Comparison const c = compared(s);
  expect_agreement(c, 0.1);
  Simulation const frozen{table, motion, &detector, s.edges, 8, 1024, 4, 2};
  EXPECT_LT(compared(frozen).exact[1], 0.5 * c.exact[1]) << "negative control";
}

TEST(Delay, SameBitsForAnyNumberOfThreads) {
  CouplingTable const table = known_table({known_class(1, 1, {out_and_back(1500)})});
  MotionSet const motion = alike(false, 1000);
  auto const field = [&](unsigned threads) {
    return stray_light(table, motion, UnitDetector(), in_time(65536, Delay::by_hit, threads)).fields.at(0).field;
  };
  auto const one = field(1);
  EXPECT_EQ(one, field(2));
  EXPECT_EQ(one, field(5));
}

// Interpolation between the nodes: 1e-7 up to the highest frequency. Control: four times that frequency.
TEST(Delay, LatticeInterpolates) {
  constexpr double longest = 8e4 / speed_of_light, highest = 5000;  // s; Hz
  DelayLattice const lattice(longest, highest);
  auto const error = [&](double hz) {
    double worst = 0;
    for (double delay = 0; delay <= longest; delay += longest / 977) {
      std::complex<double> sum = -std::polar(1.0, 2 * pi * hz * delay);
      for (auto const& [node, w] : lattice.parts(1, delay)) sum += std::polar(w, 2 * pi * hz * lattice.delay(node));
      worst = std::max(worst, std::abs(sum));
    }
    return worst;
  };
  EXPECT_LT(error(highest), 2 * DelayLattice::accuracy);
  EXPECT_LT(error(100), DelayLattice::accuracy);
  EXPECT_GT(error(4 * highest), 1e-3);
  for (double const moment : {0.3 * longest, -0.2 * longest, 5 * longest}) {
    double sum = 0, first = 0;
    for (auto const& [node, w] : lattice.parts(1, moment)) {
      sum += w;
      first += w * lattice.delay(node);
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_NEAR(first, moment, 1e-12 * longest);
  }
}

// A run file from before the moments were stored.
TEST(Delay, UnknownMomentsAreRefused) {
  PathRecord old = out_and_back(1500);
  for (double& m : old.phase_sensitivities[0].moment) m = not_a_number;
  CouplingTable const table = known_table({known_class(1, 1, {old})});
  EXPECT_THROW(with_delays(table, alike(false, 1000), 1000), InputError);
  EXPECT_FALSE(delay_effect(table, alike(false, 1000), UnitDetector(),
                            project_noise(table, alike(false, 1000), UnitDetector(), on({10, 100, 1000})))
                   .matters());
}

}  // namespace
}  // namespace straytrace::testing::noise_delay
