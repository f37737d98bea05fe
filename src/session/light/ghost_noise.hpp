// SPDX-License-Identifier: BSD-3-Clause
// Ghosts through the same noise stage as scattered light.
#pragma once

#include <optional>
#include <vector>

#include "results/ghosts/ghost_table.hpp"
#include "session/model.hpp"

namespace straytrace::session {

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
