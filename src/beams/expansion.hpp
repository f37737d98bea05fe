// SPDX-License-Identifier: BSD-3-Clause
// A Gaussian beam as a sum over the higher modes of another one (requirements.md R2.11).
#pragma once

#include <Eigen/Core>

#include <complex>
#include <vector>

#include "beams/mode.hpp"

namespace straytrace {

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

}  // namespace straytrace
