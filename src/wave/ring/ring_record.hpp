// SPDX-License-Identifier: BSD-3-Clause
// A solved ring or folded cavity as a run file keeps it: plain numbers and names.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "wave/ring/ring_waves.hpp"

namespace straytrace::wave {

struct RingSurfaceRecord {
  std::string name, body;  // no body: empty
  bool mirror = false;
  Vec3 reference;    // as of SurfaceLevers
  double lost = 0;   // share of the power per round trip
  RimLevers levers;  // along the axes of the scene
  Complex widening;  // 1/m; of a mirror: 0
};
struct RingRecord {
  std::string beam;
  double power = 0, wavelength = 0, length = 0;  // W, 0: not stated; m; of the round trip, m
  Grid grid;                                     // at the start
  double crossover = 0;                          // rad
  Complex eigenvalue, reverse_eigenvalue;        // of the round trip in both directions
  double residual = 0, beyond_band = 0;          // eq. W.9; share of the power at angles that reach no opening
  std::vector<ModeLine> modes;
  std::vector<RingSurfaceRecord> surfaces;  // as the light meets them first
  std::optional<RingGridCheck> grid_check;  // its losses as `surfaces`
  std::vector<std::string> warnings;

  double loss() const { return 1 - std::norm(eigenvalue); }  // of power per round trip
};
RingRecord record_of(World const&, RingWaves const&, double power);

}  // namespace straytrace::wave
