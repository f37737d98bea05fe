// SPDX-License-Identifier: BSD-3-Clause
// Scatter to the other side of a surface by any model: the model acts on n alpha, the transverse wave vector over that
// of vacuum, which refraction conserves. With m the smaller of the two indices
//   f(wi, wo) = (n_out/m)^2 model(n_in alpha_i/m, n_out alpha_o/m),
// so that f_12/n_2^2 = f_21/n_1^2 (docs/theory/surfaces.md, eq. 3.2), the lobe is centred on the refracted direction,
// and the integral of f cos is the albedo of the model. Directions in the denser medium beyond the critical angle,
// where n alpha > m, neither send nor receive such light. wi.z > 0, wo.z < 0. Page: docs/reference/scatter/through.md.
#pragma once

#include "optics/lobes/bsdf.hpp"

namespace straytrace::optics {

struct Through {
  double scale_in = 1, scale_out = 1;  // n_in/m and n_out/m

  STRAY_HD static Through between(double n_in, double n_out) {
    double const m = n_in < n_out ? n_in : n_out;
    return {n_in / m, n_out / m};
  }
  // Direction on which the model acts; z = 0 beyond the critical angle.
  STRAY_HD static Vec3 stretched(Vec3 w, double scale) {
    if (scale == 1) return {w.x, w.y, std::fabs(w.z)};
    double const x = scale * w.x, y = scale * w.y, z2 = 1 - x * x - y * y;
    return {x, y, z2 > 0 ? std::sqrt(z2) : 0};
  }
  STRAY_HD Vec3 incoming(Vec3 wi) const { return stretched(wi, scale_in); }
  STRAY_HD Vec3 outgoing(Vec3 wo) const { return stretched(wo, scale_out); }
  STRAY_HD double cosine(double cos_i) const {  // of incoming()
    if (scale_in == 1) return cos_i;
    double const square = 1 - scale_in * scale_in * (1 - cos_i * cos_i);
    return square > 0 ? std::sqrt(square) : 0;
  }
  // Factor from the value of the model to f.
  STRAY_HD double gain() const { return scale_out * scale_out; }
  // Factor from a density about outgoing(wo) to one about wo, both in 1/sr.
  STRAY_HD double density(Vec3 wo, Vec3 stretched_wo) const {
    return stretched_wo.z > 0 ? gain() * std::fabs(wo.z) / stretched_wo.z : 0;
  }
  // The direction wo < 0 whose outgoing() is `w`.
  STRAY_HD Vec3 direction(Vec3 w) const {
    if (scale_out == 1) return {w.x, w.y, -w.z};
    double const x = w.x / scale_out, y = w.y / scale_out;
    return {x, y, -std::sqrt(1 - x * x - y * y)};
  }
};

template <class Law>
STRAY_HD double through_albedo(Law const& law, double cos_i, double n_in, double n_out) {
  double const cosine = Through::between(n_in, n_out).cosine(cos_i);
  return cosine > 0 ? law.albedo(cosine) : 0;
}

template <class Law>
STRAY_HD double through_eval(Law const& law, Vec3 wi, Vec3 wo, double n_in, double n_out) {
  if (!(wi.z > 0 && wo.z < 0)) return 0;
  Through const map = Through::between(n_in, n_out);
  return map.gain() * law.eval(map.incoming(wi), map.outgoing(wo));
}

template <class Law>
STRAY_HD double through_pdf(Law const& law, Vec3 wi, Vec3 wo, double n_in, double n_out) {
  if (!(wi.z > 0 && wo.z < 0)) return 0;
  Through const map = Through::between(n_in, n_out);
  Vec3 const w = map.outgoing(wo);
  return map.density(wo, w) * law.pdf(map.incoming(wi), w);
}

template <class Law>
STRAY_HD ValueAndPdf through_both(Law const& law, Vec3 wi, Vec3 wo, double n_in, double n_out) {
  if (!(wi.z > 0 && wo.z < 0)) return {};
  Through const map = Through::between(n_in, n_out);
  Vec3 const w = map.outgoing(wo);
  ValueAndPdf const found = both_of(law, map.incoming(wi), w);
  return {map.gain() * found.value, map.density(wo, w) * found.pdf};
}

template <class Law>
STRAY_HD BsdfSample through_sample(Law const& law, Vec3 wi, double u, double v, double n_in, double n_out) {
  if (!(wi.z > 0)) return {};
  Through const map = Through::between(n_in, n_out);
  BsdfSample const s = law.sample(map.incoming(wi), u, v);
  if (!(s.pdf > 0)) return {};
  Vec3 const wo = map.direction(s.wo);
  return {wo, s.pdf * map.density(wo, s.wo)};
}

}  // namespace straytrace::optics
