// SPDX-License-Identifier: BSD-3-Clause
#include "noise/fundamental/quantum.hpp"

#include <cmath>

#include "noise/fundamental/suspension.hpp"

namespace straytrace::noise {
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
