// SPDX-License-Identifier: BSD-3-Clause
// Laguerre-Gauss modes about a circular beam (requirements.md R2.11).
#pragma once

#include "beams/expansion.hpp"

namespace straytrace {

// sqrt(p!/(p + l)!) x^(l/2) exp(-x/2) L_p^l(x), l >= 0: the integral over x > 0 of the product of two of one l is 1 for
// equal p, else 0.
double laguerre_function(int p, int l, double x);

// u_pl [1/m] at a point of space: 2p + |l| is the order, exp(i l phi) with phi from e1 towards e2. `basis` is circular
// (NumericalError otherwise). The phase lags by 2p + |l| + 1 times the Gouy phase.
std::complex<double> laguerre_field(Mode const& basis, int p, int l, Vec3 point);

// Amplitudes of a Gaussian beam in these modes.
class LaguerreCoefficients {
 public:
  explicit LaguerreCoefficients(ModeCoefficients circular) : circular_(std::move(circular)) {}
  std::complex<double> operator()(int p, int l) const {
    // A mode is one of p + max(l, 0) quanta turning one way and p + max(-l, 0) the other, times (-1)^p.
    std::complex<double> const c = l >= 0 ? circular_(p + l, p) : circular_(p, p - l);
    return p % 2 ? -c : c;
  }
  double power() const { return circular_.power(); }  // sum of |c|^2 over 2p + |l| <= order

 private:
  ModeCoefficients circular_;
};
LaguerreCoefficients laguerre_coefficients(Mode const& beam, Mode const& basis, int order);

}  // namespace straytrace
