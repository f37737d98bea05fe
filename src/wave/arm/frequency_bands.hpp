// SPDX-License-Identifier: BSD-3-Clause
// The loss of an arm by the spatial frequency of the heights of its mirrors (docs/theory/wave.md, eq. W.34).
#pragma once

#include <array>
#include <vector>

#include "wave/arm/arm_cavity.hpp"

namespace straytrace::wave {

class ArmSolver;

// Heights with spatial frequencies above `from` and up to `to`. 1/m
struct HeightBand {
  double from = 0, to = 0;
  std::array<double, 2> scattered{};  // share of the power of the mode that each mirror scatters, to first order
  double loss = 0;  // of power per round trip, with these heights alone, less that of smooth mirrors; may be negative
};
// The loss of a band is resolved to this share of the loss of the mode.
inline constexpr double resolved_loss_of_bands = 1e-5;
struct HeightBands {
  double smooth = 0;              // loss of mirrors without heights: what the openings take
  std::vector<HeightBand> bands;  // ascending; octaves below the crossover angle
  double beyond = 0;              // scattered beyond the crossover angle by both mirrors (eq. W.2)
};
// Of the heights that `arm` has. The solver is left with others.
HeightBands frequency_bands(ArmCavity const& arm, ArmSolver&);

}  // namespace straytrace::wave
