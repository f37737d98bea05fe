// SPDX-License-Identifier: BSD-3-Clause
// Hermite-Gauss modes about a beam with two principal axes (requirements.md R2.11).
#pragma once

#include "beams/expansion.hpp"

namespace straytrace {

// exp(-x^2/2) H_n(x) / sqrt(2^n n! sqrt(pi)): the integral of the product of two is 1 for equal orders, else 0.
double hermite_function(int n, double x);

// u_nm [1/m] at a point of space, of order n along e1 and m along e2 of the fundamental mode `basis`, for which q12 = 0
// (NumericalError otherwise). The phase lags by (n + 1/2) and (m + 1/2) times the Gouy phases of the axes.
std::complex<double> hermite_field(Mode const& basis, int n, int m, Vec3 p);

// Amplitudes of a Gaussian beam in these modes, n + m <= order; (0, 0) is their overlap. The beam may be tilted,
// shifted and mismatched in any way. What they lack of 1 in power is in higher orders.
ModeCoefficients hermite_coefficients(Mode const& beam, Mode const& basis, int order);

}  // namespace straytrace
