// SPDX-License-Identifier: BSD-3-Clause
// Power spectral densities of time series by averaged periodograms (Welch 1967; R2.15).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "spectra/series.hpp"
#include "spectra/window.hpp"

namespace straytrace {

enum class Average : std::uint8_t { mean, median };
enum class Detrend : std::uint8_t { none, constant, linear };  // what is taken from each segment

struct WelchSettings {
  std::size_t segment = 0;  // samples; the frequencies are multiples of sample rate/segment
  double overlap = 0.5;     // of neighbours, share of a segment
  Window window = Window::hann;
  double window_parameter = 0;  // of Tukey and Kaiser windows
  Detrend detrend = Detrend::constant;
  // The median ignores single loud segments; its bias for Gaussian noise is taken out, but it stays too high for
  // deterministic lines by up to 1/ln 2, and never sees what lasts less than half of the record.
  Average average = Average::mean;
};

struct WelchSpectrum {
  std::vector<double> hz;         // from 0 to half the sample rate
  std::vector<double> psd;        // one-sided, x^2/Hz: twice the two-sided one, except at 0 and at half the sample rate
  std::vector<double> sigma;      // one standard error for Gaussian noise that is flat across the window; x^2/Hz
  std::size_t segments = 0;       // averaged
  double effective_averages = 0;  // independent ones: overlapping segments share samples, and a median uses less
  double noise_bandwidth = 0;     // ENBW, Hz: a line of amplitude a stands at a^2/(2 ENBW)

  // Whether the line stands alone, without a negative frequency beside it: half the degrees of freedom.
  bool is_real_line(std::size_t k) const { return k == 0 || (even && k + 1 == hz.size()); }
  bool even = true;  // samples of a segment
};

// Over the segments that fit; samples in order, sample rate in Hz. Throws InputError for a segment below two samples or
// longer than the series, an overlap outside [0, 1), a sample rate that is not positive.
WelchSpectrum welch(std::span<double const> samples, double sample_rate, WelchSettings const&);

// Interval that holds the true PSD with this probability: nu S/chi^2_nu, nu = 2 effective averages (1 at real lines).
struct Interval {
  std::vector<double> low, high;
};
Interval confidence(WelchSpectrum const&, double probability = 0.95);

// Median over mean of n independent periodograms of Gaussian noise, 1 for n = 1, ln 2 for many.
double median_bias(std::size_t n);

// How much a record moves within a band of frequencies.

struct BandPower {
  double power = 0, sigma = 0;  // integral of the PSD over the band, x^2; one standard error for Gaussian noise
};
// Each line stands for half a step on either side; the lines at 0 and at half the rate for their one side, with all
// their power: over the whole band this is the sum of the lines, the mean square of the windowed record (Parseval).
// `settings`: with which the spectrum was made; neighbouring lines share what the window spreads.
BandPower band_power(WelchSpectrum const&, WelchSettings const& settings, double low_hz, double high_hz);

// rms of the band-passed record in strides of `stride_s`; time at their middle. One sigma for Gaussian noise that is
// flat in the band: 1/(2 sqrt(bandwidth stride)) of it.
struct RmsTrend {
  std::vector<double> time, rms, sigma;
};
RmsTrend rms_trend(TimeSeries const&, double low_hz, double high_hz, double stride_s);
double rms(std::span<double const> samples);  // about zero

}  // namespace straytrace
