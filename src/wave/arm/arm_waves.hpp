// SPDX-License-Identifier: BSD-3-Clause
// The solved cavity of a scene: its mode, where its light goes, and the levers of its rims (docs/theory/wave.md).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "wave/arm/arm_cavity.hpp"
#include "wave/arm/irradiance.hpp"

namespace straytrace::wave {

// One rim. Where the grid does not hold the light that meets it, `responses` is empty and the expectation over speckle
// stands for it.
struct RimResult {
  std::vector<RimResponse> responses;  // as drawn in the scene, then with each draw of the tolerances
  Complex clipped;                     // s of the light that the baffle takes from the mode
  SpeckleMeans speckle;                // eq. W.22 with the BSDF of the mirrors
};
struct ModeLine {
  int n = 0, m = 0;    // of the Hermite-Gauss mode that it shares most power with
  double overlap = 0;  // power shared
  double loss = 0;     // of power per round trip
  double phase = 0;    // of the round trip, less that of the fundamental mode; turns, -0.5 to 0.5
  double residual = 0;
};
struct ArmWaves {
  ArmCavity arm;
  WaveMode mode;
  double perfect_loss = 0;  // per round trip, of smooth mirrors without baffles, by eq. W.10
  std::vector<ModeLine> modes;
  PowerLedger ledger;
  std::vector<RimResult> rims;  // as arm.rims
  PlaneIrradiance irradiance;
  std::array<Complex, 2> mirror1{}, mirror2{};  // derivatives of s by displacements of the mirrors along x and y. 1/m
};

struct ArmOptions {
  int threads = 0;        // 0: all
  int highest_order = 2;  // of the modes listed; < 0: none
  std::function<void(std::string const& what)> progress;
};
ArmWaves solve_arm(World const&, WaveSettings const&, ArmOptions const& = {});

}  // namespace straytrace::wave
