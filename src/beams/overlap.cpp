// SPDX-License-Identifier: BSD-3-Clause
#include "beams/overlap.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"

namespace straytrace::beams {

namespace {

std::complex<double> log_overlap(Mode const& u, Mode const& v) {
  if (std::fabs(u.wavelength / v.wavelength - 1) > 1e-9)
    throw NumericalError(fmt::format(
        "beams of {:.9g} m and {:.9g} m have no overlap: they must be in the same medium, of one wavelength",
        u.wavelength, v.wavelength));
  if (!(dot(u.travel, v.travel) > 0)) return -infinity;
  Vec3 const normal = unit(u.travel + v.travel), t1 = any_normal(normal);
  Plane const plane{0.5 * (u.origin + v.origin), t1, cross(normal, t1)};
  return product(on_plane(u, plane), on_plane(v, plane)).log_integral();
}

}  // namespace

std::complex<double> overlap(Mode const& u, Mode const& v) { return std::exp(log_overlap(u, v)); }
double power_overlap(Mode const& u, Mode const& v) { return std::exp(log_power_overlap(u, v)); }
double log_power_overlap(Mode const& u, Mode const& v) { return 2 * log_overlap(u, v).real(); }

PlaneField on_plane(Mode const& m, Plane const& plane) {
  double const cosine = dot(m.travel, plane.normal());
  double const z = dot(plane.point - m.origin, plane.normal()) / cosine;
  Mode const here = propagated(m, z);
  Vec3 const middle = here.origin - plane.point;
  Eigen::Matrix2d across;  // of points of the plane, in the frame of the beam
  across << dot(m.e1, plane.t1), dot(m.e1, plane.t2), dot(m.e2, plane.t1), dot(m.e2, plane.t2);
  Eigen::Matrix2cd q;
  q << here.q11, here.q12, here.q12, here.q22;

  PlaneField f;
  f.k = m.wave_number();
  f.centre = {dot(middle, plane.t1), dot(middle, plane.t2)};
  f.slope = {dot(m.travel, plane.t1), dot(m.travel, plane.t2)};
  f.q = across.transpose() * q * across;
  double const size = f.q.imag().determinant();  // (k/pi)^2 times it is the square of the peak of |.|^2
  f.log_amplitude = {0.5 * std::log(f.k / pi * std::sqrt(size)), f.k * z - gouy(m, z)};
  return f;
}

FieldProduct product(PlaneField const& u, PlaneField const& v) {
  Eigen::Vector2d const d = u.centre - v.centre;
  Eigen::Vector2cd const bent = u.q * d;
  std::complex<double> const i{0, 1};
  FieldProduct p;
  p.k = u.k;
  p.s = u.q - v.q.conjugate();
  p.g = (u.slope - v.slope).cast<std::complex<double>>() - bent;
  std::complex<double> const at_zero = -u.slope.dot(d) + 0.5 * (bent(0) * d(0) + bent(1) * d(1));
  p.log_amplitude = u.log_amplitude + std::conj(v.log_amplitude) + i * u.k * at_zero;
  return p;
}

std::complex<double> FieldProduct::log_integral() const {
  // -i S has a positive definite real part: the roots of its eigenvalues are the principal ones.
  std::complex<double> const i{0, 1};
  auto const part = eigenvalues<std::complex<double>>(-i * s(0, 0), -i * s(0, 1), -i * s(1, 1));
  Eigen::Vector2cd const x = s.inverse() * g;
  std::complex<double> const exponent = log_amplitude - 0.5 * i * k * (g(0) * x(0) + g(1) * x(1));
  return exponent + std::log(2 * pi / k) - 0.5 * (std::log(part[0]) + std::log(part[1]));
}

}  // namespace straytrace::beams
