// SPDX-License-Identifier: BSD-3-Clause
// Windowed Fourier transforms of the segments of a stretch, and what pairs of channels share in them.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "signal/series.hpp"
#include "signal/welch.hpp"

namespace straytrace {

// One segment at a time: a long stretch of a fast channel fits no memory otherwise.
class SegmentTransforms {
 public:
  // Throws InputError as welch() does. The series must live as long.
  SegmentTransforms(TimeSeries const&, WelchSettings const&);

  std::size_t size() const { return segments_; }
  // Transform of one segment, scaled so that |line|^2 is its one-sided periodogram [x^2/Hz]; exp(-2 pi i f t).
  std::vector<std::complex<double>> operator[](std::size_t segment) const;
  std::vector<double> const& hz() const { return hz_; }        // multiples of rate/segment, from 0 to half the rate
  double averages() const { return averages_; }                // independent segments that their mean is worth
  double time(std::size_t segment) const;                      // GPS, s, of its middle
  double noise_bandwidth() const { return noise_bandwidth_; }  // ENBW, Hz

 private:
  TimeSeries const* series_;
  WelchSettings settings_;
  std::vector<double> window_, hz_;
  std::size_t step_ = 0, segments_ = 0;
  double square_ = 0, averages_ = 0, noise_bandwidth_ = 0;
};

// Spectra of a witness x and a target y over one stretch of time.
struct PairSpectra {
  std::vector<double> hz;
  std::vector<double> x, y;              // one-sided PSD: (unit of x)^2/Hz and (unit of y)^2/Hz
  std::vector<std::complex<double>> xy;  // one-sided cross density <conj(x) y>
  double averages = 0;

  // |xy|^2/(x y) without what `averages` of independent noises share by chance: (g - 1/n)/(1 - 1/n), not below 0.
  double coherence(std::size_t bin) const;
  double raw_coherence(std::size_t bin) const;  // 0 to 1
};
// Both of one rate and length. Throws InputError.
PairSpectra pair_spectra(TimeSeries const& x, TimeSeries const& y, WelchSettings const&);

}  // namespace straytrace
