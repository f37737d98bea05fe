// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/fourier.hpp"

#include <unsupported/Eigen/FFT>

#include <algorithm>

namespace straytrace::spectra {

struct Fourier::Engine {
  Eigen::FFT<double> fft;
};

Fourier::Fourier() : engine_(std::make_unique<Engine>()) { engine_->fft.SetFlag(Eigen::FFT<double>::HalfSpectrum); }
Fourier::~Fourier() = default;
Fourier::Fourier(Fourier&&) noexcept = default;

void Fourier::forward(std::vector<double> const& samples, Complexes& lines) { engine_->fft.fwd(lines, samples); }

void Fourier::inverse(Complexes const& lines, std::vector<double>& samples, std::size_t count) {
  engine_->fft.inv(samples, lines, Eigen::Index(count));
}

void Fourier::forward(Complexes const& samples, Complexes& lines) { engine_->fft.fwd(lines, samples); }

void Fourier::inverse(Complexes const& lines, Complexes& samples) { engine_->fft.inv(samples, lines); }

Complexes const& Fourier::forward(std::vector<double> const& samples) {
  forward(samples, lines_);
  return lines_;
}

std::vector<double> Fourier::inverse(Complexes const& lines, std::size_t count) {
  std::vector<double> samples;
  inverse(lines, samples, count);
  return samples;
}

bool has_fast_transform(std::size_t n) {
  for (std::size_t const p : {2, 3, 5})
    while (n % p == 0) n /= p;
  return n == 1;
}

std::size_t good_length(std::size_t n) {
  n = std::max<std::size_t>(2, n + n % 2);
  while (!has_fast_transform(n)) n += 2;
  return n;
}

std::size_t quick_length(std::size_t n) {
  std::size_t const twos = n & -n;
  while (!has_fast_transform(n)) n += twos;
  return n;
}

std::vector<double> filtered(std::vector<double> const& x, std::size_t beyond,
                             std::function<std::complex<double>(double)> const& factor) {
  std::size_t const n = x.size(), pad = std::min(beyond, n - 1), length = good_length(n + 2 * pad);
  std::vector<double> y;
  y.reserve(length);
  for (std::size_t i = pad; i > 0; --i) y.push_back(2 * x.front() - x[i]);
  y.insert(y.end(), x.begin(), x.end());
  for (std::size_t i = 1; i <= pad; ++i) y.push_back(2 * x.back() - x[n - 1 - i]);
  double const last = y.back(), first = y.front();
  std::size_t const made = y.size();  // the remaining samples lead back to the first one
  while (y.size() < length) {
    double const share = double(y.size() - made + 1) / double(length - made + 1);
    y.push_back(last + share * (first - last));
  }
  Fourier fourier;
  Complexes lines = fourier.forward(y);
  for (std::size_t k = 0; k < lines.size(); ++k) lines[k] *= factor(double(k) / double(length));
  std::vector<double> const out = fourier.inverse(lines, length);
  return {out.begin() + std::ptrdiff_t(pad), out.begin() + std::ptrdiff_t(pad + n)};
}

}  // namespace straytrace::spectra
