// SPDX-License-Identifier: BSD-3-Clause
// The axis and the mode of a cavity of spherical mirrors at any incidence, linear, folded or ring: the ray that closes
// on itself, and the eigenmode about it (docs/theory/beams.md, eq. 6.2).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "beams/mode.hpp"

namespace straytrace::beams {

struct SphericalMirror {
  Vec3 vertex, axis;     // m; unit normal there, on the side of the light
  double curvature = 0;  // 1/RoC, positive when concave towards the light. 1/m
};

// Where the closed ray meets mirrors, in the order of a round trip; a mirror may occur more than once. The length of
// the way is stationary there (Fermat). NumericalError if there is no such ray near the vertices, or any number.
std::vector<Vec3> closed_axis(std::span<SphericalMirror const>);

struct ClosedCavity {
  Mode start;                  // behind the first mirror, e2 along `normal`, or as nearly as possible
  std::vector<Mode> arriving;  // at each mirror
  Vec3 normal;                 // of the plane of incidence, unit; its largest component is positive
  // Largest angle between a leg and that plane, rad: a ring of more turns the image.
  double out_of_plane = 0;
  std::array<double, 2> gouy{};  // as in RayEigenmode, in the plane of incidence and along its normal
  double length = 0;             // of the round trip, m
};
// NumericalError as above, and if the cavity is not stable.
ClosedCavity closed_cavity(std::span<SphericalMirror const>, double wavelength);

// n.Q n of a mode along a unit vector across its travel, 1/m.
std::complex<double> curvature_along(Mode const&, Vec3 across);

}  // namespace straytrace::beams
