// SPDX-License-Identifier: BSD-3-Clause
// Measured motion spectra in text files.
#pragma once

#include "base/table.hpp"
#include "signal/spectrum.hpp"

namespace straytrace {

// {asd: FILE, columns: [Hz, m/sqrt(Hz)], use: [1, 3]}: two columns of text as a displacement PSD [m^2/Hz], or an angle
// PSD [rad^2/Hz] for rotations. The units are those of the two columns, or of all columns of the file when `use` picks
// two of them; ASD or PSD of displacement, velocity or acceleration is told from the unit, that of a reading of a
// sensor with `calibration` (calibration.hpp).
Spectrum read_spectrum_file(Node const& spec, bool rotation);

}  // namespace straytrace
