// SPDX-License-Identifier: BSD-3-Clause
// Synthetic channels with known truth.
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <string>
#include <vector>

#include "base/constants.hpp"
#include "base/rng.hpp"
#include "signal/series.hpp"

namespace straytrace::testing {

// Gaussian white noise of unit variance; each seed is another channel.
inline std::vector<double> white_noise(std::size_t count, std::uint64_t seed, double rms = 1) {
  Rng rng(seed, 0, 0, Stream::source);
  std::vector<double> x(count);
  for (double& v : x) v = rms * std::sqrt(-2 * std::log(rng.uniform())) * std::cos(2 * pi * rng.uniform());
  return x;
}

inline std::vector<double> operator+(std::vector<double> a, std::vector<double> const& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}
inline std::vector<double> operator*(double factor, std::vector<double> a) {
  for (double& v : a) v *= factor;
  return a;
}

inline TimeSeries channel(std::string name, std::string unit, double rate, std::vector<double> samples,
                          double start = 1e9) {
  return {std::move(name), std::move(unit), start, rate, std::move(samples)};
}

// Share of values within one standard error of the truth.
struct Coverage {
  int inside = 0, all = 0;
  void add(double value, double sigma, double truth) {
    inside += std::fabs(value - truth) <= sigma;
    ++all;
  }
  double share() const { return double(inside) / all; }
};

}  // namespace straytrace::testing
