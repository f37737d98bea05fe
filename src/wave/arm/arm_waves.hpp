// SPDX-License-Identifier: BSD-3-Clause
// The solved cavity of a scene: its mode, where its light goes, and the levers of its rims, for each draw of the random
// heights of its mirrors (docs/theory/wave.md).
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "wave/arm/arm_cavity.hpp"
#include "wave/arm/arm_solver.hpp"
#include "wave/arm/irradiance.hpp"
#include "wave/arm/speckled_rim.hpp"
#include "wave/modes/driven.hpp"

namespace straytrace::wave {

// Of a quantity over draws. `low` and `high` are its percentiles 5 and 95: with fewer than 20 draws, the smallest and
// the largest.
struct Spread {
  double mean = 0, median = 0, low = 0, high = 0;
};
Spread spread_of(std::vector<double> values);  // not empty

// A rim in one draw of the heights.
struct RimDraw {
  std::vector<RimResponse> responses;  // as drawn in the scene, then with each draw of the tolerances and of the roll
  Complex clipped;                     // s of the light that the baffle takes from the mode
};
struct RimResult {
  std::vector<RimDraw> draws;  // of the heights; empty where the grid does not hold the light that meets the rim
  SpeckleMeans speckle;        // eq. W.22 with the BSDF of the mirrors; stands for it there

  // All draws of the heights, with all draws of tolerances and roll where there are any, otherwise as drawn in the
  // scene.
  std::vector<RimResponse const*> ensemble() const;
};

// Power on a photodiode over that of the mode.
struct DiodeResult {
  std::vector<double> draws;  // of the heights; empty where the grid does not hold the light that meets it
  double mean = 0;            // over all heights of the mirrors that no map states (eq. W.41)
  double spread = 0;          // standard deviation over them (eq. W.43)
};
// Where the light that arrives at a mirror has its centroid, in the first draw, and where eq. W.23 has the axis of the
// mode, in m along x and y of the frame of the cavity.
struct MirrorSpot {
  std::array<double, 2> found{}, expected{};
};

// One draw of the heights.
struct ArmDraw {
  std::array<double, 2> roughness{};  // rms of the heights of both mirrors, m
  double loss = 0;                    // of power per round trip
  double residual = 0;                // of the mode (eq. W.9)
  int round_trips = 0;                // that the search took
  PowerLedger ledger;
  std::array<MirrorLevers, 2> mirrors;
};

struct ArmWaves {
  ArmCavity arm;                      // with the heights of the first draw
  WaveMode mode;                      // of the first draw
  std::vector<ArmDraw> draws;         // of the heights, one at least
  double perfect_loss = 0;            // per round trip, of smooth mirrors without baffles, by eq. W.10
  std::vector<ModeLine> modes;        // of the mirrors without baffles, in the first draw
  PowerLedger ledger;                 // mean over the draws
  std::vector<RimResult> rims;        // as arm.rims
  PlaneIrradiance irradiance;         // mean over the draws
  std::vector<LightOfMirrors> light;  // in each draw
  std::optional<GridCheck> grid_check;
  std::optional<HeightBands> bands;
  std::array<MirrorSpot, 2> spots;
  std::vector<DiodeResult> diodes = {};  // as arm.diodes
  std::vector<Field> fields = {};  // of the first draw, that arrive at mirror 1 and at mirror 2; empty: not wanted
  std::string device = "cpu";      // where the fields were computed
};

struct ArmOptions {
  int threads = 0;                       // 0: all
  std::shared_ptr<WaveDevice> device{};  // none: the host
  int highest_order = -1;                // of the modes listed; < 0: none
  bool grid_check = false;               // solve the first draw again on a finer grid
  bool by_frequency = false;             // split the loss by the spatial frequency of the heights
  bool fields = false;                   // keep those that arrive at the mirrors
  std::function<void(std::string const& what)> progress;
};
ArmWaves solve_arm(World const&, WaveSettings const&, ArmCavity planned, ArmOptions const&);
inline ArmWaves solve_arm(World const& world, WaveSettings const& settings, ArmOptions const& options = {}) {
  return solve_arm(world, settings, planned_arm(world, settings), options);
}

// The field that the input beam of a scene builds up in its cavity, at a list of detunings (docs/theory/wave.md,
// eq. W.50 to W.52).

struct DriveOptions {
  int threads = 0;                       // 0: all
  std::shared_ptr<WaveDevice> device{};  // none: the host
  int highest_order = 2;
  std::function<void(std::string const& what)> progress;
};
DrivenOptions solve_options(DriveOptions const&);
// `coatings` of both mirrors; `detunings` in free spectral ranges from the resonance of the mode.
DrivenScan drive_arm(WaveSettings const&, ArmWaves const&, std::vector<MirrorCoating> const& coatings,
                     std::vector<double> const& detunings, DriveOptions const& = {});

}  // namespace straytrace::wave
