// SPDX-License-Identifier: BSD-3-Clause
// Bare boundary between two transparent media (physics.md eq. 3.25); beyond the critical angle everything is
// reflected. Page: docs/reference/interfaces/fresnel.md.
#pragma once

#include <cmath>

#include "optics/amplitudes.hpp"

namespace straytrace {

struct Fresnel {
  double unused = 0;  // the indices belong to the media on both sides
  static constexpr char const* key = "fresnel";

  STRAY_HD Amplitudes amplitudes(double cos_i, double n_in, double n_out, bool /*front*/) const {
    double const sine = n_in / n_out * std::sqrt(std::fmax(0.0, 1 - cos_i * cos_i)), square = 1 - sine * sine;
    if (square <= 0) {  // total reflection: cos of the refracted wave is i kappa
      double const kappa = std::sqrt(-square);
      return {unit_phase(n_in * cos_i, n_out * kappa), unit_phase(n_out * cos_i, n_in * kappa), {}, {}};
    }
    double const cos_o = std::sqrt(square), scale = std::sqrt(n_out * cos_o / (n_in * cos_i));
    double const s = n_in * cos_i + n_out * cos_o, p = n_out * cos_i + n_in * cos_o;
    return {{(n_in * cos_i - n_out * cos_o) / s, 0},
            {(n_out * cos_i - n_in * cos_o) / p, 0},
            {scale * 2 * n_in * cos_i / s, 0},
            {scale * 2 * n_in * cos_i / p, 0}};
  }
  // (a - i b)/(a + i b), of modulus 1.
  STRAY_HD static Complex unit_phase(double a, double b) {
    double const n = a * a + b * b;
    return {(a * a - b * b) / n, -2 * a * b / n};
  }
};

}  // namespace straytrace
