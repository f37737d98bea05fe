// SPDX-License-Identifier: BSD-3-Clause
// A series between its samples.
#pragma once

#include "signal/series.hpp"

namespace straytrace {

// Values at first, first + 1/rate, ... (GPS s): sinc of 32 samples under a Kaiser window, right to 1e-5 of the
// amplitude for content below 0.8 of half the series' own rate; on a sample, the sample itself. Beyond the ends the
// series goes on as its point reflection. Throws InputError where a time is more than 16 samples outside.
std::vector<double> interpolated(TimeSeries const&, double first, double rate, std::size_t count);

}  // namespace straytrace
