// SPDX-License-Identifier: BSD-3-Clause
#include "noise/fundamental/closed_forms.hpp"

#include <cmath>

#include "base/math/constants.hpp"

namespace straytrace::closed_forms {
namespace {

double pole_factor(double length, double finesse, double hz) {
  return std::hypot(1, hz * 4 * length * finesse / speed_of_light);
}

}  // namespace

double shot(double wavelength, double length, double finesse, double power, double hz) {
  return pi / (2 * finesse * length) * std::sqrt(hbar * speed_of_light * wavelength / (4 * pi * power)) *
         pole_factor(length, finesse, hz);
}

double photon_rate(double wavelength, double power) { return power * wavelength / (2 * pi * hbar * speed_of_light); }

double power_noise(double wavelength, double power) {
  return std::sqrt(4 * pi * hbar * speed_of_light * power / wavelength);
}

double radiation_pressure(double wavelength, double length, double mass, double power, double hz, double finesse) {
  double const w = 2 * pi * hz, light = 2 * pi * speed_of_light / wavelength;
  double const plain = std::sqrt(8 * hbar * light * power) / (speed_of_light * mass * length * w * w);
  return finesse > 0 ? plain * 4 * finesse / pi / pole_factor(length, finesse, hz) : plain;
}

double quantum_limit(double length, double mass, double hz) {
  return std::sqrt(8 * hbar / mass) / (2 * pi * hz * length);
}

double quantum(double wavelength, double length, double mass, double input_transmission, double arm_power, double hz) {
  double const w = 2 * pi * hz, light = 2 * pi * speed_of_light / wavelength,
               gamma = input_transmission * speed_of_light / (4 * length);
  double const k = 16 * light * arm_power * gamma / (mass * speed_of_light * length * w * w * (gamma * gamma + w * w));
  return quantum_limit(length, mass, hz) * std::sqrt((1 / k + k) / 2);
}

double substrate_brownian(double temperature, double young, double poisson, double loss, double w, double hz) {
  return std::sqrt(2 * boltzmann * temperature * (1 - poisson * poisson) * loss / (std::pow(pi, 1.5) * hz * w * young));
}

double coating_brownian(double temperature, double young, double poisson, double loss, double thickness, double w,
                        double hz) {
  return std::sqrt(4 * boltzmann * temperature / (pi * pi * hz) * (1 + poisson) * (1 - 2 * poisson) * thickness * loss /
                   (w * w * young));
}

double pendulum(double temperature, double mass, double resonance, double loss, double hz, Damping damping) {
  double const w = 2 * pi * hz, ws = 2 * pi * resonance;
  double const angle = damping == Damping::structural ? loss : loss * hz / resonance;
  return std::sqrt(4 * boltzmann * temperature * ws * ws * angle /
                   (mass * w * (std::pow(ws * ws - w * w, 2) + std::pow(ws * ws * angle, 2))));
}

double pendulum_rms(double temperature, double mass, double resonance) {
  return std::sqrt(boltzmann * temperature / mass) / (2 * pi * resonance);
}

}  // namespace straytrace::closed_forms
