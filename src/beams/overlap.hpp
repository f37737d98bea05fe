// SPDX-License-Identifier: BSD-3-Clause
// Overlap of beams in closed form, their Hermite-Gauss and Laguerre-Gauss modes, and what apertures leave of them
// (docs/theory/beams.md).
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include <array>
#include <complex>
#include <vector>

#include "beams/mode.hpp"

namespace straytrace::beams {

// Overlap of two beams: tilt, shift, mismatch and astigmatism in one closed form
// (docs/theory/beams.md, eq. 5.1-5.3 are special cases).

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

// Hermite-Gauss modes about a beam with two principal axes (R2.11).

// Amplitudes c(a, b) for a + b <= order. With the powers of all orders they sum to 1.
class ModeCoefficients {
 public:
  explicit ModeCoefficients(int order);
  int order() const { return order_; }
  std::complex<double>& operator()(int a, int b) { return values_[index(a, b)]; }
  std::complex<double> operator()(int a, int b) const { return values_[index(a, b)]; }
  double power() const;  // sum of |c|^2

 private:
  static std::size_t index(int a, int b) { return static_cast<std::size_t>((a + b) * (a + b + 1) / 2 + b); }
  int order_;
  std::vector<std::complex<double>> values_;
};

// exp(-x^2/2) H_n(x) / sqrt(2^n n! sqrt(pi)): the integral of the product of two is 1 for equal orders, else 0.
double hermite_function(int n, double x);

// Amplitudes of a Gaussian beam in the modes of `basis`, of order n along e1 and m along e2, n + m <= order; (0, 0) is
// their overlap. The beam may be tilted, shifted and mismatched in any way. The rest of the power is in higher orders.
// NumericalError unless q12 = 0 for `basis`.
ModeCoefficients hermite_coefficients(Mode const& beam, Mode const& basis, int order);

// Laguerre-Gauss modes about a circular beam (R2.11).

// sqrt(p!/(p + l)!) x^(l/2) exp(-x/2) L_p^l(x), l >= 0: the integral over x > 0 of the product of two of one l is 1 for
// equal p, else 0.
double laguerre_function(int p, int l, double x);

// Amplitudes in these modes.
class LaguerreCoefficients {
 public:
  // Of a field with these amplitudes in the Hermite-Gauss modes of the same circular beam: modes of one order are sums
  // of each other.
  explicit LaguerreCoefficients(ModeCoefficients const& hermite);
  std::complex<double> operator()(int p, int l) const {
    // A mode is one of p + max(l, 0) quanta turning one way and p + max(-l, 0) the other, times (-1)^p.
    std::complex<double> const c = l >= 0 ? circular_(p + l, p) : circular_(p, p - l);
    return p % 2 ? -c : c;
  }
  double power() const { return circular_.power(); }  // sum of |c|^2 over 2p + |l| <= order

 private:
  ModeCoefficients circular_;
};

// A Gaussian beam at an aperture (docs/theory/beams.md, eq. 5.5 to 5.7): the power that it loses, and its field behind.

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
