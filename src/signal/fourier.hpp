// SPDX-License-Identifier: BSD-3-Clause
// Discrete Fourier transforms of real records: X_k = sum_n x_n exp(-2 pi i k n/N), as numpy.fft.rfft has it.
#pragma once

#include <complex>
#include <memory>
#include <span>
#include <vector>

namespace straytrace {

using Complexes = std::vector<std::complex<double>>;

// Keeps its tables between calls of one length.
class Fourier {
 public:
  Fourier();
  ~Fourier();
  Complexes const& forward(std::vector<double> const&);              // N/2 + 1 lines, valid until the next call
  std::vector<double> inverse(Complexes const&, std::size_t count);  // of N/2 + 1 lines; count = N; includes 1/N

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
  Complexes lines_;
};

// The next number with no prime factor beyond 5: its transforms are fast.
std::size_t good_length(std::size_t);

}  // namespace straytrace
