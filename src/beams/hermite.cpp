// SPDX-License-Identifier: BSD-3-Clause
#include "beams/hermite.hpp"

#include "base/message.hpp"

namespace straytrace {

namespace {

void refuse_turned(Mode const& basis) {
  if (std::abs(basis.q12) > 1e-9 * std::sqrt(basis.q11.imag() * basis.q22.imag()))
    throw NumericalError(
        "Hermite-Gauss modes need a beam whose principal axes are those of its frame (q12 = 0); this one is turned or "
        "twisted");
}

}  // namespace

double hermite_function(int n, double x) {
  double before = 0, value = std::exp(-0.5 * x * x) / std::sqrt(std::sqrt(pi));
  for (int i = 0; i < n; ++i) {
    double const next = std::sqrt(2.0 / (i + 1)) * x * value - std::sqrt(double(i) / (i + 1)) * before;
    before = value;
    value = next;
  }
  return value;
}

std::complex<double> hermite_field(Mode const& basis, int n, int m, Vec3 p) {
  refuse_turned(basis);
  double const z = dot(p - basis.origin, basis.travel), k = basis.wave_number();
  Mode const here = propagated(basis, z);
  auto const lag = axis_gouy(basis, z);
  Vec3 const r = p - here.origin;
  double const x = dot(r, basis.e1), y = dot(r, basis.e2);
  double const sx = std::sqrt(k * here.q11.imag()), sy = std::sqrt(k * here.q22.imag());  // sqrt(2)/w
  double const size = std::sqrt(sx * sy) * hermite_function(n, sx * x) * hermite_function(m, sy * y);
  double const bend = 0.5 * k * (here.q11.real() * x * x + here.q22.real() * y * y);
  return std::polar(1.0, k * z + bend - (n + 0.5) * lag[0] - (m + 0.5) * lag[1]) * size;
}

ModeCoefficients hermite_coefficients(Mode const& beam, Mode const& basis, int order) {
  refuse_turned(basis);
  return coefficients(generating_gaussian(beam, basis), order);
}

}  // namespace straytrace
