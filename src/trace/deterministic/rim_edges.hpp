// SPDX-License-Identifier: BSD-3-Clause
// What a flat rim of any outline takes from a beam, and its derivatives by the place of the rim, as integrals along its
// edges (docs/theory/diffraction.md, eq. N.21).
#pragma once

#include <Eigen/Core>

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

Vec3 turned(Vec3, Vec3 by);  // by: rad about its direction

RimDerivatives rim_derivatives(world::BeamAperture::Flat const&, Vec3 pivot);
double size_of(world::FlatRim const&);  // m, from its centre to the edge, along the longer axis

}  // namespace straytrace::trace
