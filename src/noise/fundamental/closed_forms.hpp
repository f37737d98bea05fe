// SPDX-License-Identifier: BSD-3-Clause
// Textbook forms of fundamental noises (docs/theory/sensitivity.md, eq. 12.2 to 12.9, R2.18 to R2.21): checks of the
// full calculation, and orders of magnitude where its parameters are not known. One-sided ASD; strain in 1/sqrt(Hz).
#pragma once

namespace straytrace::closed_forms {

// eq. 12.2: Michelson with arm cavities, no signal recycling; power at the splitter in W. Pole f_p = c/(4 L finesse).
double shot(double wavelength, double length, double finesse, double power, double hz);
double photon_rate(double wavelength, double power);  // 1/s, eq. 12.3
double power_noise(double wavelength, double power);  // W/sqrt(Hz): sqrt(2 h nu P)
// eq. 12.4: plain Michelson; with cavities whose mirrors are both free: times 4 F/pi and the pole (finesse > 0).
double radiation_pressure(double wavelength, double length, double mass, double power, double hz, double finesse = 0);
double quantum_limit(double length, double mass, double hz);  // eq. 12.5
// eq. 12.6 (Kimble et al. 2001): both, with their ratio K; arm power in W.
double quantum(double wavelength, double length, double mass, double input_transmission, double arm_power, double hz);
// eq. 12.7 and 12.8, m/sqrt(Hz) of one mirror: half space. 12.8 is an order of magnitude.
double substrate_brownian(double temperature, double young, double poisson, double loss, double w, double hz);
double coating_brownian(double temperature, double young, double poisson, double loss, double thickness, double w,
                        double hz);
// eq. 12.9, m/sqrt(Hz): one pendulum. Structural: the loss angle stands at the spring; viscous: loss angle f/f_s.
enum class Damping { structural, viscous };
double pendulum(double temperature, double mass, double resonance, double loss, double hz,
                Damping damping = Damping::structural);
double pendulum_rms(double temperature, double mass, double resonance);  // m: sqrt(kT/(M w_s^2))

}  // namespace straytrace::closed_forms
