// SPDX-License-Identifier: BSD-3-Clause
// Synthetic records of moving scatterers in detector-like noise.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "analysis/fringes/fringe_fit.hpp"
#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "base/math/rng.hpp"

namespace straytrace::testing {

inline std::vector<double> normal_numbers(std::uint64_t seed, std::size_t n) {
  std::vector<double> x;
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(seed, i, 0, Stream::source);
    double const r = std::sqrt(-2 * std::log(rng.uniform()));
    x.push_back(r * std::cos(2 * pi * rng.uniform()));
  }
  return x;
}

// ASD `floor` at high frequency, rising as 1/f below `corner`: white noise and its running sum.
inline std::vector<double> detector_noise(std::uint64_t seed, std::size_t n, double rate, double floor, double corner) {
  std::vector<double> x = normal_numbers(seed, n), slow = normal_numbers(seed + 1000000, n);
  double const white = floor * std::sqrt(rate / 2);
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    sum = 0.999 * sum + slow[i];
    x[i] = white * (x[i] + sum * 2 * pi * corner / rate);
  }
  return x;
}

struct Sine {
  double metres, hz, phase = 0;
};

inline TimeSeries sine_motion(std::vector<Sine> const& sines, double rate, double seconds, double start = 1e9) {
  TimeSeries x{"x", "m", start, rate, {}};
  for (std::size_t i = 0; i < std::size_t(rate * seconds); ++i) {
    double sum = 0;
    for (Sine const& s : sines) sum += s.metres * std::sin(2 * pi * s.hz * double(i) / rate + s.phase);
    x.samples.push_back(sum);
  }
  return x;
}

// G sin(phi + W 4 pi u(t - delay)/lambda + drift t), u of the same sines; t from the start.
inline void add_fringes(TimeSeries& h, std::vector<Sine> const& sines, double gain, double phase, double multiplicity,
                        double delay = 0, double drift = 0, double wavelength = 1064e-9) {
  for (std::size_t i = 0; i < h.samples.size(); ++i) {
    double const t = double(i) / h.rate;
    double u = 0;
    for (Sine const& s : sines) u += s.metres * std::sin(2 * pi * s.hz * (t - delay) + s.phase);
    h.samples[i] += gain * std::sin(phase + 4 * pi * multiplicity * u / wavelength + drift * t);
  }
}

}  // namespace straytrace::testing
