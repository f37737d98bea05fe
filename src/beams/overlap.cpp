// SPDX-License-Identifier: BSD-3-Clause
#include "beams/overlap.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"

namespace straytrace::beams {

namespace {

void require_one_medium(Mode const& u, Mode const& v) {
  if (std::fabs(u.wavelength / v.wavelength - 1) > 1e-9)
    throw NumericalError(fmt::format(
        "beams of {:.9g} m and {:.9g} m have no overlap: they must be in the same medium, of one wavelength",
        u.wavelength, v.wavelength));
}

// Halfway between both directions.
Plane plane_across(Mode const& u, Mode const& v) {
  Vec3 const normal = unit(u.travel + v.travel), t1 = any_normal(normal);
  return {0.5 * (u.origin + v.origin), t1, cross(normal, t1)};
}

std::complex<double> log_overlap(Mode const& u, Mode const& v) {
  require_one_medium(u, v);
  if (!(dot(u.travel, v.travel) > 0)) return -infinity;
  Plane const plane = plane_across(u, v);
  return product(on_plane(u, plane), on_plane(v, plane)).log_integral();
}

}  // namespace

std::complex<double> overlap(Mode const& u, Mode const& v) { return std::exp(log_overlap(u, v)); }
double power_overlap(Mode const& u, Mode const& v) { return std::exp(log_power_overlap(u, v)); }
double log_power_overlap(Mode const& u, Mode const& v) { return 2 * log_overlap(u, v).real(); }

// On the plane u = exp ik[slope.t + t.q t/2], t from its chief ray. A ray moved by c on the plane and by `slope` of its
// direction changes ln u by ik (slope.t - c.q t) about the phase that it has there, and ln of the integral by the same
// with the mean of t, weighted by u conj(v).
OverlapSlope overlap_slope(Mode const& u, Mode const& v) {
  require_one_medium(u, v);
  if (!(dot(u.travel, v.travel) > 0)) return {};
  Plane const plane = plane_across(u, v);
  PlaneField const moving = on_plane(u, plane), fixed = on_plane(v, plane);
  FieldProduct const p = product(moving, fixed);
  Eigen::Vector2cd const mean = -(p.s.inverse() * p.g) - (moving.centre - fixed.centre).cast<std::complex<double>>();
  Eigen::Vector2cd const bent = moving.q * mean;
  std::complex<double> const ik(0, p.k);
  Vec3 const normal = plane.normal();
  double const cosine = dot(u.travel, normal), z = dot(plane.point - u.origin, normal) / cosine;
  auto const at = [](Vec3 a, int i) { return i == 0 ? a.x : i == 1 ? a.y : a.z; };
  // Along the ray onto the plane.
  std::complex<double> const along = (bent(0) * dot(plane.t1, u.travel) + bent(1) * dot(plane.t2, u.travel)) / cosine;
  OverlapSlope slope;
  for (int i = 0; i < 3; ++i) {
    auto const part = std::size_t(i);
    slope.shift[part] = -ik * (bent(0) * at(plane.t1, i) + bent(1) * at(plane.t2, i) - along * at(normal, i));
    slope.turn[part] = ik * (mean(0) * at(plane.t1, i) + mean(1) * at(plane.t2, i)) + z * slope.shift[part];
  }
  return slope;
}

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
