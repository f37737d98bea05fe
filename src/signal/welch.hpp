// SPDX-License-Identifier: BSD-3-Clause
// Power spectral densities of time series by averaged periodograms (Welch 1967; R2.15).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace straytrace {

enum class Window : std::uint8_t { rectangular, hann, hamming, blackman };  // periodic: they repeat after the segment

struct WelchSettings {
  std::size_t segment = 0;  // samples; the frequencies are multiples of sample rate/segment
  double overlap = 0.5;     // of neighbours, share of a segment
  Window window = Window::hann;
  bool detrend = true;  // takes the mean from each segment
};

struct WelchSpectrum {
  std::vector<double> hz;      // from 0 to half the sample rate
  std::vector<double> psd;     // one-sided, x^2/Hz: twice the two-sided one, except at 0 and at half the sample rate
  std::vector<double> sigma;   // one standard error for Gaussian noise that is flat across the window; x^2/Hz
  std::size_t segments = 0;    // averaged
  double noise_bandwidth = 0;  // ENBW, Hz: a line of amplitude a stands at a^2/(2 ENBW)
};

// The mean over the segments that fit; samples in order, sample rate in Hz. Throws InputError for a segment below two
// samples or longer than the series, an overlap outside [0, 1), a sample rate that is not positive.
WelchSpectrum welch(std::span<double const> samples, double sample_rate, WelchSettings const&);

}  // namespace straytrace
