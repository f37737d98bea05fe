// SPDX-License-Identifier: BSD-3-Clause
#include "noise/periodic.hpp"

#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.hpp"

namespace straytrace {
namespace {

Eigen::FFT<double> half_transform() {
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  return fft;
}

}  // namespace

std::size_t quick_length(std::size_t n) {
  std::size_t twos = 1;
  for (; n > 1 && n % 2 == 0; n /= 2) twos *= 2;
  std::size_t best = std::numeric_limits<std::size_t>::max();
  for (std::size_t fives = 1; fives < 5 * n; fives *= 5)
    for (std::size_t threes = fives; threes < 3 * n; threes *= 3) {
      std::size_t length = threes;
      while (length < n) length *= 2;
      best = std::min(best, length);
    }
  return best * twos;
}

std::vector<double> made_periodic(std::span<double const> x, std::size_t period) {
  std::vector<double> out(x.begin(), x.end());
  double const gap = static_cast<double>(period - x.size()) + 1;
  for (std::size_t i = x.size(); i < period; ++i) {
    double const way = 0.5 - 0.5 * std::cos(pi * static_cast<double>(i - x.size() + 1) / gap);
    out.push_back(x.back() + way * (x.front() - x.back()));
  }
  return out;
}

std::vector<double> filtered(std::vector<double> const& x, double rate,
                             std::function<std::complex<double>(double hz)> const& response, double at_zero) {
  Eigen::FFT<double> fft = half_transform();
  std::vector<std::complex<double>> lines;
  fft.fwd(lines, x);
  lines[0] *= at_zero;
  for (std::size_t k = 1; k < lines.size(); ++k)  // this transform has exp(+2 pi i f t): the conjugate
    lines[k] *= std::conj(response(static_cast<double>(k) * rate / static_cast<double>(x.size())));
  if (x.size() % 2 == 0) lines.back() = lines.back().real();
  std::vector<double> out;
  fft.inv(out, lines, static_cast<Eigen::Index>(x.size()));
  return out;
}

std::vector<double> synthesised(std::vector<std::complex<double>> const& coefficients, std::size_t n) {
  Eigen::FFT<double> fft = half_transform();
  std::vector<std::complex<double>> lines(n / 2 + 1);
  for (std::size_t k = 1; k < std::min(coefficients.size(), n / 2); ++k)
    lines[k] = static_cast<double>(n) * coefficients[k];
  std::vector<double> out;
  fft.inv(out, lines, static_cast<Eigen::Index>(n));
  return out;
}

}  // namespace straytrace
