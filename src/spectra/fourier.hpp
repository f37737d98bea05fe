// SPDX-License-Identifier: BSD-3-Clause
// The discrete Fourier transform of the program: X_k = sum_n x_n exp(-2 pi i k n/N), as in numpy.fft.
#pragma once

#include <complex>
#include <functional>
#include <memory>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::spectra {

using Complexes = std::vector<std::complex<double>>;

// Keeps its tables between calls of one length; one object per thread. Inverse transforms include 1/N.
class Fourier {
 public:
  Fourier();
  ~Fourier();
  Fourier(Fourier&&) noexcept;

  // Real samples: N/2 + 1 lines, as in numpy.fft.rfft.
  void forward(std::vector<double> const& samples, Complexes& lines);
  void inverse(Complexes const& lines, std::vector<double>& samples, std::size_t count);  // count = N
  // Complex samples: N lines.
  void forward(Complexes const& samples, Complexes& lines);
  void inverse(Complexes const& lines, Complexes& samples);

  Complexes const& forward(std::vector<double> const& samples);  // valid until the next call
  std::vector<double> inverse(Complexes const& lines, std::size_t count);

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
  Complexes lines_;
};

// Transforms are fast for lengths without prime factors above 5.
bool has_fast_transform(std::size_t);
// The next even one; the next one with all the factors two of n, so that twice the samples have twice the length.
std::size_t good_length(std::size_t n);
std::size_t quick_length(std::size_t n);

// Multiplies the lines of a record by `factor` of their frequency in cycles per sample. Odd reflection continues the
// record beyond both ends by `beyond` samples (at most its length), so that the ends do not form a step.
std::vector<double> filtered(std::vector<double> const&, std::size_t beyond,
                             std::function<std::complex<double>(double)> const& factor);

}  // namespace straytrace::spectra
