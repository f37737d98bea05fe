// SPDX-License-Identifier: BSD-3-Clause
// Rims that clip the main beam and move: what they take from it changes with their place (docs/theory/diffraction.md,
// eq. N.11 for round rims, N.21 for flat ones of any outline, as integrals along their edges).
#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

#include "trace/coupling.hpp"
#include "world/ghosts/apertures.hpp"

namespace straytrace::trace {

using CoordinateGradient = Eigen::Vector<double, 6>;
using CoordinateCurvature = Eigen::Matrix<double, 6, 6>;

// The field that passes, K_00 = 1 - removed, and its derivatives by the coordinates of the body of the rim: world axes,
// then rotations about its pivot; per m, per rad. The beam is at rest.
struct RimDerivatives {
  double removed = 0;
  CoordinateGradient slope = CoordinateGradient::Zero();
  CoordinateCurvature curvature = CoordinateCurvature::Zero();
};

RimDerivatives rim_derivatives(world::BeamAperture::Flat const&, Vec3 pivot);
RimDerivatives rim_derivatives(world::BeamAperture::Round const&, Vec3 pivot);

struct MovingRimClasses {
  std::vector<CouplingClass> classes;
  std::vector<std::string> warnings;  // rims without a route, and why
};
// One class for each port and object: flat rims on bodies, passed by the main beam of the port. The fields of the rims
// of one object add.
MovingRimClasses moving_rim_classes(World const&);

}  // namespace straytrace::trace
