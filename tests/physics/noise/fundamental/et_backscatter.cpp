// SPDX-License-Identifier: BSD-3-Clause
// Back-scatter in the arm of the Einstein Telescope: the whole chain from couplings to strain in closed form
// (docs/theory/arm.md, eq. 8.1, 8.3 to 8.6; cases A11 and B5).
#include "ifo/fabry_perot_michelson.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing::noise_et_backscatter {
namespace {

// Mirror -> baffle -> same mirror, far half of the tube, mirror BRDF kappa theta^-n; eq. 8.3 and 8.4.
double baffle_sum(double kappa, double n, double radius, double length, double first_baffle) {
  double const low = radius / (length - first_baffle), high = 2 * radius / length, p = 4 - 2 * n;
  double const integral = p == 0 ? std::log(high / low) : (std::pow(high, p) - std::pow(low, p)) / p;
  return 2 * pi * kappa * kappa / (radius * radius) * integral;
}

TEST(EinsteinTelescope, BaffleSum) {  // A11, tolerance 1e-6
  EXPECT_LT(deviation(baffle_sum(3.2145e-9, 2.3986, 0.5, 10e3, 32.35), 3.689325e-13), 1e-6);
  EXPECT_LT(deviation(baffle_sum(1e-6, 2, 0.5, 10e3, 50), 1.729471e-11), 1e-6);
  EXPECT_GT(deviation(baffle_sum(3.2145e-9, 2.3986, 0.5, 10e3, 0), 3.689325e-13), 1e-3);  // control: no first baffle
}

FabryPerotMichelson detector() {
  FabryPerotMichelson::Parameters p;
  p.arm = {10e3, 0.007, 5e-6, 75e-6};
  p.wavelength = wavelength;
  p.power = arm_power(p.arm, 500, 0.045, 1e-3);
  p.mass = 200;
  p.mode = {15.7, 1e12};
  return FabryPerotMichelson(p);
}

// h/X [1/m] at 3, 10 and 100 Hz: the two mirrors of an arm as two ports, small flat motion X of the baffles.
std::vector<double> strain_per_motion(double reverse) {
  double const coupling = wavelength * wavelength * 1e-4 * baffle_sum(3.2145e-9, 2.3986, 0.5, 10e3, 32.35);
  std::vector<CouplingClass> mirrors;
  for (std::uint32_t port : {0u, 1u}) {
    mirrors.push_back(known_class(port, coupling, {record(0, coupling, {phase_sensitivity(0, 2, two_k)})}));
    mirrors.back().port = PortId{port};
    mirrors.back().reverse = reverse;
  }
  CouplingTable table = known_table(mirrors);
  table.ports = {"ITM", "ETM"};
  double const x = 1e-15;
  MotionSet const motion = moving({Spectrum({1, 1000}, {x * x, x * x})});
  std::vector<double> const h =
      project_noise(table, motion, detector(), on({2.999, 3.001, 9.99, 10.01, 99.9, 100.1})).total.asd;
  return {h[0] / x, h[2] / x, h[4] / x};
}

constexpr double published[] = {1.94697e-16, 1.75464e-17, 9.30612e-19};

TEST(EinsteinTelescope, BackScatterStrain) {  // B5, tolerance 1e-4
  std::vector<double> const once = strain_per_motion(1), reversed = strain_per_motion(2);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(deviation(once[i], published[i]), 1e-4);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_LT(deviation(reversed[i], std::sqrt(2) * published[i]), 1e-4);  // eq. 8.5 with C_rev = 2
  EXPECT_GT(deviation(reversed[0], published[0]), 0.4);  // control: pairs of reverse paths counted twice
}

TEST(EinsteinTelescope, QuadraturesAddInPower) {
  double const coupling = 1e-24;
  CouplingTable const table =
      known_table({known_class(1, coupling, {record(0, coupling, {phase_sensitivity(0, 2, two_k)})})});
  MotionSet const motion = moving({Spectrum({1, 1000}, {1e-30, 1e-30})});
  NoiseTrace const t = project_noise(table, motion, detector(), on({9.99, 10.01, 99.9, 100.1})).total;
  for (std::size_t i = 0; i < t.asd.size(); ++i)
    EXPECT_LT(deviation(t.asd[i], std::hypot(t.phase_asd[i], t.amplitude_asd[i])), 1e-12);
  EXPECT_LT(deviation(t.amplitude_asd[2] / t.amplitude_asd[0], 0.01), 1e-3);  // 1/f^2
  EXPECT_LT(deviation(t.phase_asd[2], t.phase_asd[0]), 1e-6);
}

}  // namespace
}  // namespace straytrace::testing::noise_et_backscatter
