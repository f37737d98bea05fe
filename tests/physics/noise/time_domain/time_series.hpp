// SPDX-License-Identifier: BSD-3-Clause
// Plain synthesis of periodic Gaussian motion and the spectrum of a field in bands: an independent reference.
#pragma once

#include <cmath>
#include <complex>
#include <functional>
#include <span>
#include <vector>

#include "base/every_module.hpp"
#include "base/math/rng.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace::testing {

// One realisation, sample by sample: a sum of sines with random amplitudes and phases on lines of 1/duration.
class RandomMotion {
 public:
  RandomMotion(Rng rng, double duration, std::size_t samples) : rng_(rng), duration_(duration), samples_(samples) {}
  double next(Spectrum const& s) {
    if (lines_.empty()) begin(s);
    double x = 0;
    for (auto& [value, turn] : lines_) {
      x += value.real();
      value *= turn;
    }
    return x;
  }

 private:
  void begin(Spectrum const& s) {
    for (double k = 1; (k - 0.5) / duration_ < s.highest(); ++k) {
      double const power = s.power((k - 0.5) / duration_, (k + 0.5) / duration_);
      double const size = std::sqrt(-2 * power * std::log(rng_.uniform())), phase = 2 * pi * rng_.uniform();
      lines_.emplace_back(std::polar(size, phase), std::polar(1.0, 2 * pi * k / double(samples_)));
    }
  }
  Rng rng_;
  double duration_;
  std::size_t samples_;
  std::vector<std::pair<std::complex<double>, std::complex<double>>> lines_;
};

// Mean one-sided PSD of the imaginary part of a field, common phase averaged, in bands of whole lines: half the power
// at +f and -f.
inline std::vector<double> band_powers(int realisations, double duration, std::size_t samples,
                                       std::span<double const> edges,
                                       std::function<std::complex<double>(RandomMotion&, RandomMotion&)> const& field) {
  std::vector<double> psd(edges.size() - 1);
  std::vector<std::complex<double>> s(samples);
  for (int r = 0; r < realisations; ++r) {
    RandomMotion a(Rng(31, std::uint64_t(r), 0, Stream::source), duration, samples),
        b(Rng(32, std::uint64_t(r), 0, Stream::source), duration, samples);
    for (auto& x : s) x = field(a, b);
    for (std::size_t band = 0; band < psd.size(); ++band) {
      double power = 0;
      auto const first = std::lround(edges[band] * duration), last = std::lround(edges[band + 1] * duration);
      for (long k = first; k < last; ++k) {
        std::complex<double> plus = 0, minus = 0, at = 1;
        std::complex<double> const turn = std::polar(1.0, -2 * pi * double(k) / double(samples));
        for (std::complex<double> const& x : s) {
          plus += x * at;
          minus += x * std::conj(at);
          at *= turn;
        }
        power += (std::norm(plus) + std::norm(minus)) / 2 / double(samples) / double(samples);
      }
      psd[band] += power / (edges[band + 1] - edges[band]) / realisations;
    }
  }
  return psd;
}

}  // namespace straytrace::testing
