// SPDX-License-Identifier: BSD-3-Clause
// Textbook forms of fundamental noises (docs/theory/sensitivity.md, eq. 12.2 to 12.9, R2.18 to R2.21): checks of the
// full calculation. One-sided ASD; strain in 1/sqrt(Hz).
#pragma once

#include <cmath>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "noise/fundamental/fundamental.hpp"

namespace straytrace::closed_forms {

inline double pole_factor(double length, double finesse, double hz) {
  return std::hypot(1, hz * 4 * length * finesse / speed_of_light);
}

// eq. 12.2: Michelson with arm cavities, no signal recycling; power at the splitter in W. Pole f_p = c/(4 L finesse).
inline double shot(double wavelength, double length, double finesse, double power, double hz) {
  return pi / (2 * finesse * length) * std::sqrt(hbar * speed_of_light * wavelength / (4 * pi * power)) *
         pole_factor(length, finesse, hz);
}

// 1/s, eq. 12.3
inline double photon_rate(double wavelength, double power) {
  return power * wavelength / (2 * pi * hbar * speed_of_light);
}

// W/sqrt(Hz): sqrt(2 h nu P)
inline double power_noise(double wavelength, double power) {
  return std::sqrt(4 * pi * hbar * speed_of_light * power / wavelength);
}

// eq. 12.4: plain Michelson; with cavities whose mirrors are both free: times 4 F/pi and the pole (finesse > 0).
inline double radiation_pressure(double wavelength, double length, double mass, double power, double hz,
                                 double finesse = 0) {
  double const w = 2 * pi * hz, light = 2 * pi * speed_of_light / wavelength;
  double const plain = std::sqrt(8 * hbar * light * power) / (speed_of_light * mass * length * w * w);
  return finesse > 0 ? plain * 4 * finesse / pi / pole_factor(length, finesse, hz) : plain;
}

// eq. 12.6 (Kimble et al. 2001): both, with their ratio K; arm power in W.
inline double quantum(double wavelength, double length, double mass, double input_transmission, double arm_power,
                      double hz) {
  double const w = 2 * pi * hz, light = 2 * pi * speed_of_light / wavelength,
               gamma = input_transmission * speed_of_light / (4 * length);
  double const k = 16 * light * arm_power * gamma / (mass * speed_of_light * length * w * w * (gamma * gamma + w * w));
  return quantum_limit(length, mass, hz) * std::sqrt((1 / k + k) / 2);
}

// eq. 12.7 and 12.8, m/sqrt(Hz) of one mirror: half space. 12.8 is an order of magnitude.
inline double substrate_brownian(double temperature, double young, double poisson, double loss, double w, double hz) {
  return std::sqrt(2 * boltzmann * temperature * (1 - poisson * poisson) * loss / (std::pow(pi, 1.5) * hz * w * young));
}

inline double coating_brownian(double temperature, double young, double poisson, double loss, double thickness,
                               double w, double hz) {
  return std::sqrt(4 * boltzmann * temperature / (pi * pi * hz) * (1 + poisson) * (1 - 2 * poisson) * thickness * loss /
                   (w * w * young));
}

// eq. 12.9, m/sqrt(Hz): one pendulum. Structural: the loss angle is that of the spring; viscous: loss angle f/f_s.
enum class Damping { structural, viscous };
inline double pendulum(double temperature, double mass, double resonance, double loss, double hz,
                       Damping damping = Damping::structural) {
  double const w = 2 * pi * hz, ws = 2 * pi * resonance;
  double const angle = damping == Damping::structural ? loss : loss * hz / resonance;
  return std::sqrt(4 * boltzmann * temperature * ws * ws * angle /
                   (mass * w * (std::pow(ws * ws - w * w, 2) + std::pow(ws * ws * angle, 2))));
}

// m: sqrt(kT/(M w_s^2))
inline double pendulum_rms(double temperature, double mass, double resonance) {
  return std::sqrt(boltzmann * temperature / mass) / (2 * pi * resonance);
}

}  // namespace straytrace::closed_forms
