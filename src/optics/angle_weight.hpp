// SPDX-License-Identifier: BSD-3-Clause
// Weight of one law in a sum, against the angle: the law is multiplied by sqrt(w(theta_i) w(theta_s)), which keeps it
// reciprocal (docs/theory/surfaces.md, eq. 3.2) for any w. Page: docs/reference/scatter/mixtures.md.
#pragma once

#include "optics/lobes/bsdf.hpp"

namespace straytrace {

struct AngleWeight {
  AlbedoTable root;    // sqrt(w) against the cosine
  AlbedoTable albedo;  // of the weighted law
  double most = 0;     // largest sqrt(w)
};

// A law with its weight; offers what a law does.
template <class Law>
struct Weighted {
  Law const& law;
  AngleWeight const* weight;  // null: 1

  STRAY_HD double albedo(double cos_i) const { return weight ? weight->albedo.at(cos_i) : law.albedo(cos_i); }
  STRAY_HD double albedo(Vec3 wi) const { return weight ? weight->albedo.at(wi.z) : albedo_from(law, wi); }
  STRAY_HD double eval(Vec3 wi, Vec3 wo) const {
    double const value = law.eval(wi, wo);
    return weight && value > 0 ? value * weight->root.at(wi.z) * weight->root.at(wo.z) : value;
  }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const { return law.pdf(wi, wo); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const { return law.sample(wi, u, v); }
};

}  // namespace straytrace
