// SPDX-License-Identifier: BSD-3-Clause
// Symmetric 2x2 matrices, real or complex: curvatures and sizes of beams in a plane.
#pragma once

#include <array>
#include <cmath>
#include <complex>

namespace straytrace {

// Eigenvalues, the one nearer to m11 first.
template <class T>
std::array<T, 2> eigenvalues(T m11, T m12, T m22) {
  using std::abs, std::sqrt;
  T const mean = 0.5 * (m11 + m22), half = 0.5 * (m11 - m22), root = sqrt(half * half + m12 * m12);
  T const one = mean + root, two = mean - root;
  return abs(one - m11) <= abs(two - m11) ? std::array{one, two} : std::array{two, one};
}

// Angle from the first axis to the direction of the larger eigenvalue of a real matrix, rad.
inline double larger_axis(double m11, double m12, double m22) { return 0.5 * std::atan2(2 * m12, m11 - m22); }

}  // namespace straytrace
