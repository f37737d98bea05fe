// SPDX-License-Identifier: BSD-3-Clause
#include "noise/fundamental/detector.hpp"

#include <cmath>
#include <complex>

#include "beams/cavity_mode.hpp"
#include "ifo/cavity.hpp"

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

}  // namespace straytrace::noise
