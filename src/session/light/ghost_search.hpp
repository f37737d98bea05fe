// SPDX-License-Identifier: BSD-3-Clause
// Ghosts of the beams of a scene: their search, sums, and noise.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include "results/ghosts/ghost_table.hpp"
#include "session/model.hpp"

namespace straytrace::session {

// All ghosts of one launched beam, summed up.

struct GhostSearch {
  Model const& model;
  GhostSettings settings;
  GhostRank rank = GhostRank::power;
  std::size_t show = 0;                     // ghosts kept as rows
  std::atomic<bool> const* stop = nullptr;  // once true, the rest counts as not followed
  std::function<void(BeamLaunch const&, std::uint64_t ended, char const* doing)> progress;  // now and then
};

// Strong ghosts, found in milliseconds, for scenes without `ghosts`.
inline GhostSettings quick_search() { return {.floor = 1e-12, .order = 2}; }

// Results for one launched beam; `each`, if any, gets every ghost. NumericalError when the energy balance does not
// close.
GhostReport ghost_report(GhostSearch const&, BeamLaunch const&,
                         std::function<void(GhostTable const&, Ghost const&)> const& each);

// Throws InputError, with the reasons, when no ghost of any of these beams can have an h.
void require_strain(GhostSearch const&, std::vector<BeamLaunch> const&);

// Ghosts that a scene does not count.

// For a scene without `ghosts` where some return to a port: a warning with the power and the strain of a quick search.
// `ghosts: off` suppresses it.
void warn_of_uncounted_ghosts(Model const&);

// Ghosts through the same noise stage as scattered light.

// The key `ghosts` of a scene, a table or on: limits of the ghosts in the noise of a run; nothing without it or
// when it is off.
std::optional<GhostSettings> read_ghosts(Scene const&);

struct GhostClasses {
  std::vector<CouplingClass> classes;
  std::vector<std::string> warnings;
};

// Classes of all beams of a world, added to the scattered light of its trace.
GhostClasses ghosts_beside(World const&, GhostSettings const&);

// A deterministic class for each route of each family of equal phase sensitivities, the weakest of many together;
// powers of classes add. With GhostSum::coherent one class for the `most_coherent` strongest families of the beam,
// whose fields add (eq. 10.5); a warning states the omitted light.
GhostClasses ghost_classes(World const&, GhostFamilies const&);

// Strain of each family for the motion and the interferometer of the model, into the families; returns that of all.
GhostStrain project_ghosts(Model const&, GhostFamilies&);

}  // namespace straytrace::session
