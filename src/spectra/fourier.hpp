// SPDX-License-Identifier: BSD-3-Clause
// Discrete Fourier transforms of real records: X_k = sum_n x_n exp(-2 pi i k n/N), as numpy.fft.rfft has it.
#pragma once

#include <algorithm>
#include <complex>
#include <functional>
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

// Operations on whole records in the frequency domain. Inside the room.

// Multiplies the lines of a record by `factor` of their frequency in cycles per sample. The record is continued beyond
// both ends by odd reflection over `beyond` samples (no more than it has), so that its ends do not meet in a step.
inline std::vector<double> filtered(std::vector<double> const& x, std::size_t beyond,
                                    std::function<std::complex<double>(double)> const& factor) {
  std::size_t const n = x.size(), pad = std::min(beyond, n - 1), length = good_length(n + 2 * pad);
  std::vector<double> y;
  y.reserve(length);
  for (std::size_t i = pad; i > 0; --i) y.push_back(2 * x.front() - x[i]);
  y.insert(y.end(), x.begin(), x.end());
  for (std::size_t i = 1; i <= pad; ++i) y.push_back(2 * x.back() - x[n - 1 - i]);
  double const last = y.back(), first = y.front();
  std::size_t const made = y.size();  // the few samples up to a good length lead back to the first
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

}  // namespace straytrace
