// SPDX-License-Identifier: BSD-3-Clause
// Sampling rule, lines and arches of single paths in time (R2.38, R4.04, R4.07, R4.10; cases E.2b, E.2c, A2).
#include <boost/math/special_functions/bessel.hpp>

#include "physics/noise/time_domain/time_support.hpp"

namespace straytrace::testing {
namespace {

// One path that sees the motion of body 0 along z through a phase sensitivity [rad/m], with no static phase.
struct OnePath {
  std::vector<PhaseSensitivity> phase_sensitivities;
  std::vector<StrayPath> paths;
  explicit OnePath(double value) : phase_sensitivities{phase_sensitivity(0, 2, value)} {
    paths.push_back({PortId{0}, 1, 0, 0, phase_sensitivities, 0, 0});
  }
};

constexpr double e2b_phase_sensitivity = two_k / 2,
                 e2b_peak = e2b_phase_sensitivity * 21e-6;  // 21 um of path at 10 Hz: 124.0102 rad

CouplingTable e2b() {
  return known_table({known_class(1, 1, {record(17, 1, {phase_sensitivity(0, 2, e2b_phase_sensitivity)})})});
}
MotionSet e2b_motion() {
  MotionSet m = moving({Spectrum()});
  m.inputs = {tone(10, 21e-6)};
  return m;
}

TEST(SamplingRule, AnAliasingRateIsAnErrorThatNamesPathAndRate) {  // E.2b, R4.10, eq. 7.13
  TimeDomainSettings s;
  s.paths.routes = {0};
  s.duration = 2;
  s.rate = 256;
  try {
    stray_light(e2b(), e2b_motion(), UnitDetector(), s);
    FAIL() << "E.2b at 256 Hz went through";
  } catch (InputError const& e) {
    std::string const what = e.what();
    EXPECT_NE(what.find("1240.1 Hz"), what.npos) << what;
    EXPECT_NE(what.find("history 17"), what.npos) << what;
    EXPECT_NE(what.find("write a rate of 8192 Hz"), what.npos) << what;
  }
  s.rate = 0;
  StrayLight const light = stray_light(e2b(), e2b_motion(), UnitDetector(), s);
  EXPECT_NEAR(light.fastest.hz, 1240.10, 0.01);
  EXPECT_EQ(light.times.rate, 8192);
  s.rate = 8192;
  EXPECT_NO_THROW(stray_light(e2b(), e2b_motion(), UnitDetector(), s));
  s.rate = 2480;  // twice the fringe frequency, no margin
  EXPECT_THROW(stray_light(e2b(), e2b_motion(), UnitDetector(), s), InputError);
}

TEST(SamplingRule, MotionAboveHalfTheRateIsAnError) {
  MotionSet const motion = moving({power_law_asd(1e-12, 10, -2, 1, 1000)});
  EXPECT_THROW(draw_motion(motion, {0, 1024, 1024}, 1), InputError);
  EXPECT_NO_THROW(draw_motion(motion, {0, 4096, 4096}, 1));
}

// Amplitude of sin(2 pi f t) in x, which holds whole periods.
double line(std::vector<double> const& x, double rate, double hz) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] * std::sin(2 * pi * hz * double(i) / rate);
  return 2 * sum / double(x.size());
}

std::vector<double> phase_quadrature(OnePath const& path, MotionSeries const& m) {
  std::vector<PortField> const fields = stray_fields(path.paths, m);
  std::vector<double> out;
  for (std::complex<double> const s : fields[0].field) out.push_back(s.imag());
  return out;
}

TEST(FringesInTime, LinesOfTheVibratingMirror) {  // E.2b, eq. 7.3
  MotionSeries const m = draw_motion(e2b_motion(), {0, 8192, 16384}, 1);
  std::vector<double> const y = phase_quadrature(OnePath(e2b_phase_sensitivity), m);
  struct {
    double hz, amplitude;
  } const expected[] = {{10, -0.09294}, {30, 0.09643}, {50, -0.10309}, {110, 0.13329}};
  for (auto const& [hz, amplitude] : expected) EXPECT_NEAR(line(y, 8192, hz), amplitude, 6e-6) << hz;
  for (int n = 1; n <= 141; n += 2)
    EXPECT_NEAR(line(y, 8192, 10 * n), 2 * boost::math::cyl_bessel_j(n, e2b_peak), 1e-9) << n;
  double variance = 0;
  for (double x : y) variance += x * x / double(y.size());
  EXPECT_NEAR(variance, 0.514709, 1e-6);
  // Control: 256 samples per second fold 1240 Hz back; the lines are then others.
  MotionSeries const slow = draw_motion(e2b_motion(), {0, 256, 512}, 1);
  EXPECT_GT(std::fabs(line(phase_quadrature(OnePath(e2b_phase_sensitivity), slow), 256, 30) - 0.09643), 0.01);
}

TEST(FringesInTime, LinesOfTheSmallMotion) {  // E.2b, small case: z = 0.885787
  MotionSet motion = moving({Spectrum()});
  motion.inputs = {tone(10, 0.075e-6)};
  std::vector<double> const y = phase_quadrature(OnePath(two_k), draw_motion(motion, {0, 1024, 2048}, 1));
  EXPECT_NEAR(line(y, 1024, 10), 0.801706, 1e-6);
  EXPECT_NEAR(line(y, 1024, 30), 0.027566, 1e-6);
  EXPECT_NEAR(line(y, 1024, 50), 2.749e-4, 1e-7);
}

TEST(FringesInTime, SourceTonesOnAStillMirror) {  // E.2b: phases put on the light itself, rad
  struct Tone {
    double hz, amplitude, phase;
  };
  Tone const tones[] = {{40, 0.051, 3}, {110, 0.1, 0.78}, {120, 0.01, 2.6}};
  MotionSet motion = moving({Spectrum()});
  motion.inputs.clear();
  for (Tone const& t : tones)
    motion.inputs.push_back({"", {}, t.hz, {{BodyId{0}, 2, std::polar(t.amplitude / e2b_phase_sensitivity, t.phase)}}});
  std::vector<double> const y =
      phase_quadrature(OnePath(e2b_phase_sensitivity), draw_motion(motion, {0, 1024, 2048}, 1));
  for (Tone const& t : tones) {
    std::complex<double> sum = 0;
    for (std::size_t i = 0; i < y.size(); ++i) sum += y[i] * std::polar(1.0, -2 * pi * t.hz * double(i) / 1024);
    EXPECT_NEAR(2 * std::abs(sum) / double(y.size()) / t.amplitude, 1, 0.01) << t.hz;
    EXPECT_GT(std::fabs(2 * std::abs(sum) / double(y.size()) - t.amplitude / std::sqrt(2)), 0.2 * t.amplitude)
        << "control: amplitudes taken as rms";
  }
}

TEST(FringesInTime, TwoToneWall) {  // E.2c: lambda 0.5 um, 360 Hz are enough
  double const two_k_green = 4 * pi / 0.5e-6;
  MotionSet motion = moving({Spectrum()});
  motion.inputs = {{"slow", {}, 1, {{BodyId{0}, 2, std::polar(2.5e-6, pi / 2)}}},
                   {"fast", {}, 5, {{BodyId{0}, 2, std::polar(0.7e-6, pi)}}}};
  MotionSeries const m = draw_motion(motion, {0, 360, 2881}, 1);
  OnePath const wall(-two_k_green);  // motion toward the source shortens the path
  FastestFringe const fastest = fastest_fringe(wall.paths, m);
  EXPECT_LE(fastest.hz, 150.80);
  EXPECT_GT(fastest.hz, 140);
  EXPECT_LT(2 * fastest.hz, 360);
  std::vector<std::complex<double>> const s = stray_fields(wall.paths, m)[0].field;
  for (std::size_t i : {0u, 100u, 1234u, 2880u}) {
    double const t = double(i) / 360;
    double const phase = -(20 * pi * std::sin(2 * pi * t + pi / 2) + 5.6 * pi * std::sin(10 * pi * t + pi));
    EXPECT_LT(std::abs(s[i] - std::polar(1.0, phase)), 1e-12) << i;
  }
  EXPECT_NEAR(20 * pi, 62.8319, 1e-4);
  EXPECT_NEAR(5.6 * pi, 17.5929, 1e-4);
  motion.inputs.pop_back();
  EXPECT_NEAR(fastest_fringe(wall.paths, draw_motion(motion, {0, 360, 2881}, 1)).hz, 62.83, 0.005);
}

TEST(FringesInTime, CutOffOfSlowSines) {  // A2, eq. 7.2
  struct {
    double peak, hz, fringe;
  } const cases[] = {{14e-6, 0.42, 69.446}, {1e-6, 0.15, 1.7716}, {10e-6, 0.15, 17.7157}};
  for (auto const& c : cases) {
    MotionSet motion = moving({Spectrum()});
    motion.inputs = {tone(c.hz, c.peak)};
    MotionSeries const m = draw_motion(motion, {0, 512, 512 * 10}, 1);
    EXPECT_LT(deviation(fastest_fringe(OnePath(two_k).paths, m).hz, c.fringe), 1e-4);
  }
}

TEST(FringesInTime, SizeOfTheNeglectedTerms) {  // R4.07, eq. 2.6
  EXPECT_NEAR(second_order_phase(10e-6, 0.1, wavelength), 3.0e-3, 0.05e-3);
  EXPECT_NEAR(delay_cycles(1000, 6000), 0.0200, 0.00005);
}

// Eq. N.28, R4.07: two points 1.5 km before and after a flat mirror that turns by 1 urad.
TEST(FringesInTime, TiltOfTheRaysIsOfSecondOrderN28) {
  EXPECT_NEAR(ray_tilt_phase(1e-6, 1500, 1500, wavelength), -8.8579e-3, 1e-7);
  // The exact length, by the image of the first point in the mirror, at an angle that resolves it; any incidence.
  double const before = 0.7, after = 1.9, still = before + after, k = 2 * pi / wavelength;
  for (double const incidence : {0.0, 0.6, 1.2})
    for (double const angle : {2e-3, -2e-3, 4e-3}) {
      double const nx = std::sin(angle), nz = std::cos(angle);
      double x = before * std::sin(incidence), z = before * std::cos(incidence);
      double const depth = x * nx + z * nz;
      x -= 2 * depth * nx;
      z -= 2 * depth * nz;
      double const turned = std::hypot(x + after * std::sin(incidence), z - after * std::cos(incidence));
      double const exact = k * (turned - still);
      EXPECT_NEAR(ray_tilt_phase(angle, before, after, wavelength) / exact, 1, 2 * angle * angle) << incidence;
      EXPECT_GT(std::fabs(ray_tilt_phase(angle, before + after, before + after, wavelength) / exact - 1), 1)
          << "control: both legs as long as the path";
    }
}

// A bright route that hardly moves, a faint one of 2.5 rad rms that makes the noise, and a fainter one that moves most:
// p (1 - exp(-phi^2)) is 1e-6 of 1, 0.00998 of 0.01, 0.0001 of 0.0001.
TEST(FringesInTime, RmsPhaseIsThatOfTheRouteWithTheLargestMovingPower) {
  double const peak = 1e-6, rms = two_k * peak / std::sqrt(2), slow = 1e-3 / rms, fast = 2.5 / rms;
  CouplingTable const table =
      known_table({known_class(1, 1, {record(1, 1, {phase_sensitivity(0, 2, slow * two_k)})}),
                   known_class(2, 0.01,
                               {record(2, 0.005, {phase_sensitivity(0, 2, fast * two_k)}),
                                record(3, 0.005, {phase_sensitivity(0, 2, 1.2 * fast * two_k)})}),
                   known_class(3, 1e-4, {record(4, 1e-4, {phase_sensitivity(0, 2, 4 * fast * two_k)})})});
  MotionSet motion = moving({Spectrum()});
  motion.inputs = {tone(10, peak)};
  std::vector<StrayPath> const paths = stray_paths(table, UnitDetector(), {{0, 1, 2}, 0, 1, 0});
  MotionSeries const m = draw_motion(motion, {0, 1024, 2048}, 1);
  MovingRoute const found = moving_route(paths, m);
  EXPECT_EQ(found.route, 1u);
  EXPECT_NEAR(found.rms_phase, 2.5 * std::sqrt((1 + 1.44) / 2), 1e-9);
  // Control: the rms over all routes by power is that of light that makes no noise.
  double power = 0, square = 0;
  for (StrayPath const& p : paths) {
    double const phase = std::array{1e-3, 2.5, 10.0}[p.route], p2 = p.amplitude * p.amplitude;
    power += p2;
    square += p2 * phase * phase;
  }
  EXPECT_LT(std::sqrt(square / power), 0.1 * found.rms_phase);
  // Nothing moves: the first, and exactly 0.
  MovingRoute const still = moving_route(paths, draw_motion(moving({}), {0, 1024, 2048}, 1));
  EXPECT_EQ(still.route, 0u);
  EXPECT_EQ(still.rms_phase, 0);
}

// Light of 6 km that sees a 1 kHz tone: half of its way is a hundredth of a cycle.
TEST(FringesInTime, RetardedMotion) {  // R4.07
  MotionSet motion = moving({Spectrum()});
  motion.inputs = {tone(1000, 1e-9)};
  MotionSeries const m = draw_motion(motion, {0, 65536, 65536}, 1);
  OnePath path(two_k);
  path.paths[0].length = 6000;
  auto const argument = [&](Delay delay) {
    std::complex<double> sum = 0;
    auto const field = stray_fields(path.paths, m, delay)[0].field;
    for (std::size_t i = 0; i < field.size(); ++i)
      sum += field[i].imag() * std::polar(1.0, -2 * pi * 1000 * double(i) / 65536);
    return std::arg(sum);
  };
  // Retarded: sin(2 pi f (t - l/2c)); the first order in the delay leaves (2 pi 0.01)^3/3.
  EXPECT_NEAR(argument(Delay::half_path) - argument(Delay::none), -2 * pi * delay_cycles(1000, 3000), 1e-4);
}

}  // namespace
}  // namespace straytrace::testing
