// SPDX-License-Identifier: BSD-3-Clause
// Spectra that change with time.
#pragma once

#include <vector>

#include "spectra/series.hpp"
#include "spectra/welch.hpp"

namespace straytrace::spectra {

struct Spectrogram {
  std::vector<double> time;   // GPS s, middle of each stride
  std::vector<double> hz;     // rising
  std::vector<double> value;  // value[stride * lines + line]
  double at(std::size_t stride, std::size_t line) const { return value[stride * hz.size() + line]; }
};

// One-sided ASD of each stride by welch() within it; strides do not overlap, and the remainder is dropped.
// Throws InputError for strides shorter than a segment or longer than the record.
Spectrogram spectrogram(TimeSeries const&, double stride_s, WelchSettings const&);
// The same of Hann segments of one stride each, half overlapping, without the line at zero. Throws InputError for
// strides of fewer than 8 samples or longer than the record.
Spectrogram overlapping_spectrogram(TimeSeries const&, double stride_s);
// Each line divided by its median over time: 1 is the usual level.
Spectrogram normalised(Spectrogram);

// Constant-Q tiles (Chatterji et al. 2004): the whitened record seen through windows (1 - x^2)^2 of frequency, x =
// (f - f_0)/(sqrt(11) f_0/Q). The energy of each row is divided by its median/ln 2: in stationary Gaussian noise a tile
// exceeds e with probability exp(-e). Cells hold the largest energy within their time.
struct QSettings {
  double q = 12;
  double low_hz = 10, high_hz = 100;
  double mismatch = 0.2;      // largest loss of energy between neighbouring rows
  std::size_t columns = 500;  // cells in time; fewer where no tile is that short
};
// Of a whitened record. Throws InputError for a band outside the record's or for a record that is too short.
Spectrogram q_transform(TimeSeries const& white, QSettings const&);

}  // namespace straytrace::spectra
