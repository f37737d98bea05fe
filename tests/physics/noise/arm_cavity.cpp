// SPDX-License-Identifier: BSD-3-Clause
// Arm cavities and injection points (docs/theory/interferometer.md, eq. 6.4, 6.5, 6.8, 6.11, 9.1, 9.3, 9.5, 9.10; cases
// A10, A14, B6).
#include "ifo/fabry_perot_michelson.hpp"
#include "physics/ifo/exact_arm.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing {
namespace {

TEST(ArmCavity, FabryPerotNumbers) {  // A10, tolerance 1e-5
  ArmCavity arm{2999.8, 0.014, 1e-6, 75e-6};
  EXPECT_LT(deviation(finesse(arm), 443.2596), 1e-5);
  EXPECT_LT(deviation(cavity_pole(arm), 56.3651), 1e-5);
  EXPECT_LT(deviation(power_gain(arm), 280.687), 1e-5);
  arm.round_trip_loss = 0;  // negative control
  EXPECT_GT(deviation(finesse(arm), 443.2596), 1e-3);
}

double gain(double input, double recycling) { return differential_mode({3000, input, 0, 0}, recycling).gain; }

TEST(ArmCavity, SignalRecyclingGain) {  // list under eq. 6.8, printed digits
  EXPECT_NEAR(gain(0.014, 0.325), 14.4, 0.05);
  EXPECT_NEAR(gain(0.014, 0.35), 15.72, 0.005);
  EXPECT_NEAR(gain(0.014, 0.2), 8.4, 0.05);
  EXPECT_NEAR(gain(0.007, 0.05), 4.15, 0.005);
  EXPECT_NEAR(gain(0.007, 0.2), 16.4, 0.05);
  EXPECT_NEAR(gain(0.014, 1), 142.36, 0.005);
  EXPECT_GT(std::fabs(gain(0.014, 0.65) - 15.72), 1);  // control: reflectivity read as transmission
}

TEST(ArmCavity, NoSignalRecyclingIsThePlainArm) {  // eq. 6.8 with T_s = 1 against eq. 6.5, tolerance 1e-12
  ArmCavity const arm{2999.8, 0.014, 1e-6, 75e-6};
  EXPECT_LT(deviation(differential_mode(arm, 1).pole, cavity_pole(arm)), 1e-12);
  EXPECT_LT(deviation(std::pow(differential_mode(arm, 1).gain, 2) * 0.014, power_gain(arm)), 1e-12);
  EXPECT_GT(differential_mode(arm, 0.35).pole, 5 * cavity_pole(arm));
}

TEST(ArmCavity, PowerOfTheEinsteinTelescope) {  // B6, printed digits
  ArmCavity const hf{10000, 0.007, 5e-6, 75e-6}, lf{10000, 0.007, 5e-6, 40e-6};
  EXPECT_LT(deviation(arm_power(hf, 500, 0.045, 1e-3), 3.0593e6), 2e-5);
  EXPECT_LT(deviation(arm_power(lf, 1.7, 0.026, 1e-3), 18.188e3), 3e-5);
  EXPECT_GT(deviation(arm_power(hf, 500, 0.045, 0), 3.0593e6), 1e-2);  // control: lossless beam splitter
}

TEST(InjectionPoints, ExactPlaneWavesAgainstTheTable) {  // A14
  ArmCavity const arm{3000, 0.014, 4.4e-6, 75e-6};
  std::complex<double> const i(0, 1);
  double const inside = equivalent_length(arm, wavelength, 1e-9 * i, 0);
  EXPECT_LT(deviation(inside, 8.5273e-17), 1e-4);
  double const by_9_1 = strain_per_phase_in_arm(wavelength, arm.length) * arm.length * 1e-9;
  EXPECT_LT(deviation(inside / by_9_1, 1.0071), 1e-4);
  double const splitter = equivalent_length(arm, wavelength, 0, 1e-9 * i),
               by_9_5 = wavelength / (4 * pi) * pi / (2 * finesse(arm)) * 1e-9;
  EXPECT_LT(deviation(std::fabs(splitter), by_9_5), 0.01);
  double const end_bench = equivalent_length(arm, wavelength, 4.4e-6 * 1e-4 * i, 0),
               by_9_3 = wavelength / (4 * pi) * 4.4e-6 * 1e-4;
  EXPECT_LT(deviation(end_bench, by_9_3), 0.01);
  EXPECT_LT(std::fabs(equivalent_length(arm, wavelength, 1e-9, 0)), 1e-6 * inside);  // in phase: no length
  // Controls: the splitter side taken as the arm; the real part as the imaginary one.
  EXPECT_GT(deviation(by_9_1, std::fabs(splitter)), 100);
}

TEST(InjectionPoints, PowerRatioOfSplitterSideAndArm) {  // "8e4 times worse in power" under eq. 9.10
  ArmCavity const arm{2999.8, 0.014, 1e-6, 75e-6};
  double const ratio = std::pow(2 * finesse(arm) / pi, 2);
  EXPECT_LT(deviation(ratio, 282.2 * 282.2), 1e-3);
}

}  // namespace
}  // namespace straytrace::testing
