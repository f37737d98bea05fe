// SPDX-License-Identifier: BSD-3-Clause
// Textbook forms of fundamental noises: numbers of R2.16, R2.18 to R2.21, R2.23 and of case A23, to
// 1e-3 where they are given with four digits. Controls: the formulas as the thesis of 1997 prints them.
#include "noise/fundamental/budget.hpp"
#include "noise/fundamental/fundamental.hpp"
#include "physics/noise/fundamental/closed_forms.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing::noise_fundamental_forms {
namespace {

using namespace closed_forms;
constexpr double length = 3000, finesse = 450, mass = 42;

TEST(ShotNoise, OfTheRequirements) {  // R2.18, eq. 12.2 and 12.3
  EXPECT_LT(deviation(shot(wavelength, length, finesse, 1000, 10), 1.934e-24), 1e-3);
  EXPECT_LT(deviation(shot(wavelength, length, finesse, 1000, 100), 3.922e-24), 1e-3);
  EXPECT_LT(deviation(speed_of_light / (4 * length * finesse), 55.52), 1e-3);
  EXPECT_LT(deviation(2 * length * finesse / (pi * speed_of_light) / 2, 1.433e-3), 1e-3);  // power storage time, s
  EXPECT_LT(deviation(photon_rate(wavelength, 1), 5.356e18), 1e-3);
  EXPECT_LT(deviation(power_noise(wavelength, 1), 6.11e-10), 1e-3);
}

TEST(ShotNoise, ControlWithoutTheSquareUnderTheRoot) {  // thesis: sqrt(1 + f/f_p), too low above the pole
  double const pole = 55.52, right = shot(wavelength, length, finesse, 1000, 1000);
  double const printed = right / std::hypot(1, 1000 / pole) * std::sqrt(1 + 1000 / pole);
  EXPECT_LT(printed / right, 0.25);
}

TEST(RadiationPressure, OfTheRequirements) {  // R2.19, eq. 12.4
  EXPECT_LT(deviation(radiation_pressure(wavelength, length, mass, 25, 10), 4.098e-26), 1e-3);
  EXPECT_LT(deviation(radiation_pressure(wavelength, length, mass, 25, 100), 4.098e-28), 1e-3);
  EXPECT_LT(deviation(radiation_pressure(wavelength, length, mass, 1000, 10, finesse), 1.461e-22), 1e-3);
  EXPECT_LT(deviation(radiation_pressure(wavelength, length, mass, 1000, 100, finesse), 7.207e-25), 1e-3);
}

TEST(RadiationPressure, ControlAsPrinted) {  // thesis: root of 2 low
  double const printed = radiation_pressure(wavelength, length, mass, 25, 10) / std::sqrt(2);
  EXPECT_LT(deviation(printed, 2.897e-26), 1e-3);
  EXPECT_GT(deviation(printed, 4.098e-26), 0.29);
}

TEST(QuantumLimit, OfTheRequirements) {  // R2.20, eq. 12.5
  EXPECT_LT(deviation(quantum_limit(length, mass, 10), 2.378e-23), 1e-3);
  EXPECT_LT(deviation(quantum_limit(length, mass, 100), 2.378e-24), 1e-3);
}

TEST(QuantumNoise, A23) {  // eq. 12.6, tolerance 1e-4; and what it is made of
  double const l = 2999.8, t = 0.014, p = 650e3;
  EXPECT_LT(deviation(quantum(1.064e-6, l, mass, t, p, 10), 3.1093e-22), 1e-4);
  EXPECT_LT(deviation(quantum(1.064e-6, l, mass, t, p, 100), 2.3971e-24), 1e-4);
  EXPECT_LT(deviation(quantum(1.064e-6, l, mass, t, p, 1000), 1.6101e-23), 1e-4);
  EXPECT_LT(deviation(t * speed_of_light / (4 * l) / (2 * pi), 55.67), 1e-4);
  // Shot noise and radiation pressure of the same cavity add up to it: F = 2 pi/T, P at the splitter = P_arm T/2.
  for (double const hz : {10.0, 100.0, 1000.0}) {
    double const f = 2 * pi / t, sum = std::hypot(shot(wavelength, l, f, p * t / 2, hz),
                                                  radiation_pressure(wavelength, l, mass, p * t / 2, hz, f));
    EXPECT_LT(deviation(quantum(wavelength, l, mass, t, p, hz), sum), 1e-9);
    EXPECT_GE(quantum(wavelength, l, mass, t, p, hz), quantum_limit(l, mass, hz));
  }
  double const one_end =
      std::hypot(shot(wavelength, l, 2 * pi / t, p * t / 2, 10),
                 radiation_pressure(wavelength, l, mass, p * t / 2, 10, 2 * pi / t) / 2);  // control: 2F/pi
  EXPECT_GT(deviation(one_end, 3.1093e-22), 0.4);
}

TEST(Pendulum, OfTheRequirements) {  // R2.21, eq. 12.9
  EXPECT_LT(deviation(pendulum(300, mass, 0.6, 1e-8, 10), 2.401e-19), 1e-3);
  EXPECT_LT(deviation(pendulum(300, mass, 0.6, 1e-8, 100), 7.567e-22), 1e-3);
  EXPECT_LT(deviation(pendulum_rms(300, mass, 0.6), 2.634e-12), 1e-3);
  // Structural: f^-2.5 above the resonance; viscous: f^-2.
  auto const slope = [](Damping d) {
    return std::log10(pendulum(300, mass, 0.6, 1e-8, 1000, d) / pendulum(300, mass, 0.6, 1e-8, 100, d));
  };
  EXPECT_NEAR(slope(Damping::structural), -2.5, 1e-3);
  EXPECT_NEAR(slope(Damping::viscous), -2.0, 1e-3);
}

TEST(Pendulum, AreaIsThermalEnergy) {  // equipartition: integral = kT/(M w_s^2); loss 0.01, 1 % of the tail is cut
  for (Damping const d : {Damping::structural, Damping::viscous}) {
    double area = 0;
    for (double hz = 1e-5; hz < 100; hz *= 1.0005)
      area += std::pow(pendulum(300, mass, 0.6, 0.01, hz, d), 2) * hz * 0.0005;
    double const full = std::pow(pendulum_rms(300, mass, 0.6), 2);
    if (d == Damping::viscous) {
      EXPECT_NEAR(area / full, 1, 0.01);
    }
    if (d == Damping::structural) {
      EXPECT_NEAR(area / full, 1 + 0.01 * 2 / pi * std::log(0.6 / 1e-5), 0.03);
    }
  }
}

TEST(Pendulum, ControlWithTheLossAtTheMass) {  // thesis: loss on w^2 instead of w_s^2, too large by f/f_s
  auto const printed = [](double hz) { return pendulum(300, mass, 0.6, 1e-8, hz) * hz / 0.6; };
  EXPECT_LT(deviation(printed(10), 4.002e-18), 1e-3);
  EXPECT_LT(deviation(printed(100), 1.261e-19), 1e-3);
  EXPECT_GT(deviation(printed(10), 2.401e-19), 10);
}

TEST(Seismic, PowerLaw) {  // R2.16: 1e-6 m x (1 Hz/f)^2
  EXPECT_LT(deviation(platform_asd("virgo", 10), 1e-8), 1e-12);
  EXPECT_LT(deviation(platform_asd("quiet", 10), 1e-9), 1e-12);
  EXPECT_LT(deviation(platform_asd("BSC", std::sqrt(10.0)), std::sqrt(1e-11 * 3e-13)), 1e-9);  // between two knots
  EXPECT_TRUE(std::isnan(platform_asd("bsc", 10)));
}

TEST(Budget, TenEqualEntries) {  // R2.23: ten entries at 0.1 of the reference: 0.316 of it
  NoiseTable t{{10, 100}, {}};
  for (int i = 0; i < 10; ++i) t.entries.push_back({"n", "", BudgetEntry::Kind::technical, {0.1, 0.1}, {}, "", {}});
  EXPECT_NEAR(t.total()[0], 0.316, 3e-4);
  EXPECT_FALSE(NoiseTable::exceeds(0.0999, 1, 0.1));
  EXPECT_TRUE(NoiseTable::exceeds(0.1001, 1, 0.1));
  double linear = 0;  // control: amplitudes added
  for (BudgetEntry const& e : t.entries) linear += e.asd[0];
  EXPECT_GT(deviation(linear, 0.316), 2);
}

TEST(Budget, UnknownNoiseIsNotZero) {
  NoiseTable t{{10, 100}, {{"a", "", BudgetEntry::Kind::technical, {not_a_number, 3}, {}, "", {}}}};
  EXPECT_TRUE(std::isnan(t.total()[0]));
  EXPECT_DOUBLE_EQ(t.total()[1], 3);
  EXPECT_TRUE(thermal_requirement(t).empty());
}

}  // namespace
}  // namespace straytrace::testing::noise_fundamental_forms
