// SPDX-License-Identifier: BSD-3-Clause
// A solved cavity as a run file keeps it: plain numbers and names, without the surfaces of the scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "wave/arm/arm_waves.hpp"

namespace straytrace::wave {

struct MirrorRecord {
  std::string name;
  double radius = 0, curvature = 0, spot = 0, scattered = 0, roughness = 0;  // as of ArmMirror
  double lost = 0;  // share of the power per round trip, mean over the draws of the heights
  MirrorSpot light;
};
// One draw of the heights.
struct HeightsRecord {
  std::array<double, 2> roughness{};
  double loss = 0, residual = 0;
  std::uint32_t round_trips = 0;
  // Shares of the power lost per round trip: at mirror 1 and 2; on all baffles, towards mirror 1 and 2; at angles that
  // reach no opening.
  std::array<double, 2> at_mirrors{}, on_baffles{};
  double beyond_band = 0;
  std::array<MirrorLevers, 2> mirrors;
};
// A rim in one draw.
struct RimDrawRecord {
  std::uint32_t heights = 0;
  std::uint32_t tolerance = 0;  // 0: as drawn in the scene; from 1: draw of the tolerances and of the roll
  RimResponse response;
  Complex clipped;  // the same for all of these draws
};
struct RimRecord {
  std::string name;
  Vec3 centre;                                      // in the frame of the cavity, m
  double radius = 0, angle1 = 0, angle2 = 0;        // m, rad
  double towards_mirror2 = 0, towards_mirror1 = 0;  // shares of the power that fall on its baffle
  SpeckleMeans speckle;
  std::vector<RimDrawRecord> draws;  // empty: `speckle` stands for the rim
};
// A photodiode and its light, over the power of the mode.
struct DiodeRecord {
  std::string name;
  std::uint32_t rim = none;        // of its baffle
  bool towards_mirror1 = false;    // the light that meets it
  std::array<double, 2> centre{};  // across the axis, m
  double area = 0;                 // m^2
  double power = 0;                // with the heights of the first draw; NaN: the grid does not hold its light
  double mean = 0, spread = 0;     // as DiodeResult
  static constexpr std::uint32_t none = 0xffffffffu;  // it is at a mirror
};
// A field that arrives at a mirror, over the root of the power of the mode; 1/m, [row, column].
struct FieldRecord {
  std::uint32_t points = 0;
  std::vector<float> values;  // real and imaginary part of each point
};

struct WaveRecord {
  std::string key;  // hash of all that decides the numbers
  std::string beam;
  std::string device = "cpu";         // as ArmWaves
  double power = 0;                   // W, of the mode; 0: not stated
  double wavelength = 0, length = 0;  // m
  Grid grid;
  double crossover = 0;  // rad
  Complex eigenvalue;    // in the first draw of the heights
  std::vector<HeightsRecord> heights;
  double perfect_loss = 0;  // as ArmWaves
  double beyond_band = 0;
  std::array<MirrorRecord, 2> mirrors;
  std::vector<ModeLine> modes;
  std::vector<RimRecord> rims;
  std::vector<DiodeRecord> diodes;  // empty: none, or not computed
  PlaneIrradiance irradiance;       // planes: mirror 1, rims, mirror 2
  std::optional<GridCheck> grid_check;
  std::optional<HeightBands> bands;
  std::vector<FieldRecord> fields;  // in the first draw, that arrive at mirror 1 and at mirror 2; empty: not kept
  std::vector<std::string> warnings;

  double loss() const;  // mean over the draws of the heights
};

// `key`: of the record; `power`: W.
WaveRecord record_of(World const&, ArmWaves const&, std::string key, double power);
// What rims, mirrors and the light on baffles need of it again: all but the field of the mode; the ledger of each draw
// is their mean. Throws InputError as arm_cavity().
ArmWaves waves_of(World const&, WaveSettings const&, ArmCavity planned, WaveRecord const&);

}  // namespace straytrace::wave
