// SPDX-License-Identifier: BSD-3-Clause
// First-order effect of weak phase modulation on a field that already has a spectrum (physics.md eq. 7.14).
#pragma once

#include <span>
#include <vector>

#include "noise/noise.hpp"

namespace straytrace {

// Power of Im s of the slow part per unit of recoupled power, concentrated at a few hundred frequencies.
struct Kernel {
  std::vector<double> hz, power;
};

// One-sided PSD [rad^2/Hz] constant in bins; edges increase.
struct Steps {
  std::vector<double> edges, psd;
};

// Adds to `bin_power` the power that the modulation moves into each bin: every line of the kernel at g gives
// 1/2 [S(|f - g|) + S(f + g)] times its power; the mean over the static phase is in the kernel. No transform: relative
// precision is kept however small S is.
void add_sidebands(Kernel const&, Steps const&, FrequencyGrid const&, std::span<double> bin_power);

}  // namespace straytrace
