// SPDX-License-Identifier: BSD-3-Clause
// Eigenmode of a two-mirror cavity in closed form (docs/theory/beams.md, eq. 6.3). Any other: beams/eigenmode.hpp.
#pragma once

#include "base/namespaces.hpp"

namespace straytrace::beams {

// Two mirrors at distance `length`; RoC > 0 when concave towards each other, infinite when flat. Lengths in m.
struct CavityMode {
  double g1 = 0, g2 = 0;             // 1 - L/RoC
  double w1 = 0, w2 = 0, waist = 0;  // 1/e^2 intensity radii at the mirrors and at the waist, m
  double waist_position = 0;         // m from mirror 1
  double gouy = 0;                   // one-way Gouy phase, rad
  double rayleigh = 0;               // m
};
// eq. 6.3. Throws NumericalError unless 0 < g1 g2 < 1 by 1e-9 at least.
CavityMode cavity_mode(double length, double roc1, double roc2, double wavelength);

}  // namespace straytrace::beams
