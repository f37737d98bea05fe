// SPDX-License-Identifier: BSD-3-Clause
// Bare boundary between two media (docs/theory/surfaces.md, eq. 3.25); beyond the critical angle everything is
// reflected. Page: docs/reference/interfaces/fresnel.md.
#pragma once

#include <cmath>

#include "base/math/vec3.hpp"
#include "optics/polarisation.hpp"

namespace straytrace::optics {

struct Fresnel {
  // n + i k of an opaque body behind the surface, seen from either side: metal, absorbing glass. Light that enters it
  // is absorbed. Zero: a boundary between the media of the scene.
  Complex opaque;

  static constexpr char const* key = "fresnel";
  static constexpr bool yields_to_scatter = true;

  STRAY_HD Amplitudes amplitudes(double cos_i, double n_in, double n_out, bool /*front*/) const {
    if (opaque.re > 0 || opaque.im > 0) return of_opaque(cos_i, n_in, opaque);
    if (n_in == n_out) return {{}, {}, {1, 0}, {1, 0}};
    double const sine = n_in / n_out * std::sqrt(std::fmax(0.0, 1 - cos_i * cos_i)), square = 1 - sine * sine;
    if (square <= 0) {  // total reflection: cos of the refracted wave is i kappa
      double const kappa = std::sqrt(-square);
      return {unit_phase(n_in * cos_i, n_out * kappa), unit_phase(n_out * cos_i, n_in * kappa), {}, {}};
    }
    double const cos_o = std::sqrt(square), through = 2 * std::sqrt(n_in * cos_i * n_out * cos_o);
    double const s = n_in * cos_i + n_out * cos_o, p = n_out * cos_i + n_in * cos_o;
    return {{(n_in * cos_i - n_out * cos_o) / s, 0},
            {(n_out * cos_i - n_in * cos_o) / p, 0},
            {through / s, 0},
            {through / p, 0}};
  }
  STRAY_HD double scattered(double /*cos_i*/) const { return -1; }
  template <class F>
  void numbers(F&& f) const {
    f(opaque.re);
    f(opaque.im);
  }

  STRAY_HD static Amplitudes of_opaque(double cos_i, double n_in, Complex n) {
    Complex const square = n * n, q_in{n_in * cos_i, 0};
    Complex const q = upper_root(square - Complex{n_in * n_in * std::fmax(0.0, 1 - cos_i * cos_i), 0});
    Complex const p_in = square * q_in, p = n_in * n_in * q;
    return {(q_in - q) / (q_in + q), (p_in - p) / (p_in + p), {}, {}};
  }
  // (a - i b)/(a + i b), of modulus 1.
  STRAY_HD static Complex unit_phase(double a, double b) {
    double const n = a * a + b * b;
    return n > 0 ? Complex{(a * a - b * b) / n, -2 * a * b / n} : Complex{-1, 0};
  }
};

// Direction behind a boundary, all unit vectors along the travel: Snell's law as a vector (docs/theory/surfaces.md,
// eq. 3.25). `normal` is a unit vector towards the side the light
// comes from. False beyond the critical angle.
STRAY_HD bool refracted(Vec3 dir, Vec3 normal, double n_in, double n_out, Vec3& out) {
  Vec3 const along = (n_in / n_out) * (dir - dot(dir, normal) * normal);  // tangential part, conserved times n
  double const square = 1 - length2(along);
  if (!(square >= 0)) return false;
  out = unit(along - std::sqrt(square) * normal);
  return true;
}

}  // namespace straytrace::optics
