// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that a beam illuminates as it propagates through the scene (docs/theory/recoupling.md): spots of the beam
// tree become footprints, where light leaves the mode and rejoins it.
#pragma once

#include <span>
#include <vector>

#include "world/ghosts/beam_tree.hpp"

namespace straytrace::world {

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

}  // namespace straytrace::world
