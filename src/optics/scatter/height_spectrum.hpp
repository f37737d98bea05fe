// SPDX-License-Identifier: BSD-3-Clause
// Power spectra of surface heights and what they scatter in total (docs/theory/surfaces.md, eq. 3.5 to 3.7, 3.10). Host
// only.
#pragma once

#include <vector>

namespace straytrace {

// Two-sided spectra as power laws between points: 1D in m^3, 2D in m^4; f in 1/m, increasing.
struct SpectrumPoint {
  double f, value;
};
using HeightSpectrum = std::vector<SpectrumPoint>;

double spectrum_at(HeightSpectrum const&, double f);                 // extended by the end slopes
double variance_1d(HeightSpectrum const&, double low, double high);  // m^2, eq. 3.5
double variance_2d(HeightSpectrum const&, double low, double high);  // m^2, eq. 3.6
// 2D spectrum of an isotropic surface from its profile spectrum: the inverse Abel transform, for power laws eq. 3.7.
// Values come out at or below zero where no isotropic surface has such a profile.
HeightSpectrum surface_of_profile(HeightSpectrum const&);

double tis_smooth(double rms, double cos_i, double wavelength);    // eq. 3.10, first form
double tis_moderate(double rms, double cos_i, double wavelength);  // second form

}  // namespace straytrace
