// SPDX-License-Identifier: BSD-3-Clause
// A ring or folded cavity of a scene as the planes of a wave computation (docs/theory/wave.md, eq. W.53 to W.55).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "wave/arm/arm_cavity.hpp"
#include "wave/round_trip.hpp"
#include "world/model/wave_settings.hpp"

namespace straytrace::wave {

// Unit vectors of the coordinates across a leg. Behind a mirror they are the images of those before it.
struct CrossFrame {
  Vec3 x, y, travel;
  CrossFrame behind(Vec3 normal) const;
};
// Where the axis meets a mirror, with the frame of the light that comes.
struct MirrorFrame {
  Vec3 point;
  CrossFrame frame;
  Vec3 normal;  // of the mirror, unit
  Vec3 across;  // of the plane of incidence, unit
};

// What the light meets, in the order of a round trip. A mirror of a folded cavity is met twice, and a baffle about two
// legs as well.
struct RingStop {
  SurfaceId surface;
  bool mirror = false;
  std::size_t leg = 0;               // that leads to it: from the mirror before
  double along = 0;                  // m, from that mirror
  double incidence = 0;              // rad
  std::array<AxisBeam, 2> arriving;  // the mode, in the plane of incidence and across it
  // Of mirrors: power scattered beyond the crossover angle (eq. W.2), and rms of the heights in the map, m.
  double scattered = 0, roughness = 0;
};

struct RingCavity {
  std::vector<RingStop> stops;    // as those of `trip`; the last is the first mirror of `cavity`
  std::array<AxisBeam, 2> start;  // the mode behind that mirror
  std::array<double, 2> gouy{};   // lag of each order per round trip, in the plane of incidence and across it; rad
  double crossover = 0;           // rad
  bool scaled = false;            // the grid follows the beam (eq. W.54)
  Trip trip;
  std::vector<MirrorFrame> frames;             // at the mirrors among the stops, in their order
  std::vector<std::optional<HeightMap>> maps;  // as `mirrors` of the settings: measured, without low orders
  std::vector<ArmProblem> problems;
  std::vector<std::string> warnings;  // of the solution

  double length() const;                                // of the round trip, m
  MirrorFrame const& frame_at(std::size_t stop) const;  // of a mirror
};
// Planes, crossover angle and grid, with all that is wrong with them; no field and no heights.
RingCavity planned_ring(World const&, WaveSettings const&);

// The grid of a ring or folded cavity (docs/theory/wave.md, eq. W.5, W.6, W.54).

// Chooses the crossover angle, window, points and scales that the settings do not state, with problems where those
// stated do not carry the light.
void choose_ring_grid(RingCavity&, WaveSettings const&);
// Curvature of the spherical wave that the grid follows behind a stop, and of that which comes to it (eq. W.54). 1/m
double followed_behind(Trip const&, std::size_t stop);
double followed_before(Trip const&, std::size_t stop);
double needed_memory(RingCavity const&);  // bytes, of the fields

// Heights of the mirrors of a ring or folded cavity, as the light that falls on them at an angle sees them
// (docs/theory/wave.md, eq. W.20, W.55).

// The power that its mirrors scatter beyond the crossover angle, and the measured maps, with problems of maps and
// defects.
void plan_ring_heights(RingCavity&, World const&, WaveSettings const&);
// Heights of each mirror below the crossover angle, as its settings have them: measured, random with the spectrum of
// its BSDF, or none; with defects.
void add_ring_heights(RingCavity&, World const&, WaveSettings const&);

}  // namespace straytrace::wave
