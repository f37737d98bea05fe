// SPDX-License-Identifier: BSD-3-Clause
// Directions behind a boundary and of the orders of a grating. All directions are unit vectors along the travel.
#pragma once

#include "base/math/vec3.hpp"

namespace straytrace {

// Snell's law as a vector (docs/theory/surfaces.md, eq. 3.25): `normal` is a unit vector towards the side the light
// comes from. False beyond the critical angle.
STRAY_HD bool refracted(Vec3 dir, Vec3 normal, double n_in, double n_out, Vec3& out) {
  Vec3 const along = (n_in / n_out) * (dir - dot(dir, normal) * normal);  // tangential part, conserved times n
  double const square = 1 - length2(along);
  if (!(square >= 0)) return false;
  out = unit(along - std::sqrt(square) * normal);
  return true;
}

// Order of a grating (docs/theory/surfaces.md, eq. 3.26, in every plane): n_out t_out = n_in t_in + order lambda f,
// where t are the tangential parts of the directions and f [1/m] is the spatial frequency of the grooves, across them
// and in the surface. `normal` points to the side the light comes from; `through`: into the medium behind. False when
// the order does not propagate.
STRAY_HD bool diffracted(Vec3 dir, Vec3 normal, double n_in, double n_out, Vec3 frequency, int order, double wavelength,
                         bool through, Vec3& out) {
  Vec3 const tangent =
      n_in * (dir - dot(dir, normal) * normal) + (order * wavelength) * (frequency - dot(frequency, normal) * normal);
  Vec3 const along = (1 / (through ? n_out : n_in)) * tangent;
  double const square = 1 - length2(along);
  if (!(square >= 0)) return false;
  out = unit(along + (through ? -1.0 : 1.0) * (std::sqrt(square) * normal));
  return true;
}

}  // namespace straytrace
