// SPDX-License-Identifier: BSD-3-Clause
// Ghosts through the same noise stage as scattered light.
#pragma once

#include <vector>

#include "app/model.hpp"
#include "report/ghost_table.hpp"

namespace straytrace {

// A deterministic class for each family of equal levers (eq. 10.5: fields added within it); powers of classes add.
std::vector<CouplingClass> ghost_classes(GhostFamilies const&);

// Strain of each family for the motion and the interferometer of the model, into the families; returns that of all.
GhostStrain project_ghosts(Model const&, GhostFamilies&);

}  // namespace straytrace
