// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/modes/mode_coupling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "beams/higher_modes.hpp"

namespace straytrace::ifo {

namespace {

double radius(std::complex<double> q, double k) {
  if (!(q.imag() > 0))
    throw NumericalError(fmt::format(
        "a beam of complex curvature {:.9g} + {:.9g} i 1/m has no radius: the imaginary part must be above zero",
        q.real(), q.imag()));
  return std::sqrt(2 / (k * q.imag()));
}

// Calls with the orders and the index of every mode.
template <class Use>
void each_mode(int order, Use const& use) {
  for (int sum = 0; sum <= order; ++sum)
    for (int m = 0; m <= sum; ++m) use(sum - m, m, mode_index(sum - m, m));
}

std::vector<double> hermite_functions(int order, double x) {
  std::vector<double> h(std::size_t(order) + 1);
  for (int n = 0; n <= order; ++n) h[n] = beams::hermite_function(n, x);
  return h;
}

// Integrals of the products h_n h_m from `from` to `to`. Those of unequal orders are Wronskians, as both functions
// solve h'' = (x^2 - 2n - 1) h; those of equal orders follow by the ladder from the error function.
Eigen::MatrixXd incomplete_products(int order, double from, double to) {
  auto const a = hermite_functions(order, from), b = hermite_functions(order, to);
  auto const step = [&](int n, int m) { return b[n] * b[m] - a[n] * a[m]; };
  Eigen::MatrixXd products(order + 1, order + 1);
  products(0, 0) = 0.5 * (std::erf(to) - std::erf(from));
  for (int n = 1; n <= order; ++n) {
    products(n, n) = products(n - 1, n - 1) - step(n, n - 1) / std::sqrt(2.0 * n);
    for (int m = 0; m < n; ++m) {
      double const lower = m > 0 ? std::sqrt(2.0 * m) * step(n, m - 1) : 0;
      products(n, m) = products(m, n) = (std::sqrt(2.0 * n) * step(n - 1, m) - lower) / (2.0 * (m - n));
    }
  }
  return products;
}

}  // namespace

Eigen::MatrixXcd axis_coupling(AxisCoupling const& axis, double k, int order) {
  double const w1 = radius(axis.in, k), w2 = radius(axis.out, k), d = axis.shift;
  std::complex<double> const i{0, 1};
  std::complex<double> const p = -0.5 * i * k * (axis.in - std::conj(axis.out));
  std::complex<double> const j = i * (axis.kick - k * axis.in * d);
  std::complex<double> const a = 2.0 / (p * w2 * w2) - 1.0, b = 2.0 / (p * w1 * w2), c = 2.0 / (p * w1 * w1) - 1.0;
  std::complex<double> const out = j / (p * w2), in = j / (p * w1) - 2 * d / w1;  // D and F

  Eigen::MatrixXcd coupling(order + 1, order + 1);
  coupling(0, 0) = std::sqrt(2.0 / (w1 * w2 * p)) * std::exp(j * j / (4.0 * p) + 0.5 * i * k * axis.in * d * d);
  for (int m = 1; m <= order; ++m) {
    std::complex<double> next = in * coupling(0, m - 1);
    if (m > 1) next += c * std::sqrt(m - 1.0) * coupling(0, m - 2);
    coupling(0, m) = next / std::sqrt(double(m));
  }
  for (int n = 0; n < order; ++n)
    for (int m = 0; m <= order; ++m) {
      std::complex<double> next = out * coupling(n, m);
      if (n > 0) next += a * std::sqrt(double(n)) * coupling(n - 1, m);
      if (m > 0) next += b * std::sqrt(double(m)) * coupling(n, m - 1);
      coupling(n + 1, m) = next / std::sqrt(n + 1.0);
    }
  return coupling;
}

Eigen::MatrixXcd mode_coupling(AxisCoupling const& x, AxisCoupling const& y, double k, int order) {
  Eigen::MatrixXcd const along = axis_coupling(x, k, order), across = axis_coupling(y, k, order);
  Eigen::MatrixXcd coupling(mode_count(order), mode_count(order));
  each_mode(order, [&](int n, int m, int row) {
    each_mode(order, [&](int n1, int m1, int column) { coupling(row, column) = along(n, n1) * across(m, m1); });
  });
  return coupling;
}

namespace {

// Half width, in units of w/sqrt(2), beyond which the modes up to an order hold less than rounding: some distance past
// the turning point of the highest Hermite function.
double extent_of_modes(int order) { return std::sqrt(2.0 * order + 1) + 8; }

struct Angles {
  double low, high;
  bool empty() const { return !(high > low); }
};

// Where the heights offset + radius sin(angle) lie within `most` of the axis.
Angles angles_with_light(double radius, double offset, double most) {
  auto const angle = [&](double height) { return std::asin(std::clamp((height - offset) / radius, -1.0, 1.0)); };
  return {angle(-most), angle(most)};
}

}  // namespace

Eigen::MatrixXd stop_coupling(CircularStop const& stop, std::array<double, 2> w, int order) {
  double const sx = std::sqrt(2.0) / w[0], sy = std::sqrt(2.0) / w[1], far = extent_of_modes(order);
  double const reach_x = std::fabs(stop.offset[0]) + far / sx, reach_y = std::fabs(stop.offset[1]) + far / sy;
  Eigen::MatrixXd passed = Eigen::MatrixXd::Zero(mode_count(order), mode_count(order));
  if (std::hypot(reach_x, reach_y) <= stop.radius) return passed.setIdentity();
  Angles const lit = angles_with_light(stop.radius, stop.offset[1], far / sy);
  if (lit.empty()) return passed;
  // With y = radius sin(angle) the integrand is analytic and of period pi, and it vanishes at the other ends: the
  // midpoint rule converges exponentially.
  double const range = lit.high - lit.low;
  int const points = 64 + 8 * order + int(16 * range / pi * stop.radius * std::max(sx, sy));
  for (int point = 0; point < points; ++point) {
    double const angle = lit.low + range * (point + 0.5) / points, half = stop.radius * std::cos(angle);
    auto const across = hermite_functions(order, sy * (stop.offset[1] + stop.radius * std::sin(angle)));
    Eigen::MatrixXd const along =
        incomplete_products(order, sx * (stop.offset[0] - half), sx * (stop.offset[0] + half));
    double const weight = range / points * sy * half;
    each_mode(order, [&](int n, int m, int row) {
      each_mode(order, [&](int n1, int m1, int column) {
        passed(row, column) += weight * across[m] * across[m1] * along(n, n1);
      });
    });
  }
  return passed;
}

}  // namespace straytrace::ifo
