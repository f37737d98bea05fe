// SPDX-License-Identifier: BSD-3-Clause
// What a beam leaves on a plane that it crosses at a small angle, and the product of two of these.
#pragma once

#include <Eigen/LU>

#include "beams/mode.hpp"

namespace straytrace {

// Through `point`, unit axes t1 and t2; the beams run along t1 x t2, more or less.
struct Plane {
  Vec3 point, t1, t2;
  Vec3 normal() const { return cross(t1, t2); }
};

// exp(log_amplitude + i k (slope.d + d.Q d/2)), d = t - centre, with t in m from the point of the plane. The integral
// of
// |.|^2 over the plane is 1: it holds the root of the cosine between beam and normal.
struct PlaneField {
  double k = 0;  // rad/m
  std::complex<double> log_amplitude;
  Eigen::Vector2d centre, slope;
  Eigen::Matrix2cd q;  // 1/m
};
PlaneField on_plane(Mode const&, Plane const&);

// u conj(v) = exp(log_amplitude + i k (g.d + d.S d/2)) with d counted from the centre of v.
struct FieldProduct {
  double k = 0;
  std::complex<double> log_amplitude;
  Eigen::Vector2cd g;
  Eigen::Matrix2cd s;

  std::complex<double> log_integral() const;
};
FieldProduct product(PlaneField const& u, PlaneField const& v);

}  // namespace straytrace
