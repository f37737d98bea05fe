// SPDX-License-Identifier: BSD-3-Clause
// Reading values off noise curves.
#pragma once

#include <utility>

#include "report/report.hpp"

namespace straytrace {

constexpr double wrapped_from = 1;  // rad rms; above, fringes wrap (physics.md eq. 1.11)

// {low, high}, or the whole grid when high <= low.
std::pair<double, double> band_of(FrequencyGrid const&, double low, double high);
// The bin that holds hz; NaN outside the grid.
WithError strain_at(NoiseTrace const&, FrequencyGrid const&, double hz);
// Integral of the PSD over the bins whose centres lie in the band, strain^2; errors of bins add (they are correlated).
WithError band_power(NoiseTrace const&, FrequencyGrid const&, double low, double high);

}  // namespace straytrace
