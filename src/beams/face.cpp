// SPDX-License-Identifier: BSD-3-Clause
#include "beams/face.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"
#include "optics/coating/fresnel.hpp"

namespace straytrace::beams {

namespace {

Eigen::Matrix2d seen_across(Vec3 e1, Vec3 e2, SurfaceCurvature const& c) {
  Eigen::Matrix2d m;
  m << dot(e1, c.a), dot(e1, c.b), dot(e2, c.a), dot(e2, c.b);
  return m;
}

Eigen::Matrix2d tensor(SurfaceCurvature const& c) {
  Eigen::Matrix2d k;
  k << c.aa, c.ab, c.ab, c.bb;
  return k;
}

}  // namespace

FaceMap mirror_face(Vec3 e1, Vec3 e2, Vec3 travel, Vec3 normal, SurfaceCurvature const& curvature, double n) {
  FaceMap face;
  face.travel = unit(reflected(travel, normal));
  face.e1 = unit(reflected(e1, normal));
  face.e2 = cross(face.travel, face.e1);  // a mirror image is left-handed: minus the image of e2
  face.before = seen_across(e1, e2, curvature);
  face.after = seen_across(face.e1, face.e2, curvature);
  face.power = n * (dot(travel, normal) - dot(face.travel, normal)) * tensor(curvature);
  return face;
}

FaceMap refracting_face(Vec3 e1, Vec3 e2, Vec3 travel, Vec3 normal, SurfaceCurvature const& curvature, double n_in,
                        double n_out) {
  FaceMap face;
  double const cosine = dot(travel, normal);
  if (!optics::refracted(travel, cosine < 0 ? normal : -normal, n_in, n_out, face.travel))
    throw NumericalError(
        fmt::format("a beam meets the face between index {:.4g} and {:.4g} beyond the critical angle: incidence {:.4g} "
                    "degrees",
                    n_in, n_out, std::acos(std::fabs(cosine)) * 180 / pi));
  // The rotation in the plane of incidence that takes `travel` to its new direction.
  Vec3 const both = travel + face.travel;
  face.e1 = unit(e1 - (dot(e1, face.travel) / (1 + dot(travel, face.travel))) * both);
  face.e2 = cross(face.travel, face.e1);
  face.before = seen_across(e1, e2, curvature);
  face.after = seen_across(face.e1, face.e2, curvature);
  face.power = (n_in * cosine - n_out * dot(face.travel, normal)) * tensor(curvature);
  return face;
}

FaceMap grating_face(Vec3 e1, Vec3 e2, Vec3 travel, Vec3 out, Vec3 normal, SurfaceCurvature const& curvature,
                     double n_in, double n_out) {
  FaceMap face;
  face.travel = out;
  Vec3 const near = std::fabs(dot(e1, out)) < std::fabs(dot(e2, out)) ? e1 : e2;
  face.e1 = unit(near - dot(near, out) * out);
  face.e2 = cross(out, face.e1);
  face.before = seen_across(e1, e2, curvature);
  face.after = seen_across(face.e1, face.e2, curvature);
  face.power = (n_in * dot(travel, normal) - n_out * dot(out, normal)) * tensor(curvature);
  return face;
}

}  // namespace straytrace::beams
