// SPDX-License-Identifier: BSD-3-Clause
// What the rims of a cavity couple back into its mode when they move (docs/theory/wave.md, eq. W.11 to W.16).
#pragma once

#include <array>
#include <vector>

#include "wave/cavity.hpp"
#include "wave/rims.hpp"

namespace straytrace::wave {

// Fields that arrive at the rim of a baffle from both mirrors, of unit power after mirror 1.
struct RimFields {
  std::vector<RimPoint> rim;
  std::vector<WaveValue> from_mirror1, from_mirror2;  // at its points
};
// The rims of all baffles, with four points for each period of the product of the fields.
struct CavityRims {
  Complex overlap;                 // B of eq. W.11
  std::vector<RimFields> baffles;  // in the order of the cavity
  std::vector<Complex> clipped;    // s of the light that each baffle takes from the mode (eq. W.12 with its screen)
  std::array<Complex, 2> mirror1{}, mirror2{};  // derivatives of s by the displacement of a mirror along x and y. 1/m
};
CavityRims fields_at_rims(CavityWaves const&, WaveMode const&);
// About the centre of its rim.
RimLevers levers_of(CavityRims const&, std::size_t baffle, WaveCavity const&);

}  // namespace straytrace::wave
