// SPDX-License-Identifier: BSD-3-Clause
// First-order effect of weak phase modulation on a field that already has a spectrum (docs/theory/spectra.md,
// eq. 7.14).
#pragma once

#include <span>
#include <vector>

#include "noise/wrapped/wrapped_spectrum.hpp"

namespace straytrace {

// Power concentrated at frequencies.
struct Kernel {
  std::vector<double> hz, power;
};

// One-sided PSD that is constant in bins; edges increase.
struct Steps {
  std::vector<double> edges, psd;
};

// Adds to `bin_power` the power that appears between each two edges when a line of power p at frequency g is modulated
// by S: 1/2 p [S(|f - g|) + S(f + g)]. No transform: relative precision is kept however small S is.
void add_sidebands(Kernel const&, Steps const&, std::span<double const> edges, std::span<double> bin_power);

// Power of the low part in each bin, its lines taken as wide as their spacing.
void add_lines(WrappedSpectrum const&, std::span<double const> edges, std::span<double> bin_power);

// The same as add_sidebands for all of a low part, its constant power included; `unshifted`: power of the modulation in
// each bin, exact where S is a coarser description of it.
void modulate(WrappedSpectrum const&, Steps const& fast, std::span<double const> unshifted,
              std::span<double const> edges, std::span<double> bin_power);

// A low part as a density that a line can shift.
Steps as_steps(WrappedSpectrum const&);

}  // namespace straytrace
