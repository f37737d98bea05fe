// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/fourier.hpp"

#include <unsupported/Eigen/FFT>

namespace straytrace {

struct Fourier::Engine {
  Eigen::FFT<double> fft;
};

Fourier::Fourier() : engine_(std::make_unique<Engine>()) { engine_->fft.SetFlag(Eigen::FFT<double>::HalfSpectrum); }
Fourier::~Fourier() = default;

Complexes const& Fourier::forward(std::vector<double> const& samples) {
  engine_->fft.fwd(lines_, samples);
  return lines_;
}

std::vector<double> Fourier::inverse(Complexes const& lines, std::size_t count) {
  std::vector<double> samples;
  engine_->fft.inv(samples, lines, Eigen::Index(count));
  return samples;
}

std::size_t good_length(std::size_t n) {
  for (std::size_t m = n < 2 ? 2 : n + n % 2;; m += 2) {
    std::size_t rest = m;
    for (std::size_t const p : {2, 3, 5})
      while (rest % p == 0) rest /= p;
    if (rest == 1) return m;
  }
}

}  // namespace straytrace
