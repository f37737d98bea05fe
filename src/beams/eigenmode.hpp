// SPDX-License-Identifier: BSD-3-Clause
// Eigenmodes of cavities from their round-trip ray matrices: linear, folded, ring and twisted ones
// (docs/theory/beams.md, eq. 6.2; the closed forms of two mirrors are in beams/cavity_mode.hpp).
#pragma once

#include <Eigen/Core>

#include <array>
#include <complex>
#include <span>
#include <string>
#include <vector>

#include "base/math/vec3.hpp"
#include "beams/mode.hpp"
#include "geometry/shapes/shape.hpp"

namespace straytrace::beams {

// Effect of a mirror or a refracting face on everything paraxial about a chief ray: on the curvature of a beam and on
// the rays near it.

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

// Ray matrices (ABCD) of one transverse axis and of both. A ray near the chief ray is (x, p) or (x, y, px, py):
// offset in m, and slope times the index of its medium, so that every matrix is symplectic and one without loss of its
// own.

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

// Reason why the cavity is unstable; empty when it is stable.
std::string instability(AxisMatrix const& round_trip);
std::string instability(RayMatrix const& round_trip);

// The field that reproduces itself after a round trip. `gouy`: phase by which a mode of one order more along the axis
// lags per round trip, rad in [0, 2 pi); its distance in frequency is gouy/(2 pi) of the free spectral range.
// Left-right images of a ring with an odd number of mirrors are in it.
struct AxisEigenmode {
  BeamParameter q;  // over the index at the start of the round trip
  double gouy = 0;
};
struct RayEigenmode {
  Eigen::Matrix2cd n_q;             // n Q at the start of the round trip, 1/m
  std::array<double, 2> gouy = {};  // of x and y where these are independent
};
// Both throw NumericalError with the reason when the cavity is unstable or its mode is not unique.
AxisEigenmode eigenmode(AxisMatrix const& round_trip);
RayEigenmode eigenmode(RayMatrix const& round_trip);

// Cavity in space. `start` gives where the round trip begins, its frame and the wavelength in the medium there, of
// index `index`; its Q is not used. The elements lead back to its origin and direction.
struct CavityEigenmode {
  Mode mode;                        // at the start
  std::array<double, 2> gouy = {};  // as in RayEigenmode
  double tem00_gouy = 0;            // lag of TEM00 per round trip, rad, counted on without jumps
  double optical_length = 0;        // of the round trip, m
};
CavityEigenmode cavity_eigenmode(Mode const& start, double index, std::span<OpticalElement const>);

// The axis and the mode of a cavity of spherical mirrors at any incidence, linear, folded or ring: the ray that closes
// on itself, and the eigenmode about it (docs/theory/beams.md, eq. 6.2).

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
