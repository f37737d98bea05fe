// SPDX-License-Identifier: BSD-3-Clause
// Overlap of two beams: tilt, shift, mismatch and astigmatism in one closed form
// (docs/theory/beams.md, eq. 5.1-5.3 are special cases).
#pragma once

#include <Eigen/LU>

#include <array>
#include <complex>

#include "beams/mode.hpp"

namespace straytrace::beams {

// Integral of u1 conj(u2) over a plane across both beams, each field with phase zero at its own origin. The origins may
// lie anywhere and the chief rays need not be parallel nor meet; the value does not depend on the plane. Zero when the
// beams run apart by a right angle or more. Both in the same medium: NumericalError when the wavelengths differ.
std::complex<double> overlap(Mode const&, Mode const&);
// Share of the power of one beam in the mode of the other: |overlap|^2.
double power_overlap(Mode const&, Mode const&);
// Its natural logarithm, also where the share is too small for a number; minus infinity when the beams run apart by a
// right angle or more.
double log_power_overlap(Mode const&, Mode const&);

// Change of ln overlap(u, v) to first order when u moves: its chief ray by `shift` [m] at its origin and by `turn`
// [rad] of its direction, both across its travel. The field keeps its phase on the moved ray, where a phase that is
// stationary along the ray (eq. 2.2) is taken: what is left is the change of the overlap (eq. N.27). For motion of v
// take the conjugate of that of overlap(v, u).
struct OverlapSlope {
  std::array<std::complex<double>, 3> shift{}, turn{};  // 1/m, 1/rad; vectors of space
  std::complex<double> of(Vec3 moved, Vec3 turned) const {
    return shift[0] * moved.x + shift[1] * moved.y + shift[2] * moved.z + turn[0] * turned.x + turn[1] * turned.y +
           turn[2] * turned.z;
  }
};
// Zero when the beams run apart by a right angle or more.
OverlapSlope overlap_slope(Mode const& u, Mode const& v);

// Field of a beam on a plane that it crosses at a small angle, and the product of two such fields.

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

// u conj(v) = exp(log_amplitude + i k (g.d + d.S d/2)) with d measured from the centre of v.
struct FieldProduct {
  double k = 0;
  std::complex<double> log_amplitude;
  Eigen::Vector2cd g;
  Eigen::Matrix2cd s;

  std::complex<double> log_integral() const;
};
FieldProduct product(PlaneField const& u, PlaneField const& v);

}  // namespace straytrace::beams
