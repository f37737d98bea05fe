// SPDX-License-Identifier: BSD-3-Clause
// The records of a fit in SI units, and the motion that a fit finds in them. InputErrors name the options of
// `straytrace fit`.
#pragma once

#include <optional>
#include <string>

#include "analysis/fringes/fringe_fit.hpp"
#include "base/units/quantity.hpp"

namespace straytrace::analysis {

TimeSeries as_strain(TimeSeries);  // a plain number
// Adds displacement [m] or angle [rad]: velocities and accelerations are integrated behind a high pass at `corner`, Hz.
// `option`: that names the record.
void add_witness(FringeRecords&, TimeSeries, std::optional<double> corner, std::string const& option);

// The witness is an angle: theta = W (4 pi/lambda) angle, so that multiplicities and factors are in m (per rad).
bool is_rotation(FringeRecords const&);
Dimension multiplicity_dimension(FringeRecords const&);
std::string multiplicity_unit(FringeRecords const&);  // "", or "m" for a rotation
// 0.5 to 6, as far as the sample rate holds the fringes (eq. 7.13); the result states the upper end.
SearchRange usual_multiplicity(FringeRecords const&, FringeFitSettings const&);

// Largest excursion of W (x_1 - ratio x_2) of a path from the middle of its range, m: a peak amplitude. Its error is
// that of W and ratio together.
Fitted effective_peak(FringeRecords const&, FringeFit const&, std::size_t path);
// rad rms of the phase of a path right below the corner, which the integrated witnesses do not show and the light
// feels: amplitudes come out low by exp(-phase^2/2). NaN where the record is too short to tell.
double unseen_phase(FringeRecords const&, FringeFit const&, double wavelength, std::size_t path);

}  // namespace straytrace::analysis
