// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that main beams light, and apertures that clip them: holes around their chief rays, edges beside them, rims
// of mirrors and lenses.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "beams/mode.hpp"
#include "beams/overlap.hpp"
#include "world/ghosts/beam_tree.hpp"
#include "world/ghosts/obstacle.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {

// Apertures of the main beams: holes around their chief rays, edges beside them, and the rims of mirrors and lenses.

// Surfaces that a beam illuminates as it propagates through the scene (docs/theory/recoupling.md): spots of the beam
// tree become footprints, where light leaves the mode and rejoins it.

// Mean over the states that an unpolarised beam consists of.
Polarisation polarisation_of(BeamField const&);

// Place, profile and wavefront of a mode that arrives in a medium of this index.
Footprint footprint_of(Mode const&, double index);

// Phase sensitivities of a beam to the surfaces on its way, k (n_in in - n_out out) for each hit, by body
// (eq. 2.2, 2.3); over the wave number unless k [1/m] is given. Their moments count time from the launch.
std::vector<PhaseSensitivity> phase_sensitivities_of_way(World const&, std::span<BeamStep const>, double k = 1);

// Adds the footprint of a spot. `share`: q of the launched beam; `mirror`: footprint of the cavity mirror that the beam
// was launched through, or Feed::none. On a side without scatter it neither emits nor receives.
void add_lit_surface(World&, std::uint32_t beam, double share, std::uint32_t mirror, BeamSpot const&,
                     std::span<BeamStep const> way);

// The same for a screen: the mode illuminates it outside of the hole, with the power of the energy balance of the tree.
void add_lit_screen(World&, std::uint32_t beam, double share, std::uint32_t mirror, ScreenSpot const&,
                    std::span<BeamStep const> way);

// A row of the list that `straytrace check` prints.
struct LitRow {
  std::uint32_t footprint = 0;
  double major = 0, minor = 0;  // m, 1/e^2 intensity radii across the beam
  double incidence = 0;         // rad, of the chief ray; NaN: it passes beside a surface that is not flat
  double clipped = 0;           // share that passes beside the surface; smaller than `resolution`: not resolved
  double resolution = 0;
  bool scatters = true;
};
std::vector<LitRow> lit_rows(World const&);  // of a finished world; free beams illuminate no surface alone

struct BeamAperture {
  std::uint32_t beam = 0;
  GroupId group;
  SurfaceId surface;
  bool reflected = false;  // the rim of a mirror: the beam is reflected
  double along = 0;        // m, optical, from the start of the beam; of a cavity, from its first mirror
  double clipped = 0;      // share of the power (eq. 5.5, 5.6), at any angle
  // Intensity on the axis: factor in the far field (eq. 5.7), and largest change at any distance, to first order in the
  // wave from the rim. NaN: the rim is not round.
  double axis_far = 0, ripple = 0;
  double tilt = 0;                  // rad, between the normal of the rim and the beam
  double w_major = 0, w_minor = 0;  // m, 1/e^2 radii
  // For the field behind it: a round beam and a round rim across it. x points from the axis of the beam to the centre.
  bool across = false;
  BeamInPlane at;   // leaving the plane of the rim; curvature only if `across`
  Opening opening;  // radius NaN: the rim is not round
  // Of a round rim, what it clips and where it is; otherwise no radius.
  struct Round {
    Vec3 centre, axis;                   // m; unit
    double radius = 0, tooth_depth = 0;  // m; of the tips
    Mode mode;                           // that arrives
    // Share of the power outside of it, mean over the height of its teeth.
    double clipped() const;
  } round{};
  // Of another flat rim, in its plane.
  struct Flat {
    FlatRim rim;
    Mode mode;            // that arrives
    bool screen = false;  // takes what falls on it; false: what falls beside it
  };
  std::optional<Flat> flat{};
  bool standing = false;  // between the mirrors of a cavity, or one of these
  // Of a launched beam of which more than half has come here: light of the network, or not through a mirror of a
  // cavity. False on the mirrors of a cavity.
  bool main_way = false;
};

// Beam by beam, in the order along each.
std::vector<BeamAperture> apertures_of(World const&);

// Where the phase error of the paraxial wave from the rim, k r^4/(8 z^3), is 1 rad; m.
double paraxial_beyond(BeamAperture const&);

// Intensity across the beam at a distance [m] behind a rim that is `across`, with and without it, over that on the axis
// in the plane of the rim. Out to twice the radius of the beam; `name` of the rim, for errors.
struct ApertureProfile {
  std::vector<double> x, with, without;  // m
};
ApertureProfile profile_behind(BeamAperture const&, std::string const& name, double distance, std::size_t points);

// Where the main beam loses more than the share `least` of its remaining power, down to a tenth of the launched power,
// or of the power that the mirror of a cavity transmits.
struct MainLoss {
  std::uint32_t beam = 0;
  SurfaceId surface;
  double share = 0;
  bool beside = false;  // beside the surface that it meets; false: on a screen
};
std::vector<MainLoss> main_losses(World const&, double least = 0.01);

}  // namespace straytrace::world
