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
  std::atomic<bool> const* stop = nullptr;  // once true, what has not been followed is booked so
  std::function<void(BeamLaunch const&, std::uint64_t ended, char const* doing)> progress;  // now and then
};

// Strong ghosts, found in milliseconds where a scene says nothing of them.
inline GhostSettings quick_search() { return {.floor = 1e-12, .order = 2}; }

// Everything about one launched beam; `each`, if any, gets every ghost. NumericalError when the energy balance does not
// close.
GhostReport ghost_report(GhostSearch const&, BeamLaunch const&,
                         std::function<void(GhostTable const&, Ghost const&)> const& each);

// Throws InputError, with the reasons, when no ghost of any of these beams can have an h.
void require_strain(GhostSearch const&, std::vector<BeamLaunch> const&);

// Ghosts that a scene does not count.

// A scene that says nothing of `ghosts` while some come back to a port: a warning with the power and the strain that
// a quick search finds. `ghosts: off` says that it is known.
void warn_of_uncounted_ghosts(Model const&);

}  // namespace straytrace::session
