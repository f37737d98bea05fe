// SPDX-License-Identifier: BSD-3-Clause
// All ghosts of one launched beam, summed up.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "results/ghosts/ghost_table.hpp"
#include "session/model.hpp"

namespace straytrace::session {

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

}  // namespace straytrace::session
