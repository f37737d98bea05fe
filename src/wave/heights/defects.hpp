// SPDX-License-Identifier: BSD-3-Clause
// Defects of mirrors: point absorbers and ripples (docs/theory/wave.md, eq. W.18, W.31 to W.33).
#pragma once

#include <vector>

#include "wave/field.hpp"
#include "world/model/wave_settings.hpp"

namespace straytrace::wave {

// eq. W.31: height [m] at a distance from a heated spot, zero at the distance `edge`.
double height_of_absorber(WaveSettings::Absorber const&, double distance, double edge);
// The content of that height below a frequency [1/m], on the grid.
std::vector<double> heights_of_absorber(WaveSettings::Absorber const&, Grid const&, double edge,
                                        double largest_frequency);
// eq. W.33: share of the power of a mode of this 1/e^2 radius on the axis that it scatters beyond an angle.
double scattered_by_absorber(WaveSettings::Absorber const&, double beam_radius, double wavelength, double angle);

std::vector<double> heights_of_ripple(WaveSettings::Ripple const&, Grid const&);

}  // namespace straytrace::wave
