// SPDX-License-Identifier: BSD-3-Clause
// Gaussian beams of general astigmatism in space: flight, mirrors and refracting faces met at any angle
// (docs/theory/conventions.md and section 6; docs/theory/beams.md). Host only: the trace reads footprints, which are
// made of these.
#pragma once

#include <array>
#include <cmath>
#include <complex>

#include "base/math/vec3.hpp"

namespace straytrace::geometry {
struct SurfaceCurvature;  // geometry/curvature.hpp
}  // namespace straytrace::geometry

namespace straytrace::beams {

// Fundamental mode about a chief ray. In the plane across `travel` at `origin`, with r = (x along e1, y along e2),
//   u = sqrt(k sqrt(det Im Q) / pi) exp(i k/2 r.Q r),   k = 2 pi/wavelength,   integral of |u|^2 over the plane = 1,
// so the phase at `origin` is zero. Circular beam: Q = 1/RoC + i wavelength/(pi w^2) times unity.
struct Mode {
  Vec3 origin, e1{1, 0, 0}, e2{0, 1, 0}, travel{0, 0, 1};  // m; right-handed unit vectors: e1 x e2 = travel
  double wavelength = 0;                                   // m, in the medium
  std::complex<double> q11, q12, q22;                      // Q in 1/m; Im Q is positive definite

  double wave_number() const { return 2 * pi / wavelength; }  // rad/m, in the medium
};

// Spot of 1/e^2 intensity radius w [m]; curvature of the wavefront in 1/m, positive when the beam diverges.
Mode circular_mode(Vec3 origin, Vec3 travel, double w, double curvature, double wavelength);
// Radii and curvatures along e1 and e2, a unit vector at right angles to `travel`.
Mode elliptic_mode(Vec3 origin, Vec3 e1, Vec3 travel, std::array<double, 2> w, std::array<double, 2> curvature,
                   double wavelength);

// Free flight by a geometric distance [m] in the medium, also backwards: Q -> Q (1 + z Q)^-1.
Mode propagated(Mode const&, double distance);
// Lag of the phase behind a plane wave over that flight, rad, with no jump at any distance: the field on the axis gains
// exp(i (k z - gouy)). Sum of half the phases of the two axes.
double gouy(Mode const&, double distance);
// Phases arg(1 + z q) of the two eigenvalues q of Q, that of e1 first when q12 = 0. The mode of orders (n, m) along
// these axes lags by (n + 1/2) first + (m + 1/2) second.
std::array<double, 2> axis_gouy(Mode const&, double distance);

// At a surface through `origin`, which the chief ray meets there. `normal` is the unit normal that `curvature` is given
// for; either side will do. Phases agree on the surface to second order: mirror of any curvature at any incidence.
Mode reflected(Mode const&, Vec3 normal, SurfaceCurvature const&);
// Refracting face between media of index n_in and n_out. NumericalError beyond the critical angle.
Mode refracted(Mode const&, Vec3 normal, SurfaceCurvature const&, double n_in, double n_out);
// Into an order of a grating of that direction, on the side of n_out.
Mode diffracted(Mode const&, Vec3 out, Vec3 normal, SurfaceCurvature const&, double n_in, double n_out);
// The same beam run backwards: the field is the complex conjugate.
Mode reversed(Mode const&);

// |u|^2 [1/m^2] at a point of space, and u [1/m] with the phase that grows along the beam from zero at `origin`.
double intensity(Mode const&, Vec3 p);
std::complex<double> field(Mode const&, Vec3 p);

// Ellipse where |u|^2 falls to 1/e^2 of its middle, in the plane at `origin`: half axes in m; `axis` along the major.
struct Spot {
  double major = 0, minor = 0;
  Vec3 axis;
};
Spot spot(Mode const&);

// Symmetric 2x2 matrices, real or complex: curvatures and sizes of beams in a plane.

// Eigenvalues, the one nearer to m11 first.
template <class T>
std::array<T, 2> eigenvalues(T m11, T m12, T m22) {
  using std::abs, std::sqrt;
  T const mean = 0.5 * (m11 + m22), half = 0.5 * (m11 - m22), root = sqrt(half * half + m12 * m12);
  T const one = mean + root, two = mean - root;
  return abs(one - m11) <= abs(two - m11) ? std::array{one, two} : std::array{two, one};
}

// Angle from the first axis to the direction of the larger eigenvalue of a real matrix, rad.
inline double larger_axis(double m11, double m12, double m22) { return 0.5 * std::atan2(2 * m12, m11 - m22); }

}  // namespace straytrace::beams
