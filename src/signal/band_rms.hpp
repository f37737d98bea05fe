// SPDX-License-Identifier: BSD-3-Clause
// How much a record moves within a band of frequencies.
#pragma once

#include <span>
#include <vector>

#include "signal/series.hpp"
#include "signal/welch.hpp"

namespace straytrace {

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
