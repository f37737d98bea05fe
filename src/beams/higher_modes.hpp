// SPDX-License-Identifier: BSD-3-Clause
// Hermite-Gauss modes about a beam with two principal axes (R2.11).
#pragma once

#include <Eigen/Core>

#include <complex>
#include <vector>

#include "beams/mode.hpp"

namespace straytrace::beams {

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

// exp(-x^2/2) H_n(x) / sqrt(2^n n! sqrt(pi)): the integral of the product of two is 1 for equal orders, else 0.
double hermite_function(int n, double x);

// Amplitudes of a Gaussian beam in the modes of `basis`, of order n along e1 and m along e2, n + m <= order; (0, 0) is
// their overlap. The beam may be tilted, shifted and mismatched in any way. The rest of the power is in higher orders.
// NumericalError unless q12 = 0 for `basis`.
ModeCoefficients hermite_coefficients(Mode const& beam, Mode const& basis, int order);

// Laguerre-Gauss modes about a circular beam (R2.11).

// sqrt(p!/(p + l)!) x^(l/2) exp(-x/2) L_p^l(x), l >= 0: the integral over x > 0 of the product of two of one l is 1 for
// equal p, else 0.
double laguerre_function(int p, int l, double x);

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

}  // namespace straytrace::beams
