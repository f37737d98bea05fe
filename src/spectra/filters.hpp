// SPDX-License-Identifier: BSD-3-Clause
// Filters of records. All but the causal ones have no phase: nothing is shifted in time.
#pragma once

#include <cstddef>

#include "spectra/series.hpp"

namespace straytrace {

// Every factor-th sample from `first` on, behind a low pass without phase: a windowed sinc (Kaiser, 80 dB) that passes
// up to 0.8 of the new Nyquist frequency and stops at it. Beyond its ends the record is continued by odd reflection.
TimeSeries decimated(TimeSeries const&, std::size_t factor, std::size_t first = 0);

// Band edges in Hz, 0 <= low < high <= half the rate; low = 0: low pass, high = half the rate: high pass. Butterworth
// of the order, run forwards and backwards (scipy sosfiltfilt with its default padding): the square of its response, no
// phase.
TimeSeries band_passed(TimeSeries const&, double low_hz, double high_hz, int order = 4);
// Second-order notch of this width at -3 dB, forwards and backwards (scipy iirnotch, filtfilt).
TimeSeries notched(TimeSeries const&, double hz, double quality = 30);

}  // namespace straytrace
