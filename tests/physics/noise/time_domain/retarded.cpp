// SPDX-License-Identifier: BSD-3-Clause
// Light that takes its time (docs/theory/phase.md, eq. 2.6): what a delay of half of the path leaves out of the delay
// of each body.
#include "physics/noise/time_domain/time_support.hpp"

namespace straytrace::testing::noise_retarded {
namespace {

// One body moves at a tone; light takes 6 km. A hit: its phase sensitivity over 2k, and metres from there to the end of
// the path.
struct Hit {
  double phase_sensitivity, left;
};
struct Path {
  std::vector<Hit> hits;
};
constexpr double length = 6000, hz = 100, peak = 1e-12;  // m, Hz, m: linear

// Im s at the tone over 2k times its peak, convention e^(-2 pi i f t): sum over the paths of the sum over their hits.
std::complex<double> exact(std::vector<Path> const& paths) {
  std::complex<double> sum = 0;
  for (Path const& p : paths)
    for (Hit const& h : p.hits) sum += h.phase_sensitivity * std::polar(1.0, 2 * pi * hz * h.left / speed_of_light);
  return sum;
}

// The same by the program: phase sensitivities summed, half of the length.
std::complex<double> by_half(std::vector<Path> const& paths) {
  MotionSet m;
  m.bodies = {"a"};
  m.inputs = {tone(hz, peak)};
  SampleTimes const times{0, 8192, 8192};
  MotionSeries const motion = draw_motion(m, times, 7, 0);
  std::vector<PhaseSensitivity> phase_sensitivities = {phase_sensitivity(0, 2, 0)};
  for (Path const& p : paths)
    for (Hit const& h : p.hits) phase_sensitivities[0].d[2] += two_k * h.phase_sensitivity / double(paths.size());
  StrayPath one;
  one.port = PortId{0};
  one.amplitude = double(paths.size());
  one.length = length;
  one.phase_sensitivities = phase_sensitivities;
  PortField const field = stray_fields(std::vector{one}, motion, Delay::half_path).front();
  std::complex<double> sum = 0, drive = 0;
  for (std::size_t i = 0; i < times.samples; ++i) {
    std::complex<double> const turn = std::polar(1.0, 2 * pi * hz * double(i) / times.rate);
    sum += field.field[i].imag() * turn;
    drive += motion.coordinates[0].position[i] * turn;
  }
  return sum / drive / two_k;
}

double error(std::vector<Path> const& paths) {
  return std::abs(by_half(paths) - exact(paths)) / std::abs(exact(paths));
}

double const whole = pi * hz * length / speed_of_light;  // pi f l/c: 6.3e-3

TEST(Retarded, HalfOfThePathIsExactInTheMiddle) {  // to first order in the delay
  EXPECT_LT(error({Path{{{1, length / 2}}}}), whole * whole);
}

// The reverse of a path meets each body as long before its end as the path does after its beginning. Both add as fields
// (eq. 1.5), so that the mean delay of any body is half of the length. Control: one of the two alone.
TEST(Retarded, HalfOfThePathIsExactWithTheReverse) {
  for (double const left : {0.0, 900.0, 4500.0}) {
    Path const path{{{1, left}}}, reverse{{{1, length - left}}};
    EXPECT_LT(error({path, reverse}), 1.01 * whole * whole) << left;
    double const apart = 2 * pi * hz * std::fabs(left - length / 2) / speed_of_light;
    EXPECT_NEAR(error({path}) / apart, 1, 0.01) << left;
    EXPECT_LT(error({path}), 1.01 * whole) << left;
  }
}

}  // namespace
}  // namespace straytrace::testing::noise_retarded
