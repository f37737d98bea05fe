// SPDX-License-Identifier: BSD-3-Clause
// Paths of first order and paths computed without a trace, for the path table and pages.
#pragma once

#include <vector>

#include "report/scene_drawing.hpp"
#include "results/ghosts/ghost_table.hpp"
#include "session/options.hpp"
#include "trace/coupling.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {

struct FirstOrderOptions : SceneOptions {
  std::optional<std::uint64_t> histories;
  std::string by;  // "port", "receiver"; empty: both
  bool csv = false;
  std::size_t show = 0;  // rows; 0: as in the scene
};

// straytrace paths FILE --first-order: illuminated objects, critical objects, and both. Returns the exit code.
int print_first_order(FirstOrderOptions const&);

// Of an entry of these lists, whose histories are batches: with fewer the spread does not give the error.
constexpr std::uint64_t least_batches = 4;
inline bool resolved(Estimate const& e) { return e.scored >= least_batches; }

// Paths of computed routes as lines: ghosts by the beam tree, and diffraction at edges.

// Of one such route, at most so many: by points of its rims, evenly over rims and azimuths, or of the ghosts in the
// rows that go this way; none when no row does.
std::vector<DrawnPath> computed_paths(World const&, CouplingClass const&, std::vector<GhostReport> const&,
                                      std::size_t most);

}  // namespace straytrace::session
