// SPDX-License-Identifier: BSD-3-Clause
// Files of measured motion, and where they end: beyond, a body is taken as still.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "base/input/table.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace {

// One coordinate whose motion comes from a file that does not say `beyond: zero`.
struct MotionFile {
  std::string name, coordinate;  // as written; "tube z"
  Band known;                    // Hz, of the file
  Band covered;                  // Hz, with what else moves the coordinate, as far as it goes without a hole
  double asd_low = 0;            // m/sqrt(Hz) of the coordinate at known.low; 0 for rotations
  Place place = {};
};

// `a` made wider by all bands that meet it, directly or by way of others.
Band joined(Band a, std::span<Band const> others);

// Highest frequency that fringes of one reflection would reach by the motion below f_0 = known.low, if that went on as
// f^-2 down to 0.1 Hz: 4 times the rms fringe frequency 2 v/lambda (docs/theory/spectra.md, eq. 7.8), with
// v^2 = (2 pi)^2 asd_low^2 f_0^4 (1/0.1 Hz - 1/f_0). Hz; 0 for files that begin at 0.1 Hz or below.
double reach_of_missing(MotionFile const&, double wavelength_m);

// One warning for each file that does not hold the band of the noise, or begins so high that the motion below it,
// which is taken as zero, may decide how fringes wrap in that band.
std::vector<Problem> warnings_of_gaps(std::span<MotionFile const>, Band noise, double wavelength_m);

// Measured motion spectra in text files.

// {asd: FILE, columns: [Hz, m/sqrt(Hz)], use: [1, 3]}: two columns of text as a displacement PSD [m^2/Hz], or an angle
// PSD [rad^2/Hz] for rotations. The units are those of the two columns, or of all columns of the file when `use` picks
// two of them; ASD or PSD of displacement, velocity or acceleration is told from the unit, that of a reading of a
// sensor with `calibration` (calibration.hpp).
Spectrum read_spectrum_file(Node const& spec, bool rotation);

}  // namespace straytrace
