// SPDX-License-Identifier: BSD-3-Clause
#include "beams/mode.hpp"

#include <Eigen/LU>

#include "beams/eigenmode.hpp"

namespace straytrace::beams {

namespace {

std::complex<double> curvature_of_axis(double w, double curvature, double wavelength) {
  return {curvature, wavelength / (pi * w * w)};
}

// Through a face without change of place; wavelength and Q are those of the medium behind.
Mode through_face(Mode const& m, FaceMap const& face, double n_in, double n_out) {
  Eigen::Matrix2cd q;
  q << m.q11, m.q12, m.q12, m.q22;
  Eigen::Matrix2d const back = face.after.inverse();
  Eigen::Matrix2cd const on_face = n_in * (face.before.transpose() * q * face.before) + face.power;
  Eigen::Matrix2cd const after = (1 / n_out) * (back.transpose() * on_face * back);
  return {m.origin,
          face.e1,
          face.e2,
          face.travel,
          m.wavelength * (n_in / n_out),
          after(0, 0),
          0.5 * (after(0, 1) + after(1, 0)),
          after(1, 1)};
}

double peak_intensity(Mode const& m) {
  double const a = m.q11.imag(), b = m.q12.imag(), c = m.q22.imag();
  return m.wave_number() / pi * std::sqrt(a * c - b * b);
}

}  // namespace

Mode elliptic_mode(Vec3 origin, Vec3 e1, Vec3 travel, std::array<double, 2> w, std::array<double, 2> curvature,
                   double wavelength) {
  return {origin,
          e1,
          cross(travel, e1),
          travel,
          wavelength,
          curvature_of_axis(w[0], curvature[0], wavelength),
          0,
          curvature_of_axis(w[1], curvature[1], wavelength)};
}

Mode circular_mode(Vec3 origin, Vec3 travel, double w, double curvature, double wavelength) {
  return elliptic_mode(origin, any_normal(travel), travel, {w, w}, {curvature, curvature}, wavelength);
}

Mode propagated(Mode const& m, double z) {
  // Elements of 1 + z Q, not its trace and determinant: near a focus they are small differences.
  std::complex<double> const f11 = 1.0 + z * m.q11, f12 = z * m.q12, f22 = 1.0 + z * m.q22;
  std::complex<double> const scale = 1.0 / (f11 * f22 - f12 * f12);
  Mode far = m;
  far.origin = m.origin + z * m.travel;
  far.q11 = scale * (m.q11 * f22 - m.q12 * f12);
  far.q12 = scale * m.q12;
  far.q22 = scale * (m.q22 * f11 - m.q12 * f12);
  return far;
}

std::array<double, 2> axis_gouy(Mode const& m, double z) {
  // Im Q is positive definite, so both eigenvalues lie above the real axis and arg(1 + z q) never meets its cut.
  auto const q = eigenvalues(m.q11, m.q12, m.q22);
  return {std::arg(1.0 + z * q[0]), std::arg(1.0 + z * q[1])};
}

double gouy(Mode const& m, double z) {
  auto const axis = axis_gouy(m, z);
  return 0.5 * (axis[0] + axis[1]);
}

Mode reflected(Mode const& m, Vec3 normal, SurfaceCurvature const& curvature) {
  return through_face(m, mirror_face(m.e1, m.e2, m.travel, normal, curvature, 1), 1, 1);
}

Mode refracted(Mode const& m, Vec3 normal, SurfaceCurvature const& curvature, double n_in, double n_out) {
  return through_face(m, refracting_face(m.e1, m.e2, m.travel, normal, curvature, n_in, n_out), n_in, n_out);
}

Mode diffracted(Mode const& m, Vec3 out, Vec3 normal, SurfaceCurvature const& curvature, double n_in, double n_out) {
  return through_face(m, grating_face(m.e1, m.e2, m.travel, out, normal, curvature, n_in, n_out), n_in, n_out);
}

Mode reversed(Mode const& m) {
  // Turned about e1: q12 changes sign once for e2 and once for the conjugate curvature.
  return {m.origin, m.e1, -m.e2, -m.travel, m.wavelength, -std::conj(m.q11), std::conj(m.q12), -std::conj(m.q22)};
}

double intensity(Mode const& m, Vec3 p) {
  Mode const here = propagated(m, dot(p - m.origin, m.travel));
  Vec3 const r = p - here.origin;
  double const x = dot(r, here.e1), y = dot(r, here.e2);
  double const square = here.q11.imag() * x * x + 2 * here.q12.imag() * x * y + here.q22.imag() * y * y;
  return peak_intensity(here) * std::exp(-here.wave_number() * square);
}

std::complex<double> field(Mode const& m, Vec3 p) {
  double const z = dot(p - m.origin, m.travel);
  Mode const here = propagated(m, z);
  Vec3 const r = p - here.origin;
  double const x = dot(r, here.e1), y = dot(r, here.e2), k = here.wave_number();
  std::complex<double> const square = here.q11 * x * x + 2.0 * here.q12 * x * y + here.q22 * y * y;
  std::complex<double> const exponent{-0.5 * k * square.imag(), k * (z + 0.5 * square.real()) - gouy(m, z)};
  return std::sqrt(peak_intensity(here)) * std::exp(exponent);
}

Spot spot(Mode const& m) {
  double const a = m.q11.imag(), b = m.q12.imag(), c = m.q22.imag();
  double const large = 0.5 * (a + c) + std::hypot(0.5 * (a - c), b), small = (a * c - b * b) / large;
  double const angle = larger_axis(a, b, c), scale = m.wavelength / pi;
  return {std::sqrt(scale / small), std::sqrt(scale / large), std::cos(angle) * m.e2 - std::sin(angle) * m.e1};
}

}  // namespace straytrace::beams
