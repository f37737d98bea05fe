// SPDX-License-Identifier: BSD-3-Clause
#include "beams/expansion.hpp"

#include "beams/plane_field.hpp"

namespace straytrace {

ModeCoefficients::ModeCoefficients(int order)
    : order_(order), values_(static_cast<std::size_t>((order + 1) * (order + 2) / 2)) {}

double ModeCoefficients::power() const {
  double sum = 0;
  for (auto c : values_) sum += std::norm(c);
  return sum;
}

GeneratingGaussian generating_gaussian(Mode const& beam, Mode const& basis) {
  Plane const plane{basis.origin, basis.e1, basis.e2};
  FieldProduct const p = product(on_plane(beam, plane), on_plane(basis, plane));
  // sum of u_ab s^a t^b / sqrt(a! b!) = u_00 exp(2 (x s/w1 + y t/w2) - (s^2 + t^2)/2): one more Gaussian integral.
  double const scale = basis.wavelength / pi;
  Eigen::Vector2cd const per_w{std::sqrt(basis.q11.imag() / scale), std::sqrt(basis.q22.imag() / scale)};
  Eigen::Matrix2cd const width = p.s.inverse();
  std::complex<double> const i{0, 1};
  GeneratingGaussian series;
  series.middle = std::exp(p.log_integral());
  series.bend = (4.0 * i / p.k) * per_w.asDiagonal() * width * per_w.asDiagonal();
  series.bend -= Eigen::Matrix2cd::Identity();
  series.tilt = -2.0 * per_w.cwiseProduct(width * p.g);
  return series;
}

ModeCoefficients coefficients(GeneratingGaussian const& series, int order) {
  ModeCoefficients c(order);
  c(0, 0) = series.middle;
  auto const& r = series.bend;
  for (int total = 1; total <= order; ++total)
    for (int b = 0; b <= total; ++b) {
      // One step down along the longer index, by the derivative of the generating function along it.
      int const a = total - b;
      bool const along_a = a >= b;
      int const n = along_a ? a - 1 : b - 1, m = along_a ? b : a;
      int const one = along_a ? 0 : 1, two = 1 - one;
      auto const at = [&](int i, int j) { return along_a ? c(i, j) : c(j, i); };
      std::complex<double> sum = series.tilt(one) * at(n, m);
      if (n > 0) sum += r(one, one) * std::sqrt(double(n)) * at(n - 1, m);
      if (m > 0) sum += r(one, two) * std::sqrt(double(m)) * at(n, m - 1);
      c(a, b) = sum / std::sqrt(n + 1.0);
    }
  return c;
}

}  // namespace straytrace
