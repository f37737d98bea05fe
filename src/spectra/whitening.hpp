// SPDX-License-Identifier: BSD-3-Clause
// Records with the same power at all frequencies.
#pragma once

#include "spectra/series.hpp"
#include "spectra/welch.hpp"

namespace straytrace {

// Divided, line by line and without phase, by its own ASD (Welch, straight between its lines) and by sqrt(2/rate): of
// stationary Gaussian noise the result has variance 1 and one-sided PSD 2/rate at all frequencies; no unit. What is
// below the first line of the ASD is removed. Both ends fade to zero over half a segment.
TimeSeries whitened(TimeSeries const&, WelchSettings const&);

}  // namespace straytrace
