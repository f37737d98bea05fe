// SPDX-License-Identifier: BSD-3-Clause
// A Gaussian beam at an aperture (docs/theory/beams.md, eq. 5.5 to 5.7): the power that it loses, and its field behind.
#pragma once

#include <array>
#include <complex>

#include "beams/mode.hpp"

namespace straytrace::beams {

// Shares of the power of the beam, which keep their relative accuracy however small they are.

// Circular aperture of radius a, beam of 1/e^2 intensity radius w, centred (eq. 5.5) or a distance off (eq. 5.6). m
double clipped_share(double aperture, double w);
double clipped_share(double aperture, double w, double offset);
// Elliptic beam of radii w along x and y, its middle at `offset` from the middle of the aperture.
double clipped_share(double aperture, std::array<double, 2> w, std::array<double, 2> offset);

// A round hole in a screen, met by a beam at any angle that is not grazing.
struct Aperture {
  Vec3 centre, normal;  // m; unit normal, either side
  double radius = 0;    // m
};
double clipped_share(Aperture const&, Mode const&);

// Behind a circular aperture: Fresnel integral at any distance, hard or serrated rim, beam off centre (R2.26, R2.27).

// The beam in the plane of the aperture: u = exp(-rho^2/w^2 + i k rho^2 curvature/2), 1 on its axis.
struct BeamInPlane {
  double w = 0;          // 1/e^2 intensity radius, m
  double curvature = 0;  // of the wavefront, 1/m, positive when diverging
  double wavelength = 0;
};

// An opening in a black screen across the beam. Triangular teeth on the rim reach from radius - tooth_height/2 (tips)
// to radius + tooth_height/2 (valleys).
struct Opening {
  double radius = 0;        // m, of the mean rim
  double x = 0, y = 0;      // m, its centre, from the axis of the beam
  double tooth_height = 0;  // m, from tip to valley
  unsigned teeth = 0;       // around the rim, all equal; 0: heights at random, and the mean field is meant
  double phase = 0;         // rad, azimuth of a tip
};

double clipped_share(BeamInPlane const&, Opening const&);  // of the power (eq. 5.5, 5.6)

// Field at (x, y) from the axis of the beam and `distance` > 0 behind the aperture, in the units of the beam; the
// factor exp(i k distance) is left out. Paraxial: distance^3 >> k (offset from the rim)^4/8. Throws NumericalError
// where the integral has more than about 1e5 periods.
std::complex<double> field_behind(BeamInPlane const&, Opening const&, double distance, double x, double y);
std::complex<double> free_field(BeamInPlane const&, double distance, double x, double y);  // without the aperture

}  // namespace straytrace::beams
