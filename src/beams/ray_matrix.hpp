// SPDX-License-Identifier: BSD-3-Clause
// Ray matrices (ABCD) of one transverse axis and of both. A ray near the chief ray is (x, p) or (x, y, px, py):
// offset in m, and slope times the index of its medium, so that every matrix is symplectic and one without loss of its
// own.
#pragma once

#include <Eigen/Core>

#include <complex>
#include <span>
#include <vector>

#include "beams/face.hpp"
#include "beams/mode.hpp"

namespace straytrace::beams {

using AxisMatrix = Eigen::Matrix2d;
using RayMatrix = Eigen::Matrix4d;

// Two uncoupled axes.
RayMatrix both_axes(AxisMatrix const& x, AxisMatrix const& y);

// Beam parameter q = z + i z_R over the index of the medium (docs/theory/conventions.md): with the vacuum wavelength it
// gives the radius in every medium.
using BeamParameter = std::complex<double>;

// Complex curvature times the index, n Q, 1/m.
Eigen::Matrix2cd transformed(RayMatrix const&, Eigen::Matrix2cd const& n_q);

// A beam through a given list of mirrors and refracting faces: telescopes, cavities, benches. (In a scene the beam tree
// finds the list itself.)

struct OpticalElement {
  Vec3 point, normal;  // where the chief ray meets it, m; unit normal, either side
  SurfaceCurvature curvature;
  bool reflects = true;
  double index_after = 1;  // of the medium behind a refracting face
};
// RoC > 0: concave seen from the side that `normal` points to, infinite: flat.
OpticalElement spherical_mirror(Vec3 point, Vec3 normal, double roc);
// Mirrors that send a ray from point to point, each concave towards it for RoC > 0. `closed`: from the last back to the
// first, whose mirror is the last element; the ray starts there. Otherwise the first and the last point have no mirror
// and their RoC is not used.
std::vector<OpticalElement> mirrors_through(std::span<Vec3 const> points, std::span<double const> roc, bool closed);

struct BeamPath {
  Mode mode;                               // behind the last element, its origin there
  double index = 1;                        // of the medium there
  double gouy = 0;                         // lag of the phase of TEM00 since the start, rad, counted on without jumps
  double optical_length = 0;               // m
  RayMatrix rays = RayMatrix::Identity();  // from the frame at the start to that of `mode`
  std::vector<Mode> arriving;              // at every element
};
// NumericalError when the chief ray does not meet an element at its point, or meets it behind the start of the path.
BeamPath follow(Mode const& start, double index, std::span<OpticalElement const>);

}  // namespace straytrace::beams
