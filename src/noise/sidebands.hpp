// SPDX-License-Identifier: BSD-3-Clause
// First-order effect of weak phase modulation on a field that already has a spectrum (physics.md eq. 7.14).
#pragma once

#include <span>
#include <vector>

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

}  // namespace straytrace
