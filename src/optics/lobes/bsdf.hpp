// SPDX-License-Identifier: BSD-3-Clause
// The interface of every BSDF model. Directions are in the local frame, z = normal of the lit side, and both point AWAY
// from the surface. A model has
//   eval(wi, wo)      BSDF in 1/sr, WITHOUT the cosine (docs/theory/conventions.md, eq. 0.4)
//   pdf(wi, wo)       density of sample() in 1/sr; integrates to at most 1, the rest are samples that find no direction
//   albedo(cos_i)     integral of eval cos over the hemisphere, dimensionless. Models with a direction on the surface
//                     (local x and y, see Optic::lay) have albedo(wi) besides, and here its mean over the azimuth
//   sample(wi, u, v)  a direction drawn with pdf; pdf = 0: nothing sampled, weight zero
#pragma once

#include <string>

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"

namespace straytrace::optics {

template <class Model>
struct ModelKeys;  // optics/scatter/model_keys.hpp

// Why the values of its keys, each within its range, do not form a valid model, and the remedy; empty: they do.
struct ModelComplaint {
  std::string key, what, suggestion;  // key: the one at fault; empty: the model
};

struct BsdfSample {
  Vec3 wo;
  double pdf = 0;    // 1/sr
  double value = 0;  // BSDF, 1/sr; set by scatter_sample alone
};

// A model at one pair of directions, 1/sr: BSDF, and density with which it samples wo.
struct ValueAndPdf {
  double value = 0, pdf = 0;
};
// A model that computes both together has both(wi, wo).
template <class Law>
STRAY_HD ValueAndPdf both_of(Law const& law, Vec3 wi, Vec3 wo) {
  if constexpr (requires { law.both(wi, wo); })
    return law.both(wi, wo);
  else
    return {law.eval(wi, wo), law.pdf(wi, wo)};
}

// square^(n/2), square > 0, by products and one root for the n that models mostly have.
STRAY_HD double half_power(double square, double n) {
  double const m = std::fabs(n);
  double power = square;
  if (m == 1)
    power = std::sqrt(square);
  else if (m == 3)
    power = square * std::sqrt(square);
  else if (m == 4)
    power = square * square;
  else if (m != 2)
    return power_positive(square, 0.5 * n);
  return n < 0 ? 1 / power : power;
}

// Direction of specular reflection in the local frame.
STRAY_HD Vec3 specular(Vec3 wi) { return {-wi.x, -wi.y, wi.z}; }

// Albedo of a model for this incidence; with a direction on the surface it depends on the azimuth.
template <class Law>
STRAY_HD double albedo_from(Law const& law, Vec3 wi) {
  if constexpr (requires { law.albedo(wi); })
    return law.albedo(wi);
  else
    return law.albedo(wi.z);
}

// A quantity against the cosine of incidence, linear between nodes that crowd towards grazing, where a narrow lobe is
// cut off by the horizon: cosine = (i/128)^4.
struct AlbedoTable {
  static constexpr int size = 129;
  double value[size] = {};

  STRAY_HD static double cosine(int i) {
    double const root = double(i) * i / ((size - 1) * (size - 1));
    return root * root;
  }
  STRAY_HD double at(double cos_i) const {
    double const x = (size - 1) * std::sqrt(std::sqrt(cos_i < 0 ? 0 : cos_i > 1 ? 1 : cos_i));
    int const i = x < size - 1 ? static_cast<int>(x) : size - 2;
    double const low = cosine(i), share = (cos_i - low) / (cosine(i + 1) - low);
    return value[i] + (share < 0 ? 0 : share > 1 ? 1 : share) * (value[i + 1] - value[i]);
  }
};

}  // namespace straytrace::optics
