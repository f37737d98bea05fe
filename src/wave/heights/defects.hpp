// SPDX-License-Identifier: BSD-3-Clause
// Defects of mirrors: point absorbers and ripples (docs/theory/wave.md, eq. W.18, W.31 to W.33).
#pragma once

#include <vector>

#include "wave/field.hpp"
#include "wave/heights/height_map.hpp"
#include "world/model/wave_settings.hpp"

namespace straytrace::wave {

// eq. W.31: height [m] at a distance from a heated spot, zero at the distance `edge`.
double height_of_absorber(WaveSettings::Absorber const&, double distance, double edge);
// The content of that height below a frequency [1/m] across the light, on the grid; of the light, only cosine and
// centre matter here.
std::vector<double> heights_of_absorber(WaveSettings::Absorber const&, Grid const&, double edge,
                                        double largest_frequency, LightOnMirror const& = {});
// eq. W.33: share of the power of a mode that it scatters beyond an angle.
double scattered_by_absorber(WaveSettings::Absorber const&, LightOnMirror const&, double wavelength, double angle);
inline double scattered_by_absorber(WaveSettings::Absorber const& absorber, double beam_radius, double wavelength,
                                    double angle) {
  return scattered_by_absorber(absorber, LightOnMirror{{beam_radius, beam_radius}}, wavelength, angle);
}

std::vector<double> heights_of_ripple(WaveSettings::Ripple const&, Grid const&, LightOnMirror const& = {});
// rad, to which it scatters light, from the specular direction.
double angle_of_ripple(WaveSettings::Ripple const&, double cosine, double wavelength);

}  // namespace straytrace::wave
