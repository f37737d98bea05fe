// SPDX-License-Identifier: BSD-3-Clause
// Measured time series as motion.
#pragma once

#include <memory>
#include <optional>

#include "motion/motion_files.hpp"
#include "spectra/series.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace {

struct RecordedMotion {
  std::shared_ptr<TimeSeries const> displacement;  // m or rad
  Spectrum spectrum;                               // m^2/Hz or rad^2/Hz
};

// {series: FILE, channel: NAME, unit: m/s^2, calibration: ..., highpass: 0.05 Hz, segment: 60 s, span: GPS..GPS}.
// Problems go to the document; nothing then.
std::optional<RecordedMotion> read_recorded(Node const& spec, bool rotation);

// The whole record as displacement: a series in the unit that the calibration is for, a straight line taken off where
// there is anything to filter, divided by (2 pi i f)^derivatives, times the response of the calibration and
// (f/highpass)^4/(1 + (f/highpass)^4), which turns no phase. Beyond both ends it is continued by odd reflection that
// fades out, so what is nearer to them than 1/highpass is less certain. highpass 0: none.
TimeSeries as_displacement(TimeSeries const& readings, Calibration const&, double highpass_hz);

// Averaged periodogram of the readings (Welch, Hann, half overlapping, straight lines taken off), turned into
// displacement line by line: each line is a step as wide as the spacing, so that powers are kept; higher up lines are
// joined until a step is a thousandth of its frequency.
Spectrum displacement_spectrum(TimeSeries const& readings, Calibration const&, double highpass_hz, double segment_s);

}  // namespace straytrace
