// SPDX-License-Identifier: BSD-3-Clause
// Filters of records. All but the causal ones have zero phase: they shift nothing in time.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/namespaces.hpp"
#include "spectra/series.hpp"
#include "spectra/welch.hpp"

namespace straytrace::spectra {

// Every factor-th sample from `first` on, after a low pass of zero phase: a windowed sinc (Kaiser, 80 dB) that passes
// up to 0.8 of the new Nyquist frequency and stops at it. Odd reflection continues the record beyond its ends.
TimeSeries decimated(TimeSeries const&, std::size_t factor, std::size_t first = 0);

// Band edges in Hz, 0 <= low < high <= half the rate; low = 0: low pass, high = half the rate: high pass. Butterworth
// of the order, run forwards and backwards (scipy sosfiltfilt with its default padding): the square of its response, no
// phase.
TimeSeries band_passed(TimeSeries const&, double low_hz, double high_hz, int order = 4);
// Second-order notch of this width at -3 dB, forwards and backwards (scipy iirnotch, filtfilt).
TimeSeries notched(TimeSeries const&, double hz, double quality = 30);

// Recursive filters as second-order sections (conventions of scipy.signal), for this module only.

// (b0 + b1/z + b2/z^2)/(1 + a1/z + a2/z^2)
struct Section {
  std::array<double, 3> b{1, 0, 0};
  std::array<double, 2> a{0, 0};
};

// Butterworth by the bilinear transform; edges as shares of half the sample rate, 0 <= low < high <= 1. low = 0: low
// pass, high = 1: high pass, otherwise a band pass of twice the order. Throws InputError for an order outside 1 to 12.
std::vector<Section> butterworth(int order, double low, double high);
// Unit gain except at `share` of half the sample rate, with width share/quality at -3 dB.
Section notch(double share, double quality);

std::vector<double> once(std::vector<Section> const&, std::vector<double> x);  // causal, from rest
// Forwards and backwards, the record continued by odd reflection and the filter settled on its ends
// (scipy.signal.sosfiltfilt). Throws InputError for a record that is too short.
std::vector<double> both_ways(std::vector<Section> const&, std::vector<double> const& x);

// Whitening.

// Divided, line by line and without phase, by its own ASD (Welch, straight between its lines) and by sqrt(2/rate): for
// stationary Gaussian noise the result has variance 1 and one-sided PSD 2/rate at all frequencies; no unit. Frequencies
// below the first line of the ASD are removed. Both ends fade to zero over half a segment.
TimeSeries whitened(TimeSeries const&, WelchSettings const&);

}  // namespace straytrace::spectra
