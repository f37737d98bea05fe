// SPDX-License-Identifier: BSD-3-Clause
#include "signal/welch.hpp"

#include <fmt/format.h>
#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/constants.hpp"
#include "base/message.hpp"

namespace straytrace {
namespace {

double weight(Window window, double turn) {  // turn: place in the segment, 0 to 1
  switch (window) {
    case Window::rectangular:
      return 1;
    case Window::hann:
      return 0.5 - 0.5 * std::cos(2 * pi * turn);
    case Window::hamming:
      return 0.54 - 0.46 * std::cos(2 * pi * turn);
    case Window::blackman:
      return 0.42 - 0.5 * std::cos(2 * pi * turn) + 0.08 * std::cos(4 * pi * turn);
  }
  return not_a_number;
}

void check(std::size_t samples, double rate, WelchSettings const& s) {
  if (s.segment < 2 || s.segment > samples)
    throw InputError(
        fmt::format("error: a segment of {} samples does not fit a series of {}\n  choose between 2 and {}", s.segment,
                    samples, samples));
  if (!(s.overlap >= 0 && s.overlap < 1))
    throw InputError(fmt::format("error: an overlap of {:g} is not a share\n  choose from 0 to below 1", s.overlap));
  if (!(rate > 0 && rate < infinity))
    throw InputError(fmt::format("error: a sample rate of {:g} Hz\n  it is positive", rate));
}

// Variance of the mean over that of one periodogram: neighbours that share samples are not independent (Welch 1967).
double variance_of_mean(std::vector<double> const& w, std::size_t step, std::size_t segments, double square) {
  double sum = 1;
  for (std::size_t m = 1; m < segments && m * step < w.size(); ++m) {
    double shared = 0;
    for (std::size_t i = m * step; i < w.size(); ++i) shared += w[i] * w[i - m * step];
    sum += 2 * (1 - double(m) / double(segments)) * std::pow(shared / square, 2);
  }
  return sum / double(segments);
}

}  // namespace

WelchSpectrum welch(std::span<double const> samples, double rate, WelchSettings const& s) {
  check(samples.size(), rate, s);
  std::size_t const n = s.segment, step = std::max<std::size_t>(1, n - std::size_t(std::lround(s.overlap * double(n))));
  std::vector<double> w(n), part(n);
  double sum = 0, square = 0;
  for (std::size_t i = 0; i < n; ++i) {
    w[i] = weight(s.window, double(i) / double(n));
    sum += w[i];
    square += w[i] * w[i];
  }
  WelchSpectrum out;
  out.noise_bandwidth = rate * square / (sum * sum);
  out.psd.assign(n / 2 + 1, 0);
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<std::complex<double>> lines;
  for (std::size_t begin = 0; begin + n <= samples.size(); begin += step, ++out.segments) {
    double mean = 0;
    for (std::size_t i = 0; s.detrend && i < n; ++i) mean += samples[begin + i] / double(n);
    for (std::size_t i = 0; i < n; ++i) part[i] = w[i] * (samples[begin + i] - mean);
    fft.fwd(lines, part);
    for (std::size_t k = 0; k < out.psd.size(); ++k) out.psd[k] += std::norm(lines[k]);
  }
  double const relative = std::sqrt(variance_of_mean(w, step, out.segments, square));
  for (std::size_t k = 0; k < out.psd.size(); ++k) {
    bool const alone = k == 0 || 2 * k == n;  // no negative frequency stands beside these: real, not doubled
    out.hz.push_back(double(k) * rate / double(n));
    out.psd[k] *= (alone ? 1 : 2) / (rate * square * double(out.segments));
    out.sigma.push_back(out.psd[k] * relative * (alone ? std::sqrt(2) : 1));
  }
  return out;
}

}  // namespace straytrace
