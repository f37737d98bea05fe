// SPDX-License-Identifier: BSD-3-Clause
// Ray matrices (ABCD) of one transverse axis and of both. A ray beside the chief ray is (x, p) or (x, y, px, py):
// offset in m, and slope times the index of its medium, so that every matrix is symplectic and one without loss of its
// own.
#pragma once

#include <Eigen/Core>

#include <complex>

#include "beams/face.hpp"

namespace straytrace {

using AxisMatrix = Eigen::Matrix2d;
using RayMatrix = Eigen::Matrix4d;

AxisMatrix axis_flight(double length, double n = 1);                // through a medium of index n
AxisMatrix axis_mirror(double roc);                                 // RoC > 0: concave
AxisMatrix axis_lens(double focal_length);                          // thin; positive when it focuses
AxisMatrix axis_face(double roc, double n_before, double n_after);  // RoC > 0: concave seen from where the light comes

RayMatrix ray_flight(double length, double n = 1);
RayMatrix ray_face(FaceMap const&);
// Two axes that know nothing of each other.
RayMatrix both_axes(AxisMatrix const& x, AxisMatrix const& y);

// Beam parameter q = z + i z_R over the index of the medium (physics.md 0.3): with the vacuum wavelength it gives the
// radius in every medium.
using BeamParameter = std::complex<double>;
BeamParameter transformed(AxisMatrix const&, BeamParameter);  // eq. 6.2
double beam_radius(BeamParameter, double wavelength);         // 1/e^2 intensity radius, m
double wavefront_curvature(BeamParameter);                    // 1/m, positive when diverging

// Complex curvature times the index, n Q, 1/m.
Eigen::Matrix2cd transformed(RayMatrix const&, Eigen::Matrix2cd const& n_q);

}  // namespace straytrace
