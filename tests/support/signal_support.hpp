// SPDX-License-Identifier: BSD-3-Clause
// Synthetic channels with known truth.
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <string>
#include <vector>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "base/math/rng.hpp"
#include "spectra/series.hpp"

namespace straytrace::testing {

// Gaussian white noise; each seed is another channel.
inline std::vector<double> white_noise(std::size_t count, std::uint64_t seed, double sigma = 1) {
  Rng rng(seed, 0, 0, Stream::source);
  std::vector<double> x(count);
  for (double& v : x) v = sigma * std::sqrt(-2 * std::log(1 - rng.uniform())) * std::cos(2 * pi * rng.uniform());
  return x;
}

inline TimeSeries series_with(std::vector<double> samples, double rate, std::string unit = "m", double start = 1e9) {
  return {"X1:TEST", std::move(unit), start, rate, std::move(samples)};
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

// Second-order low pass driven by x: y'' + (w/Q) y' + w^2 y = x, by exact steps of the bilinear transform with its
// frequencies warped to the resonance.
struct Oscillator {
  double hz, quality, rate;

  // Response at z = exp(2 pi i f/rate), phases of instruments.
  std::complex<double> response(double f) const {
    double const k = constant(), w = 2 * pi * hz;
    std::complex<double> const z = std::polar(1.0, 2 * pi * f / rate), s = k * (z - 1.0) / (z + 1.0);
    return 1.0 / (s * s + w / quality * s + w * w);
  }
  std::vector<double> driven(std::vector<double> const& x) const {
    double const k = constant(), w = 2 * pi * hz, a0 = k * k + w / quality * k + w * w;
    double const a1 = (2 * w * w - 2 * k * k) / a0, a2 = (k * k - w / quality * k + w * w) / a0;
    std::vector<double> y(x.size(), 0.0);
    for (std::size_t i = 2; i < x.size(); ++i)
      y[i] = (x[i] + 2 * x[i - 1] + x[i - 2]) / a0 - a1 * y[i - 1] - a2 * y[i - 2];
    return y;
  }

 private:
  double constant() const { return 2 * pi * hz / std::tan(pi * hz / rate); }
};

}  // namespace straytrace::testing
