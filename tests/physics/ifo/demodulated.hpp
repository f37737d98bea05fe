// SPDX-License-Identifier: BSD-3-Clause
// Demodulated light, the error signal of a lock (docs/theory/interferometer.md, eq. 6.10).
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "ifo/network.hpp"

namespace straytrace::testing {

// In W. Light by carriers: sqrt(W) and Hz.
inline double demodulated(std::span<double const> carriers, std::span<Phasor const> light, double hz, double phase) {
  double sum = 0;
  for (std::size_t n = 0; n < carriers.size(); ++n)
    for (std::size_t m = 0; m < carriers.size(); ++m)
      if (std::fabs(carriers[m] - carriers[n] - hz) < 1e-3)
        sum += std::real(light[m] * std::conj(light[n]) * std::polar(1.0, phase));
  return sum;
}
inline double demodulated(SteadyField const& field, std::uint32_t port, double hz, double phase) {
  std::vector<Phasor> light;
  for (std::size_t n = 0; n < field.carriers().size(); ++n) light.push_back(field.in(port, n));
  return demodulated(field.carriers(), light, hz, phase);
}
// The same of a sampled power, W, at a constant rate, Hz: mean of P cos(2 pi hz t + phase) over whole periods.
inline double demodulated(std::span<double const> power, double rate, double hz, double phase) {
  double sum = 0;
  for (std::size_t i = 0; i < power.size(); ++i) sum += power[i] * std::cos(2 * pi * hz * double(i) / rate + phase);
  return sum / double(power.size());
}

}  // namespace straytrace::testing
