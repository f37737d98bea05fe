// SPDX-License-Identifier: BSD-3-Clause
// A beam through a given list of mirrors and refracting faces: telescopes, cavities, benches. (In a scene the beam tree
// finds the list itself.)
#pragma once

#include <span>
#include <vector>

#include "beams/mode.hpp"
#include "beams/ray_matrix.hpp"

namespace straytrace {

struct OpticalElement {
  Vec3 point, normal;  // where the chief ray meets it, m; unit normal, either side
  SurfaceCurvature curvature;
  bool reflects = true;
  double index_after = 1;  // of the medium behind a refracting face
};
// Spherical mirror or face; RoC > 0: concave seen from the side that `normal` points to, infinite: flat.
OpticalElement spherical_mirror(Vec3 point, Vec3 normal, double roc);
OpticalElement spherical_face(Vec3 point, Vec3 normal, double roc, double index_after);
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
// NumericalError when the chief ray does not meet an element at its point, or meets it from behind its path.
BeamPath follow(Mode const& start, double index, std::span<OpticalElement const>);

}  // namespace straytrace
