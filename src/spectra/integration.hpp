// SPDX-License-Identifier: BSD-3-Clause
// Accelerometers and velocity meters to displacement (docs/theory/motion.md, eq. 11.3; R6.05).
#pragma once

#include <optional>
#include <string>

#include "base/units/quantity.hpp"
#include "spectra/series.hpp"

namespace straytrace::spectra {

// Number of integrations, up to 2, from a unit to a dimension; empty: none of them leads there.
std::optional<int> integrations_to(Dimension, std::string const& unit);
// Number of integrations to metres: 2 from m/s^2, 1 from m/s, 0 from m. Throws InputError with a remedy for other
// units.
int integrations_to_displacement(std::string const& unit);

// One-sided ASD divided by (2 pi f)^times (eq. 11.3); f > 0.
double integrated_asd(double asd, double hz, int times);

// The record integrated `times` times, in SI units. Throws InputError when the unit contains no time to integrate.
// In the frequency domain: lines divided by (2 pi i f)^times behind the high pass (f/c)^4/(1 + (f/c)^4), c = corner_hz,
// both without phase error: 1 % too small at 3.2 c, right above. The mean is removed. Odd reflection continues the
// record beyond its ends, and the result is uncertain within about 1/c of them.
TimeSeries integrated(TimeSeries const&, int times, double corner_hz);
// An integrated record without its ends: integration lacks the motion before and after it. The error after the high
// pass falls as exp(-sqrt(2) pi corner t), to 1.4e-4 in the two periods that are removed at both ends.
// Throws InputError with fewer than six periods.
TimeSeries settled(TimeSeries const&, double corner_hz);
// rms of the integrated record between a high pass at half of corner_hz and one at corner_hz: motion, or noise of the
// sensor, right below the corner. NaN with fewer than six periods of half the corner.
double rms_below(TimeSeries const&, int times, double corner_hz);
// From past samples only: trapezoidal rule behind a causal Butterworth high pass of order 2 times + 2 at corner_hz,
// with the phase of that filter. Settles within a few 1/corner_hz. The trapezoidal rule multiplies by (x cot x)^times,
// x = pi f/rate: for two integrations 1 % too small at 1/26 of the rate.
TimeSeries integrated_causal(TimeSeries const&, int times, double corner_hz);

}  // namespace straytrace::spectra
