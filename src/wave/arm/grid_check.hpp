// SPDX-License-Identifier: BSD-3-Clause
// What a finer grid changes in the results of an arm (docs/theory/wave.md, Errors).
#pragma once

#include <functional>
#include <string>

#include "wave/arm/arm_cavity.hpp"

namespace straytrace::wave {

struct ArmWaves;

// Results on a grid of some 1.4 times the points, less those on the grid itself.
struct GridCheck {
  int points = 0;      // of the finer grid, along one side
  double loss = 0;     // of power per round trip
  PowerLedger ledger;  // the same, by surface
  // Largest change of a lever over the rims, relative to the rms of that lever over the rims; NaN where none is known.
  double across = 0, along = 0;
  double expected = 0;  // relative, of the rms over all edges beyond the grid of the expected lever across; NaN: none
};

// Of the cavity on a grid of some 1.4 times the points, with the same window, crossover angle and heights. InputError
// if it is too large.
WaveSettings finer_settings(WaveSettings, double crossover, Grid const&);
ArmCavity finer_arm(World const&, WaveSettings const&, ArmCavity const&);
// Of the first draw of the heights.
GridCheck grid_check(World const&, ArmCavity const& finer, ArmWaves const&, Computing const&,
                     std::function<void(std::string const&)> const& progress);

}  // namespace straytrace::wave
