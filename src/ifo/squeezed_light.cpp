// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/squeezed_light.hpp"

#include <cmath>
#include <complex>

namespace straytrace {
namespace {

using Phasor = std::complex<double>;

QuadratureCovariance rotation(double angle) {
  QuadratureCovariance m;
  m << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return m;
}

// What acts on both sidebands, the lower one conjugated, as it acts on the quadratures.
Eigen::Matrix2cd in_quadratures(Phasor upper, Phasor lower) {
  Phasor const i{0, 1};
  Phasor const sum = (upper + lower) / 2.0, difference = i * (upper - lower) / 2.0;
  Eigen::Matrix2cd m;
  m << sum, difference, -difference, sum;
  return m;
}

// Reflected light, and the vacuum that the end mirror and the losses let in.
QuadratureCovariance after(FilterCavity const& c, double hz, QuadratureCovariance const& before) {
  double const r1 = std::sqrt(1 - c.input_transmission), r2 = std::sqrt(1 - c.end_transmission),
               round = r1 * r2 * std::sqrt(1 - c.loss);
  struct Answer {
    Phasor reflected, from_end, from_loss;
  };
  auto const answer = [&](double sideband) {
    double const phase = 4 * pi * (sideband - c.detuning) * c.length / speed_of_light;
    Phasor const turn = std::polar(1.0, phase), gain = 1.0 / (1.0 - round * turn), half = std::polar(1.0, phase / 2);
    return Answer{r1 - r2 * c.input_transmission * turn * gain,
                  std::sqrt(c.input_transmission * c.end_transmission) * half * gain,
                  std::sqrt(c.input_transmission * c.loss) * half * gain};
  };
  Answer const u = answer(hz), l = answer(-hz);
  Eigen::Matrix2cd const f = in_quadratures(u.reflected, std::conj(l.reflected)),
                         e = in_quadratures(u.from_end, std::conj(l.from_end)),
                         s = in_quadratures(u.from_loss, std::conj(l.from_loss)), turned = rotation(c.rotation);
  return turned * (f * before * f.adjoint() + e * e.adjoint() + s * s.adjoint()) * turned.adjoint();
}

}  // namespace

QuadratureCovariance squeezed_vacuum(double least, double most, double angle) {
  Eigen::Vector2cd const powers(least, most);
  return rotation(angle) * powers.asDiagonal() * rotation(angle).adjoint();
}

QuadratureCovariance Squeezer::covariance(double hz) const {
  double const decibel = std::log(10) / 10, anti = std::isfinite(anti_decibels) ? anti_decibels : decibels,
               least = std::exp(-decibel * decibels), most = std::exp(decibel * anti),
               steady = std::pow(std::cos(phase_noise), 2);
  QuadratureCovariance v =
      steady * squeezed_vacuum(least, most, angle) + (1 - steady) * squeezed_vacuum(least, most, angle + pi / 2);
  v = (1 - loss) * v + loss * QuadratureCovariance::Identity();
  for (FilterCavity const& c : cavities) v = after(c, hz, v);
  return v;
}

}  // namespace straytrace
