// SPDX-License-Identifier: BSD-3-Clause
// What every scatter law offers. Directions are in the local frame, z = normal of the lit side, and both point AWAY
// from the surface. A law has
//   eval(wi, wo)      BSDF in 1/sr, WITHOUT the cosine (physics.md eq. 0.4)
//   pdf(wi, wo)       density of sample() in 1/sr; integrates to at most 1, the rest are samples that find no direction
//   albedo(cos_i)     integral of eval cos over the hemisphere, dimensionless
//   sample(wi, u, v)  a direction drawn with pdf; pdf = 0: nothing sampled, weight zero
#pragma once

#include "base/functions.hpp"
#include "base/vec3.hpp"

namespace straytrace {

struct BsdfSample {
  Vec3 wo;
  double pdf = 0;  // 1/sr
};

// Direction of specular reflection in the local frame.
STRAY_HD Vec3 specular(Vec3 wi) { return {-wi.x, -wi.y, wi.z}; }

// Albedo of a law against the cosine of incidence, tabulated once by quadrature at evenly spaced roots of the cosine: a
// narrow lobe is cut off by the horizon within a few degrees of grazing.
struct AlbedoTable {
  static constexpr int size = 129;
  double value[size] = {};

  static double cosine(int i) { return double(i) * i / ((size - 1) * (size - 1)); }
  STRAY_HD double at(double cosine) const {
    double const x = (size - 1) * std::sqrt(cosine < 0 ? 0 : cosine > 1 ? 1 : cosine);
    int const i = x < size - 1 ? static_cast<int>(x) : size - 2;
    return value[i] + (x - i) * (value[i + 1] - value[i]);
  }
};

}  // namespace straytrace
