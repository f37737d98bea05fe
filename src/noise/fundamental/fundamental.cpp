// SPDX-License-Identifier: BSD-3-Clause
#include "noise/fundamental/fundamental.hpp"

#include <cmath>
#include <complex>

#include "beams/cavity_mode.hpp"
#include "ifo/fabry_perot_michelson.hpp"

namespace straytrace::noise {

double CoatingMaterial::loss_at(double hz) const { return loss * std::pow(hz / 100, loss_slope); }

namespace {

ArmCavity arm_of(Detector const& d) {
  return {d.arm_length, d.input.transmission, d.end.transmission, 2 * d.mirror_loss};
}

}  // namespace

double Detector::circulating_power() const {
  if (std::isfinite(arm_power)) return arm_power;
  return ifo::arm_power(arm_of(*this), input_power, power_recycling, splitter_loss);
}

DetectorNumbers Detector::numbers() const {
  ArmCavity const arm = arm_of(*this);
  return {arm_length, circulating_power(), mirror_mass, finesse(arm), differential_mode(arm, signal_recycling).gain};
}

Detector::Spots Detector::spots() const {
  CavityMode const m = cavity_mode(arm_length, input.curvature, end.curvature, wavelength);
  return {m.w1, m.w2, m.waist, m.rayleigh, m.waist_position};
}

double Detector::strain_per_length_squared(double hz) const {
  double const phase = pi * hz * arm_length / speed_of_light, tilt = std::sin(pi / 12);
  double const forth = (1 - tilt) * phase, back = (1 + tilt) * phase;
  std::complex<double> const response =
      std::sin(forth) / forth * std::polar(1.0, -phase) + std::sin(back) / back * std::polar(1.0, phase);
  return 4 / std::norm(response) / (arm_length * arm_length);
}

namespace {

using Hertz = std::span<double const>;
using Psd = std::vector<double>;

// Length PSD of the difference of both arms -> strain.
template <class F>
Psd calibrated(Detector const& d, Hertz hz, F const& length_psd) {
  Psd psd;
  for (double const f : hz) psd.push_back(length_psd(f) * d.strain_per_length_squared(f));
  return psd;
}

MirrorShape shape(Detector const& d) { return {d.mirror_radius, d.mirror_thickness}; }

// Two input and two end mirrors, independent; `one`(w, f).
template <class F>
Psd of_mirrors(Detector const& d, Hertz hz, F const& one) {
  Detector::Spots const w = d.spots();
  return calibrated(d, hz, [&](double f) { return 2 * (one(w.input, f) + one(w.end, f)); });
}

bool has_suspension(Detector const& d) { return d.suspension.has_value(); }
bool has_substrate(Detector const& d) { return d.substrate.has_value(); }
bool has_coating(Detector const& d) { return d.substrate && d.coating; }
bool has_ground(Detector const& d) { return d.ground && std::isfinite(d.ground->level); }

Psd seismic(Detector const& d, Hertz hz) {
  return calibrated(d, hz, [&](double f) {
    return 4 * seismic_transfer_squared(*d.suspension, f) * std::pow(platform_asd(d.ground->platform, f), 2);
  });
}

Psd newtonian(Detector const& d, Hertz hz) {
  return calibrated(d, hz, [&](double f) {
    double psd = 2 * rayleigh_newtonian_psd(*d.ground, f);
    if (std::isfinite(d.ground->p_level) && std::isfinite(d.ground->s_level))
      psd += 4 * body_wave_newtonian_psd(*d.ground, f);
    return d.air ? psd + 2 * infrasound_newtonian_psd(*d.air, f) : psd;
  });
}

Psd suspension_thermal(Detector const& d, Hertz hz) {
  return calibrated(d, hz, [&](double f) { return 4 * suspension_thermal_psd(*d.suspension, f); });
}

Psd suspension_horizontal(Detector const& d, Hertz hz) {
  return calibrated(d, hz,
                    [&](double f) { return 4 * chain_response(*d.suspension, Direction::horizontal, f).thermal_psd; });
}

Psd suspension_vertical(Detector const& d, Hertz hz) {
  return calibrated(d, hz, [&](double f) {
    return 4 * std::pow(d.suspension->vertical_coupling, 2) *
           chain_response(*d.suspension, Direction::vertical, f).thermal_psd;
  });
}

Psd coating_brownian(Detector const& d, Hertz hz) {
  CoatingStack const input = coating_stack(d, d.input), end = coating_stack(d, d.end);
  Detector::Spots const w = d.spots();
  // Everything but 1/f and the loss angles is the same at all frequencies, and these are cheap.
  return calibrated(d, hz, [&](double f) {
    return 2 * (coating_brownian_psd(input, w.input, f) + coating_brownian_psd(end, w.end, f));
  });
}

Psd coating_thermo_optic(Detector const& d, Hertz hz) {
  Detector::Spots const w = d.spots();
  CoatingThermoOptic const input(coating_stack(d, d.input), shape(d), w.input),
      end(coating_stack(d, d.end), shape(d), w.end);
  return calibrated(d, hz, [&](double f) { return 2 * (input.psd(f) + end.psd(f)); });
}

Psd substrate_brownian(Detector const& d, Hertz hz) {
  return of_mirrors(d, hz, [&](double w, double f) { return substrate_brownian_psd(*d.substrate, shape(d), w, f); });
}

Psd substrate_thermo_elastic(Detector const& d, Hertz hz) {
  return of_mirrors(d, hz,
                    [&](double w, double f) { return substrate_thermoelastic_psd(*d.substrate, shape(d), w, f); });
}

// Path through the input mirrors, over the gain 2F/pi of length changes in the arms.
Psd substrate_thermo_refractive(Detector const& d, Hertz hz) {
  double const gain = 4 / (d.input.transmission + 2 * d.mirror_loss), w = d.spots().input;
  return calibrated(d, hz, [&](double f) {
    return 2 * substrate_thermorefractive_psd(*d.substrate, d.mirror_thickness, w, f) / (gain * gain);
  });
}

double gas_temperature(Detector const& d) {
  return d.suspension ? d.suspension->stages.back().temperature : d.tube_temperature;
}

Psd residual_gas(Detector const& d, Hertz hz) {
  Psd psd;
  for (double const f : hz) {
    double sum = 0, moves = std::pow(d.mirror_mass * std::pow(2 * pi * f, 2), -2);
    if (d.suspension) moves = std::norm(chain_response(*d.suspension, Direction::horizontal, f).compliance);
    for (GasSpecies const& gas : d.gas)
      sum += 2 * gas_scattering_psd(d, gas, f) / (d.arm_length * d.arm_length) +
             4 * gas_damping_force_psd(d, gas, gas_temperature(d)) * moves * d.strain_per_length_squared(f);
    psd.push_back(sum);
  }
  return psd;
}

constexpr FundamentalNoise of_suspensions[] = {
    {"SuspensionHorizontal", "pendulums and violin modes of the fibres", "Suspension", has_suspension,
     suspension_horizontal},
    {"SuspensionVertical", "vertical modes, by the slope of the mirror to the vertical", "Suspension", has_suspension,
     suspension_vertical},
};

constexpr FundamentalNoise all[] = {
    {"Quantum", "quantum noise of the light", "", [](Detector const&) { return true; }, quantum_psd},
    {"Seismic", "ground motion through the suspensions", "Suspension and Seismic",
     [](Detector const& d) { return d.suspension && d.ground; }, seismic},
    {"Newtonian", "gravity of the moving ground and air", "Seismic", has_ground, newtonian},
    {"SuspensionThermal", "thermal noise of the suspensions", "Suspension", has_suspension, suspension_thermal,
     of_suspensions},
    {"CoatingBrownian", "Brownian noise of the coatings", "Materials.Substrate and Materials.Coating", has_coating,
     coating_brownian},
    {"CoatingThermoOptic", "thermo-optic noise of the coatings", "Materials.Substrate and Materials.Coating",
     has_coating, coating_thermo_optic},
    {"SubstrateBrownian", "Brownian noise of the mirror substrates", "Materials.Substrate", has_substrate,
     substrate_brownian},
    {"SubstrateThermoElastic", "thermo-elastic noise of the mirror substrates", "Materials.Substrate", has_substrate,
     substrate_thermo_elastic},
    {"SubstrateThermoRefractive", "thermo-refractive noise of the input mirrors", "Materials.Substrate.dndT",
     [](Detector const& d) { return d.substrate && std::isfinite(d.substrate->index_slope); },
     substrate_thermo_refractive},
    {"ResidualGas", "residual gas in the tubes and around the mirrors", "Infrastructure.ResidualGas",
     [](Detector const& d) { return !d.gas.empty(); }, residual_gas},
};

}  // namespace

std::span<FundamentalNoise const> fundamental_noises() { return all; }

namespace {

std::vector<double> psd_of(Detector const& d, DualRecycledParameters const& p, std::span<double const> hz) {
  DualRecycled const model(p);
  std::vector<double> psd;
  for (double const f : hz)
    psd.push_back(std::pow(model.quantum_noise(f) * d.arm_length, 2) * d.strain_per_length_squared(f));
  return psd;
}

}  // namespace

DualRecycledParameters dual_recycled(Detector const& d) {
  double const pendulum =
      d.suspension ? std::sqrt(standard_gravity / d.suspension->stages.back().length) / (2 * pi) : 0;
  return {.wavelength = d.wavelength,
          .arm_length = d.arm_length,
          .input_transmission = d.input.transmission,
          .end_transmission = d.end.transmission,
          .round_trip_loss = 2 * d.mirror_loss,
          .mirror_mass = d.mirror_mass,
          .arm_power = d.circulating_power(),
          .power_recycling_transmission = d.power_recycling,
          .signal_recycling_transmission = d.signal_recycling,
          .signal_recycling_tuning = -d.signal_detuning / 2,  // public budgets count a shorter cavity positive
          .beam_splitter_loss = d.splitter_loss,
          .signal_cavity_loss = d.signal_loss,
          .signal_recycling_length = d.signal_length,
          .homodyne_angle = pi - d.readout_angle,  // the other way round too
          .readout_loss = 1 - d.detection_efficiency,
          .squeezer = d.squeezer,
          .pendulum_frequency = pendulum};
}

std::vector<double> quantum_psd(Detector const& d, std::span<double const> hz) {
  return psd_of(d, dual_recycled(d), hz);
}
std::vector<double> shot_psd(Detector const& d, std::span<double const> hz) {
  DualRecycledParameters held = dual_recycled(d);
  held.mirror_mass = infinity;
  return psd_of(d, held, hz);
}

double quantum_limit(double length, double mass, double hz) {
  return std::sqrt(8 * hbar / mass) / (2 * pi * hz * length);
}

}  // namespace straytrace::noise
