// SPDX-License-Identifier: BSD-3-Clause
// Random optical systems and beams for the tests of Gaussian optics.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "base/every_module.hpp"
#include "beams/eigenmode.hpp"
#include "beams/mode.hpp"
#include "optics/coating/fresnel.hpp"

namespace straytrace::testing {

// Principal curvatures of the wavefront at `origin`, 1/m, positive when diverging; `axis` along the first, the larger.
struct Wavefront {
  double first = 0, second = 0;
  Vec3 axis;
};
inline Wavefront wavefront(Mode const& m) {
  double const a = m.q11.real(), b = m.q12.real(), c = m.q22.real();
  double const mean = 0.5 * (a + c), half = std::hypot(0.5 * (a - c), b), angle = larger_axis(a, b, c);
  return {mean + half, mean - half, std::cos(angle) * m.e1 + std::sin(angle) * m.e2};
}

// Ray matrices of one axis. RoC > 0: concave seen from where the light comes.
inline AxisMatrix axis_flight(double length, double n = 1) { return AxisMatrix{{1, length / n}, {0, 1}}; }
inline AxisMatrix axis_mirror(double roc) { return AxisMatrix{{1, 0}, {-2 / roc, 1}}; }
inline AxisMatrix axis_face(double roc, double n_before, double n_after) {
  return AxisMatrix{{1, 0}, {(n_after - n_before) / roc, 1}};
}
// eq. 6.2
inline BeamParameter transformed_q(AxisMatrix const& m, BeamParameter q) {
  return (m(0, 0) * q + m(0, 1)) / (m(1, 0) * q + m(1, 1));
}
inline double beam_radius(BeamParameter q, double wavelength) {  // 1/e^2 intensity radius, m
  return std::sqrt(-wavelength / (pi * std::imag(1.0 / q)));
}
inline double wavefront_curvature(BeamParameter q) { return std::real(1.0 / q); }  // 1/m, positive when diverging

inline OpticalElement spherical_face(Vec3 point, Vec3 normal, double roc, double index_after) {
  OpticalElement face = spherical_mirror(point, normal, roc);
  face.reflects = false;
  face.index_after = index_after;
  return face;
}

class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  // Unit vector at an angle of at most `widest` rad from `axis`.
  Vec3 near(Vec3 axis, double widest) {
    Frame const f = Frame::around(axis);
    double const angle = between(0, widest), turn = between(0, 2 * pi);
    return f.to_world({std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle)});
  }
  // Curvatures of either sign up to 1/roc, in tangent axes turned at random.
  SurfaceCurvature curved(Vec3 normal, double roc) {
    Frame const f = Frame::around(normal);
    double const turn = between(0, 2 * pi);
    Vec3 const a = std::cos(turn) * f.e1 + std::sin(turn) * f.e2;
    return {a, cross(normal, a), between(-1, 1) / roc, between(-1, 1) / roc, between(-1, 1) / roc};
  }

 private:
  std::mt19937_64 engine_;
};

// Twisted beam: Re Q and Im Q have axes of their own.
inline Mode twisted_mode(Dice& dice, Vec3 origin, Vec3 travel, double w, double wavelength) {
  Mode m = circular_mode(origin, travel, w, 0, wavelength);
  double const s = m.q11.imag();
  m.q11 = {dice.between(-s, s), s * dice.between(0.7, 1.4)};
  m.q22 = {dice.between(-s, s), s * dice.between(0.7, 1.4)};
  m.q12 = {dice.between(-s, s), s * dice.between(-0.5, 0.5)};
  return m;
}

// A ray that meets the sheet of a sphere next to `vertex` and is reflected (n_after = 0) or refracted there, exactly.
// `normal` points to the centre of curvature for roc > 0.
struct ExactRay {
  Vec3 point, dir;
};
inline ExactRay through_sphere(ExactRay r, Vec3 vertex, Vec3 normal, double roc, double n_before, double n_after) {
  Vec3 const centre = vertex + roc * normal, o = r.point - centre;
  double const b = dot(o, r.dir), root = std::sqrt(b * b - length2(o) + roc * roc);
  double const one = -b - root, two = -b + root;
  auto const near = [&](double t) { return length(o + t * r.dir + roc * normal); };  // the sheet at the vertex
  r.point = r.point + (near(one) < near(two) ? one : two) * r.dir;
  Vec3 n = unit(r.point - centre);
  if (dot(n, r.dir) > 0) n = -n;
  if (n_after == 0)
    r.dir = reflected(r.dir, n);
  else
    refracted(r.dir, n, n_before, n_after, r.dir);
  return r;
}

}  // namespace straytrace::testing
