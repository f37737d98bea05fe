// SPDX-License-Identifier: BSD-3-Clause
// Spectra by formula: power laws, ground models, lines, resonances.
#pragma once

#include "base/namespaces.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace::spectra {

// ASD = asd (f / at_hz)^exponent between from_hz and to_hz.
Spectrum power_law_asd(double asd, double at_hz, double exponent, double from_hz, double to_hz);

// PSD proportional to exp(-(f - centre)^2 / (2 width^2)) at f > 0, with variance rms^2 (case A5 of docs/theory).
Spectrum gaussian_line(double centre_hz, double width_hz, double rms);

// Ground displacement [m^2/Hz] of Peterson's noise models, docs/theory/environment.md, eq. 11.1; beyond 10 Hz, where
// they end, the ASD continues as 1/f^2. `typical`: geometric mean of the ASDs of the two.
enum class GroundModel { low, high, typical };
Spectrum peterson(GroundModel, double from_hz, double to_hz);
double peterson_asd(GroundModel, double hz);  // m/sqrt(Hz)

// PSD times a function of frequency. Adds knots until straight lines in log-log deviate by less than 1e-5 half way
// between them, or by 1e-12 of `scale`, a larger reference, if given. `features`: frequencies [Hz] of peaks and bends
// between the knots of the spectrum.
Spectrum filtered(Spectrum const&, std::function<double(double)> const& factor, std::span<double const> features,
                  std::function<double(double)> const& scale = {});

// |T|^2 of a mode of a tube, baffle or mount on its carrier, docs/theory/environment.md, eq. 11.2.
double transmissibility(double hz, double resonance_hz, double quality);
Spectrum through_resonance(Spectrum const&, double resonance_hz, double quality);

}  // namespace straytrace::spectra
