// SPDX-License-Identifier: BSD-3-Clause
// Rims that clip the main beam and move: what they take from it changes with their place (docs/theory/diffraction.md,
// eq. N.11 and N.21).
#pragma once

#include <string>
#include <vector>

#include "trace/coupling.hpp"
#include "trace/deterministic/rim_edges.hpp"
#include "world/ghosts/apertures.hpp"

namespace straytrace::trace {

RimDerivatives rim_derivatives(world::BeamAperture::Round const&, Vec3 pivot);

constexpr double least_removed = 1e-12;  // of the field: rims that take less have no route

struct MovingRimClasses {
  std::vector<CouplingClass> classes;
  std::vector<std::string> warnings;  // rims without a route, and why
};
// One class for each port and object: flat rims on bodies, passed by the main beam of the port. The fields of the rims
// of one object add.
MovingRimClasses moving_rim_classes(World const&);

}  // namespace straytrace::trace
