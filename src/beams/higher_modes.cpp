// SPDX-License-Identifier: BSD-3-Clause
#include "beams/higher_modes.hpp"

#include "base/errors.hpp"
#include "beams/overlap.hpp"

namespace straytrace::beams {

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

ModeCoefficients::ModeCoefficients(int order)
    : order_(order), values_(static_cast<std::size_t>((order + 1) * (order + 2) / 2)) {}

double ModeCoefficients::power() const {
  double sum = 0;
  for (auto c : values_) sum += std::norm(c);
  return sum;
}

namespace {

// sum over a, b of c(a, b) s^a t^b / sqrt(a! b!) = c(0, 0) exp((s, t).bend (s, t)/2 + tilt.(s, t)).
struct GeneratingGaussian {
  std::complex<double> middle;  // c(0, 0)
  Eigen::Matrix2cd bend;
  Eigen::Vector2cd tilt;
};
// Overlap of `beam` with the Hermite-Gauss modes of `basis`, whose principal axes must be e1 and e2.
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

}  // namespace

ModeCoefficients hermite_coefficients(Mode const& beam, Mode const& basis, int order) {
  refuse_turned(basis);
  return coefficients(generating_gaussian(beam, basis), order);
}

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

namespace {

// One quantum more along x (`y` false) or along y, in terms of those that turn with +phi and -phi: amplitudes of
// 0, 1, ... quanta turning with +phi. `quanta`: those along this axis afterwards.
std::vector<std::complex<double>> raised(std::vector<std::complex<double>> const& state, bool y, int quanta) {
  std::complex<double> const forward = y ? std::complex<double>{0, -1} : 1, backward = std::conj(forward);
  auto const total = state.size();
  std::vector<std::complex<double>> next(total + 1);
  for (std::size_t a = 0; a <= total; ++a) {
    if (a > 0) next[a] += forward * std::sqrt(double(a)) * state[a - 1];
    if (a < total) next[a] += backward * std::sqrt(double(total - a)) * state[a];
    next[a] /= std::sqrt(2.0 * quanta);
  }
  return next;
}

}  // namespace

LaguerreCoefficients::LaguerreCoefficients(ModeCoefficients const& hermite) : circular_(hermite.order()) {
  std::vector<std::complex<double>> along_x{1};
  for (int n = 0; n <= hermite.order(); ++n) {
    std::vector<std::complex<double>> state = along_x;
    for (int m = 0; n + m <= hermite.order(); ++m) {
      for (int a = 0; a <= n + m; ++a) circular_(a, n + m - a) += hermite(n, m) * state[std::size_t(a)];
      state = raised(state, true, m + 1);
    }
    along_x = raised(along_x, false, n + 1);
  }
}

}  // namespace straytrace::beams
