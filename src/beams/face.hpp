// SPDX-License-Identifier: BSD-3-Clause
// Effect of a mirror or a refracting face on everything paraxial about a chief ray: on the curvature of a beam and on
// the rays near it.
#pragma once

#include <Eigen/Core>

#include "base/math/vec3.hpp"
#include "geometry/common/shape.hpp"

namespace straytrace::beams {

// Points t of the tangent plane (axes of the SurfaceCurvature K) seen across the arriving and the leaving chief ray are
// before t and after t. The surface lies t.K t/2 along the normal N above the plane. That the phases of both waves
// agree on it to second order in t, n_in (a.N K + before^T Q_in before) = n_out (b.N K + after^T Q_out after) with the
// chief rays a and b, is
//   after^T (n_out Q_out) after = before^T (n_in Q_in) before + power.
struct FaceMap {
  Vec3 e1, e2, travel;  // frame of the leaving wave, right-handed
  Eigen::Matrix2d before, after;
  Eigen::Matrix2d power;  // (n_in a.N - n_out b.N) K, 1/m
};

// Frame of the arriving wave, unit normal that the curvature belongs to (towards either side).
FaceMap mirror_face(Vec3 e1, Vec3 e2, Vec3 travel, Vec3 normal, SurfaceCurvature const&, double n);
// NumericalError beyond the critical angle.
FaceMap refracting_face(Vec3 e1, Vec3 e2, Vec3 travel, Vec3 normal, SurfaceCurvature const&, double n_in, double n_out);

// Into an order of a grating, whose phase is linear in t; `out`: direction of the leaving wave on either side.
FaceMap grating_face(Vec3 e1, Vec3 e2, Vec3 travel, Vec3 out, Vec3 normal, SurfaceCurvature const&, double n_in,
                     double n_out);

}  // namespace straytrace::beams
