// SPDX-License-Identifier: BSD-3-Clause
#include "beams/laguerre.hpp"

#include "base/message.hpp"

namespace straytrace {

namespace {

void refuse_elliptic(Mode const& basis) {
  if (std::abs(basis.q12) + std::abs(basis.q11 - basis.q22) > 1e-9 * basis.q11.imag())
    throw NumericalError("Laguerre-Gauss modes need a circular beam; this one is astigmatic");
}

}  // namespace

double laguerre_function(int p, int l, double x) {
  double before = 0, value = std::exp(-0.5 * x);
  for (int i = 1; i <= l; ++i) value *= std::sqrt(x / i);
  for (int i = 0; i < p; ++i) {
    double const up = std::sqrt((i + 1.0) * (i + 1 + l)), down = std::sqrt(double(i) * (i + l));
    double const next = ((2 * i + 1 + l - x) * value - down * before) / up;
    before = value;
    value = next;
  }
  return value;
}

std::complex<double> laguerre_field(Mode const& basis, int p, int l, Vec3 point) {
  refuse_elliptic(basis);
  double const z = dot(point - basis.origin, basis.travel), k = basis.wave_number();
  Mode const here = propagated(basis, z);
  Vec3 const r = point - here.origin;
  double const x = dot(r, basis.e1), y = dot(r, basis.e2), rho2 = x * x + y * y, scale = k * here.q11.imag();  // 2/w^2
  double const size = std::sqrt(scale / pi) * laguerre_function(p, std::abs(l), scale * rho2);
  double const lag = (2 * p + std::abs(l) + 1) * gouy(basis, z), bend = 0.5 * k * here.q11.real() * rho2;
  return std::polar(1.0, k * z + bend - lag + l * std::atan2(y, x)) * size;
}

LaguerreCoefficients laguerre_coefficients(Mode const& beam, Mode const& basis, int order) {
  refuse_elliptic(basis);
  GeneratingGaussian series = generating_gaussian(beam, basis);
  // Quanta along x and y in terms of those that turn with +phi and -phi.
  std::complex<double> const i{0, 1};
  Eigen::Matrix2cd turn;
  turn << 1, 1, -i, i;
  turn /= std::sqrt(2.0);
  series.bend = (turn.transpose() * series.bend * turn).eval();
  series.tilt = (turn.transpose() * series.tilt).eval();
  return LaguerreCoefficients(coefficients(series, order));
}

}  // namespace straytrace
