// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/cavity.hpp"

#include <cmath>

#include "base/math/constants.hpp"

namespace straytrace::ifo {
namespace {

double pole_of(double product, double length) {  // product of the two amplitude reflectivities
  return speed_of_light * (1 - product) / (4 * pi * length * std::sqrt(product));
}

}  // namespace

double ArmCavity::r1() const { return std::sqrt(1 - input_transmission); }
double ArmCavity::r2() const { return std::sqrt((1 - end_transmission) * (1 - round_trip_loss)); }

double finesse(ArmCavity const& arm) {
  double const product = arm.r1() * arm.r2();
  return pi * std::sqrt(product) / (1 - product);
}

double cavity_pole(ArmCavity const& arm) { return pole_of(arm.r1() * arm.r2(), arm.length); }

DifferentialMode differential_mode(ArmCavity const& arm, double signal_transmission) {
  double const between = arm.r1() * std::sqrt(1 - signal_transmission);
  double const transmission = arm.input_transmission * signal_transmission / std::pow(1 - between, 2);
  double const product = std::sqrt(1 - transmission) * arm.r2();
  return {1 / (1 - product), pole_of(product, arm.length)};
}

double arm_power(ArmCavity const& arm, double input_power, double recycling_transmission, double beam_splitter_loss) {
  double const t1 = std::sqrt(arm.input_transmission), gain = t1 / (1 - arm.r1() * arm.r2()),
               reflected = arm.r1() - t1 * arm.r2() * gain;  // about -1 on resonance
  double const recycled = std::sqrt(recycling_transmission) /
                          (1 + std::sqrt(1 - recycling_transmission) * reflected * std::sqrt(1 - beam_splitter_loss));
  return input_power * std::pow(gain * recycled, 2) / 2;
}

double strain_per_phase_in_arm(double wavelength, double length) { return wavelength / (4 * pi) / length; }

std::complex<double> strain_per_amplitude_in_arm(double hz, double power, double mass, double length,
                                                 DifferentialMode mode) {
  double const slow = 8 * power * mode.gain / (speed_of_light * mass * std::pow(2 * pi * hz, 2) * length);
  return slow / std::complex<double>(1, hz / mode.pole);
}

std::complex<double> strain_per_phase_in_short_arm(ArmCavity const& arm, double wavelength, double hz) {
  double const slow = strain_per_phase_in_arm(wavelength, arm.length) * pi / (2 * finesse(arm));
  return slow * std::complex<double>(1, hz / cavity_pole(arm));
}

std::complex<double> strain_at_antisymmetric_port(double dark_fringe_offset, double length, double hz,
                                                  DifferentialMode mode) {
  return dark_fringe_offset / length * std::complex<double>(1, hz / mode.pole);
}

}  // namespace straytrace::ifo
