// SPDX-License-Identifier: BSD-3-Clause
// Modulated beams: docs/theory/phase.md, eq. N.25.
#include "noise/classes/delayed_paths.hpp"
#include "noise/project/sensor_noise.hpp"
#include "noise/time_domain/time_domain.hpp"
#include "physics/noise/support.hpp"
#include "physics/noise/time_domain/time_series.hpp"

namespace straytrace::testing::modulated_light {
namespace {

double bessel(int n, double x) { return std::cyl_bessel_j(n, std::fabs(x)); }

constexpr std::uint32_t probe = 0, reader = 1;

// One path from a beam to a port; the local field is that of beam `local`. Body 0 moves it by 2k.
CouplingTable one_path(double delay, std::uint32_t source = probe) {
  PathRecord r = record(1, 1, {phase_sensitivity(0, 2, two_k)});
  r.path_length = delay * speed_of_light;
  r.beam = source;
  CouplingTable t = known_table({known_class(1, 1, {r})});
  t.bodies = {"body 0"};
  return t;
}

MotionSet with_light(std::vector<LightTone> tones, std::uint32_t local = probe) {
  MotionSet motion = moving({Spectrum()});
  motion.inputs.clear();
  motion.light.tones = std::move(tones);
  motion.light.port_beam = {local};
  return motion;
}

// Powers of Im s in bins around lines at these frequencies, Hz.
std::vector<double> lines(CouplingTable const& table, MotionSet const& motion, std::vector<double> const& hz) {
  std::vector<double> edges, out;
  for (double const f : hz) edges.insert(edges.end(), {f - 2, f + 2});
  NoiseBudget const b = project_noise(table, motion, UnitDetector(), on(edges));
  for (std::size_t i = 0; i < hz.size(); ++i) out.push_back(b.total.psd(2 * i) * b.grid.width(2 * i));
  return out;
}

// Lines J_n^2 of eq. 7.4 with the index 2m sin(pi f tau) of one beam, and m against another.
TEST(ModulatedLight, PhaseOfOneBeamHasTheIndexN25) {
  double const f = 40, m = 0.9, tau = 0.3 / f;
  MotionSet const motion = with_light({{probe, "probe", f, 0, m, 0.4}});
  double const z = 2 * m * std::sin(pi * f * tau);
  std::vector<double> const same = lines(one_path(tau), motion, {40, 80, 120});
  for (int n = 1; n <= 3; ++n) EXPECT_NEAR(same[n - 1], std::pow(bessel(n, z), 2), 1e-9) << n;
  EXPECT_GT(std::fabs(same[0] - std::pow(bessel(1, m), 2)), 0.02) << "control: the local field left out";
  for (double const none : lines(one_path(0), motion, {40, 80})) EXPECT_LT(none, 1e-20) << "no delay";
  for (double const none : lines(one_path(5 / f), motion, {40, 80})) EXPECT_LT(none, 1e-20) << "whole periods";
  std::vector<double> const other =
      lines(one_path(tau), with_light({{probe, "probe", f, 0, m, 0.4}}, reader), {40, 80});
  for (int n = 1; n <= 2; ++n) EXPECT_NEAR(other[n - 1], std::pow(bessel(n, m), 2), 1e-9) << n;
  std::vector<double> const local = lines(one_path(tau, reader), motion, {40, 80});
  for (int n = 1; n <= 2; ++n) EXPECT_NEAR(local[n - 1], std::pow(bessel(n, m), 2), 1e-9) << "of the local field";
}

// Two beams of one frequency: the phasors of their phases subtract. Control: their powers.
TEST(ModulatedLight, BeamsOfOneFrequencyAreCoherent) {
  double const f = 40, m = 0.9, tau = 0.3 / f;
  MotionSet const motion = with_light({{probe, "probe", f, 0, m, 0}, {reader, "reader", f, 0, 0.5 * m, 0}}, reader);
  double const z = std::abs(std::polar(m, -2 * pi * f * tau) - 0.5 * m);
  EXPECT_NEAR(lines(one_path(tau), motion, {40})[0], std::pow(bessel(1, z), 2), 1e-9);
  EXPECT_GT(std::fabs(z - m * std::sqrt(1.25)), 0.1);
}

// Motion of a body at the frequency of the light: one input. z sin wt of the body cancels the light's.
TEST(ModulatedLight, AddsToTheMotionOfItsFrequency) {
  double const f = 40, m = 0.9;
  MotionSet motion = with_light({{probe, "probe", f, 0, m, -pi / 2}}, reader);  // m sin wt
  motion.inputs = {tone(f, -m / two_k)};
  EXPECT_LT(lines(one_path(0), motion, {40})[0], 1e-20);
  motion.inputs = {tone(f, m / two_k)};
  EXPECT_NEAR(lines(one_path(0), motion, {40})[0], std::pow(bessel(1, 2 * m), 2), 1e-9) << "control: the other sign";
}

// Second moments of a route, which hold no light, do not hide it.
TEST(ModulatedLight, SecondMomentsLeaveItsNoise) {
  CouplingTable table = one_path(0);
  PhaseSensitivityProduct p;
  p.sum[2 * 6 + 2] = two_k * two_k / replica_count;
  for (std::uint32_t r = 0; r < replica_count; ++r) {
    p.replica = r;
    table.classes[0].phase_sensitivities.push_back(p);
  }
  EXPECT_NEAR(lines(table, with_light({{probe, "probe", 40, 0, 0.01, 0}}, reader), {40})[0], 0.25e-4, 1e-9);
}

// Factor 1 + m cos 2 pi f (t - tau): the line m^2/4 of Im s, and sidebands of m^2/4 of each line of the motion.
TEST(ModulatedLight, AmplitudeMakesSidebandsN25) {
  double const f = 40, m = 0.05, z = 1.3;
  MotionSet motion = with_light({{probe, "probe", f, m, 0, 0}});
  EXPECT_NEAR(lines(one_path(0), motion, {40})[0] / (m * m / 4), 1, 1e-6);
  EXPECT_NEAR(lines(one_path(0.2 / f), motion, {40})[0] / (m * m / 4), 1, 1e-6) << "at any delay";
  EXPECT_LT(lines(one_path(0, reader), motion, {40})[0], 1e-20) << "light of another beam";
  motion.inputs = {tone(9, z / two_k)};
  std::vector<double> const p = lines(one_path(0), motion, {9, 31, 40, 49});
  EXPECT_NEAR(p[0] / std::pow(bessel(1, z), 2), 1, 1e-6);
  for (std::size_t const i : {1u, 3u}) EXPECT_NEAR(p[i] / (m * m / 4 * std::pow(bessel(1, z), 2)), 1, 1e-3) << i;
  EXPECT_NEAR(p[2] / (m * m / 4 * std::pow(bessel(0, z), 2)), 1, 1e-3);
  EXPECT_GT(std::fabs(p[2] / (m * m / 2 * std::pow(bessel(0, z), 2)) - 1), 0.4) << "control: both sidebands in phase";
}

struct Signal {
  std::vector<std::complex<double>> field;
  double rate;
};

Signal in_time(CouplingTable table, MotionSet motion, double turns, double rate = 1024) {
  add_phase_modulation(table, motion);
  std::vector<StrayPath> paths = stray_paths(table, UnitDetector(), {{0}, 0, 1, 0});
  for (StrayPath& p : paths) p.turns = turns;
  return {stray_fields(paths, draw_motion(motion, {0, rate, std::size_t(rate)}, 1)).at(0).field, rate};
}

// The field of eq. N.25, sample by sample.
TEST(ModulatedLight, FieldInTimeN25) {
  double const f = 40, m = 0.9, a = 0.05, g = 16, tau = 0.3 / f, z = 0.7;
  MotionSet motion = with_light({{probe, "probe", f, 0, m, 0.4}, {probe, "probe", g, a, 0, 0.2}});
  motion.inputs = {tone(10, z / two_k)};
  Signal const s = in_time(one_path(tau), motion, 0.1);
  double worst = 0, late = 0;
  for (std::size_t i = 0; i < s.field.size(); ++i) {
    double const t = double(i) / s.rate, w = 2 * pi * f, v = 2 * pi * g;
    double const phase =
        0.2 * pi + z * std::sin(20 * pi * t) + m * (std::cos(w * (t - tau) + 0.4) - std::cos(w * t + 0.4));
    worst = std::max(worst, std::abs(s.field[i] - std::polar(1 + a * std::cos(v * (t - tau) + 0.2), phase)));
    late = std::max(late, std::abs(s.field[i] - std::polar(1 + a * std::cos(v * (t + tau) + 0.2), phase)));
  }
  EXPECT_LT(worst, 1e-9);
  EXPECT_GT(late, 0.01) << "control: the sign of the delay";
}

// `--retarded` delays bodies by half of the path; the delay of light is exact as it is.
TEST(ModulatedLight, IsNotDelayedTwice) {
  double const f = 40;
  CouplingTable table = one_path(0.3 / f);
  MotionSet motion = with_light({{probe, "probe", f, 0, 0.9, 0.4}});
  add_phase_modulation(table, motion);
  std::vector<StrayPath> const paths = stray_paths(table, UnitDetector(), {{0}, 0, 1, 0});
  MotionSeries const light = draw_motion(motion, {0, 1024, 1024}, 1);
  EXPECT_EQ(stray_fields(paths, light, Delay::half_path)[0].field, stray_fields(paths, light)[0].field);
  motion.inputs.push_back(tone(10, 0.1 / two_k));
  MotionSeries const both = draw_motion(motion, {0, 1024, 1024}, 1);
  EXPECT_NE(stray_fields(paths, both, Delay::half_path)[0].field, stray_fields(paths, both)[0].field) << "control";
}

// `project` against `noise`: the mean power of lines over eight static phases, which is that over all.
TEST(ModulatedLight, SeriesAgreeWithSpectra) {
  double const f = 40, m = 0.9, a = 0.05, tau = 0.3 / f, z = 1.3;
  MotionSet motion = with_light({{probe, "probe", f, 0, m, 0.4}, {probe, "probe", 103, a, 0, 0.2}});
  motion.inputs = {tone(10, z / two_k)};
  std::vector<double> const hz = {10, 30, 40, 50, 93, 113};
  std::vector<double> mean(hz.size());
  for (int k = 0; k < 8; ++k) {
    Signal const s = in_time(one_path(tau), motion, k / 8.0);
    std::vector<double> im;
    for (std::complex<double> const x : s.field) im.push_back(x.imag());
    for (std::size_t i = 0; i < hz.size(); ++i) {
      std::complex<double> sum = 0;
      for (std::size_t n = 0; n < im.size(); ++n) sum += im[n] * std::polar(1.0, -2 * pi * hz[i] * double(n) / s.rate);
      mean[i] += 2 * std::norm(sum / double(im.size())) / 8;
    }
  }
  std::vector<double> const exact = lines(one_path(tau), motion, hz);
  for (std::size_t i = 0; i < hz.size(); ++i) EXPECT_NEAR(mean[i] / exact[i], 1, 1e-3) << hz[i];
  motion.light.tones.erase(motion.light.tones.begin());
  EXPECT_GT(std::fabs(lines(one_path(tau), motion, {40})[0] / exact[2] - 1), 0.1) << "control: the phase left out";
}

// On a sensor the line of the amplitude has the relative height m of the beat itself (eq. N.22, N.25).
TEST(ModulatedLight, LineOnASensor) {
  double const f = 40, m = 0.05;
  Signal const s = in_time(one_path(0), with_light({{probe, "probe", f, m, 0, 0}}), 0.08);
  double mean = 0;
  std::complex<double> at = 0;
  for (std::size_t i = 0; i < s.field.size(); ++i) {
    double const beat = 2 * s.field[i].real();
    mean += beat / double(s.field.size());
    at += 2 * beat / double(s.field.size()) * std::polar(1.0, -2 * pi * f * double(i) / s.rate);
  }
  EXPECT_NEAR(std::abs(at) / mean / m, 1, 1e-9);
  EXPECT_GT(std::fabs(std::abs(at) / mean - 2 * m), 0.9 * m) << "control: m of the power";
}

}  // namespace
}  // namespace straytrace::testing::modulated_light
