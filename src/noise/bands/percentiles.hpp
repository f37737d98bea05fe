// SPDX-License-Identifier: BSD-3-Clause
// Percentiles of sums of squares of Gaussian variables and of phasors, by a fixed low-discrepancy set of draws.
#pragma once

#include <array>
#include <complex>
#include <span>
#include <vector>

namespace straytrace {

// |g + p|^2 of a real vector: g Gaussian, p the sum of phasors whose phases are unknown.
struct RandomVector {
  std::vector<std::vector<double>> gaussian;  // columns; g = sum over columns of column times a standard normal
  // p = sum of first * cos(phase) + second * sin(phase)
  std::vector<std::pair<std::vector<double>, std::vector<double>>> phasors;
};

class Draws {
 public:
  Draws();
  // 5th, 50th and 95th percentile of the sum of `copies` independent |g + p|^2. Directions beyond `most` count with
  // their mean.
  std::array<double, 3> percentiles(RandomVector const&, int copies) const;
  // The same for sum of weight times chi-square of one degree of freedom.
  std::array<double, 3> percentiles(std::vector<double> weights, int copies) const;

  static constexpr int count = 16384, most = 24;

 private:
  std::array<double, 3> read_off(std::vector<double>& values) const;
  std::vector<std::vector<double>> normal_, squared_, turn_;  // by direction and draw
};

}  // namespace straytrace
