// SPDX-License-Identifier: BSD-3-Clause
// Measured time series as motion.
#pragma once

#include <memory>
#include <optional>

#include "motion/motion.hpp"
#include "motion/motion_files.hpp"
#include "spectra/series.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace::motion {

struct RecordedMotion {
  std::shared_ptr<TimeSeries const> displacement;  // m or rad
  Spectrum spectrum;                               // m^2/Hz or rad^2/Hz
};

// {series: FILE, channel: NAME, unit: m/s^2, calibration: ..., highpass: 0.05 Hz, segment: 60 s, span: GPS..GPS}.
// Empty after a problem, which goes to the document.
std::optional<RecordedMotion> read_recorded(Node const& spec, bool rotation);

// The whole record as displacement: the series in the unit of the calibration, less a straight line if it is filtered,
// divided by (2 pi i f)^derivatives, times the response of the calibration and
// (f/highpass)^4/(1 + (f/highpass)^4), which has no phase. Odd reflection that fades out continues it beyond both ends,
// so samples within 1/highpass of them are less certain. highpass 0: none.
TimeSeries as_displacement(TimeSeries const& readings, Calibration const&, double highpass_hz);

// Averaged periodogram of the readings (Welch, Hann, half overlapping, straight lines removed), converted to
// displacement line by line. Each line is a step as wide as the spacing, which conserves power; at high frequencies
// lines are joined into steps of a thousandth of their frequency.
Spectrum displacement_spectrum(TimeSeries const& readings, Calibration const&, double highpass_hz, double segment_s);

// Displacement [m] or angle [rad] from a channel of displacement, velocity or acceleration; the last two need a
// corner [Hz], below which motion is removed. InputError names the option.
RecordedMotion channel_motion(TimeSeries const&, bool rotation, double corner_hz);

// The recording replaces all motion of this coordinate; other bodies keep theirs.
void replace_coordinate(MotionSet&, BodyId, int axis, RecordedMotion const&);

}  // namespace straytrace::motion
