// SPDX-License-Identifier: BSD-3-Clause
// Hermite-Gauss modes about a beam with two principal axes (R2.11).
#pragma once

#include <Eigen/Core>

#include <complex>
#include <vector>

#include "beams/mode.hpp"

namespace straytrace::beams {

// A Gaussian beam as a sum over the higher modes of another one (R2.11).

// Amplitudes c(a, b) for a + b <= order. With the powers of all orders they sum to 1.
class ModeCoefficients {
 public:
  explicit ModeCoefficients(int order);
  int order() const { return order_; }
  std::complex<double>& operator()(int a, int b) { return values_[index(a, b)]; }
  std::complex<double> operator()(int a, int b) const { return values_[index(a, b)]; }
  double power() const;  // sum of |c|^2

 private:
  static std::size_t index(int a, int b) { return static_cast<std::size_t>((a + b) * (a + b + 1) / 2 + b); }
  int order_;
  std::vector<std::complex<double>> values_;
};

// sum over a, b of c(a, b) s^a t^b / sqrt(a! b!) = c(0, 0) exp((s, t).bend (s, t)/2 + tilt.(s, t)).
struct GeneratingGaussian {
  std::complex<double> middle;  // c(0, 0)
  Eigen::Matrix2cd bend;
  Eigen::Vector2cd tilt;
};
// Overlap of `beam` with the Hermite-Gauss modes of `basis`, whose principal axes must be e1 and e2.
GeneratingGaussian generating_gaussian(Mode const& beam, Mode const& basis);
ModeCoefficients coefficients(GeneratingGaussian const&, int order);

// exp(-x^2/2) H_n(x) / sqrt(2^n n! sqrt(pi)): the integral of the product of two is 1 for equal orders, else 0.
double hermite_function(int n, double x);

// u_nm [1/m] at a point of space, of order n along e1 and m along e2 of the fundamental mode `basis`, for which q12 = 0
// (NumericalError otherwise). The phase lags by (n + 1/2) and (m + 1/2) times the Gouy phases of the axes.
std::complex<double> hermite_field(Mode const& basis, int n, int m, Vec3 p);

// Amplitudes of a Gaussian beam in these modes, n + m <= order; (0, 0) is their overlap. The beam may be tilted,
// shifted and mismatched in any way. The rest of the power is in higher orders.
ModeCoefficients hermite_coefficients(Mode const& beam, Mode const& basis, int order);

// Laguerre-Gauss modes about a circular beam (R2.11).

// sqrt(p!/(p + l)!) x^(l/2) exp(-x/2) L_p^l(x), l >= 0: the integral over x > 0 of the product of two of one l is 1 for
// equal p, else 0.
double laguerre_function(int p, int l, double x);

// u_pl [1/m] at a point of space: 2p + |l| is the order, exp(i l phi) with phi from e1 towards e2. `basis` is circular
// (NumericalError otherwise). The phase lags by 2p + |l| + 1 times the Gouy phase.
std::complex<double> laguerre_field(Mode const& basis, int p, int l, Vec3 point);

// Amplitudes in these modes.
class LaguerreCoefficients {
 public:
  // Of a field with these amplitudes in the Hermite-Gauss modes of the same circular beam: modes of one order are sums
  // of each other.
  explicit LaguerreCoefficients(ModeCoefficients const& hermite);
  std::complex<double> operator()(int p, int l) const {
    // A mode is one of p + max(l, 0) quanta turning one way and p + max(-l, 0) the other, times (-1)^p.
    std::complex<double> const c = l >= 0 ? circular_(p + l, p) : circular_(p, p - l);
    return p % 2 ? -c : c;
  }
  double power() const { return circular_.power(); }  // sum of |c|^2 over 2p + |l| <= order

 private:
  ModeCoefficients circular_;
};
// Of a Gaussian beam.
LaguerreCoefficients laguerre_coefficients(Mode const& beam, Mode const& basis, int order);

}  // namespace straytrace::beams
