// SPDX-License-Identifier: BSD-3-Clause
// What one hit adds to the phase Jacobians of a path (docs/theory/motion.md, eq. 2.3).
#pragma once

#include <vector>

#include "world/model/world.hpp"

namespace straytrace {

// The entry of a body, made where there is none.
PhaseSensitivity& phase_sensitivity_of(std::vector<PhaseSensitivity>&, BodyId);

// Adds kappa [rad/m], its moment about the pivot of the body, and kappa . psi for each elastic mode of it. A surface of
// no body (a measuring plane) adds nothing.
void add_hit(std::vector<PhaseSensitivity>&, World const&, SurfaceId, Vec3 point, Vec3 kappa);

}  // namespace straytrace
