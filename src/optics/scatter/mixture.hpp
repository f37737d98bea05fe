// SPDX-License-Identifier: BSD-3-Clause
// The sum of the BSDF models on one side of a surface. wo.z > 0: reflected side, models without `through`;
// wo.z < 0: transmitted side, models with it; n_in, n_out: indices on the lit side and behind it.
#pragma once

#include "optics/lobes/bsdf.hpp"
#include "optics/optic.hpp"
#include "optics/scatter/law_types.hpp"

namespace straytrace::optics {

// Scatter to the other side of a surface by any model: the model acts on n alpha, the transverse wave vector over that
// of vacuum, which refraction conserves. With m the smaller of the two indices
//   f(wi, wo) = (n_out/m)^2 model(n_in alpha_i/m, n_out alpha_o/m),
// so that f_12/n_2^2 = f_21/n_1^2 (docs/theory/surfaces.md, eq. 3.2), the lobe is centred on the refracted direction,
// and the integral of f cos is the albedo of the model. Directions in the denser medium beyond the critical angle,
// where n alpha > m, neither send nor receive such light. wi.z > 0, wo.z < 0. Page: docs/reference/scatter/through.md.

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

STRAY_HD double cosine_of(double cos_i) { return cos_i; }
STRAY_HD double cosine_of(Vec3 wi) { return wi.z; }

// Calls f with model number i of the side, weighted.
template <class F>
STRAY_HD auto visit_law(LawPool const& pool, Optic const& optic, int i, F&& f) {
  AngleWeight const* const weight = optic.weight[i].size ? optic.weight[i].data : nullptr;
  return pool.visit(optic.law[i], [&](auto const& l) { return f(Weighted<std::decay_t<decltype(l)>>{l, weight}); });
}

// Albedo of model number i; for a cosine the mean over the azimuth.
template <class Incidence>  // wi, or its cosine
STRAY_HD double law_albedo(LawPool const& pool, Optic const& optic, int i, Incidence in, double n_in = 1,
                           double n_out = 1) {
  return visit_law(pool, optic, i, [&](auto const& l) {
    return optic.through[i] ? through_albedo(l, cosine_of(in), n_in, n_out) : l.albedo(in);
  });
}

// Whether light that leaves along wo is left to the field of a cavity.
STRAY_HD bool below_crossover(Optic const& optic, Vec3 wi, Vec3 wo) {
  return optic.crossover > 0 && wo.z > 0 && angle_between(specular(wi), wo) < optic.crossover;
}

// BSDF of all models together, 1/sr.
STRAY_HD double scatter_eval(LawPool const& pool, Optic const& optic, Vec3 wi, Vec3 wo, double n_in = 1,
                             double n_out = 1) {
  if (below_crossover(optic, wi, wo)) return 0;
  double sum = 0;
  for (int i = 0; i < optic.laws; ++i) {
    if (optic.through[i] != (wo.z < 0)) continue;
    sum += visit_law(pool, optic, i, [&](auto const& l) {
      return optic.through[i] ? through_eval(l, wi, wo, n_in, n_out) : l.eval(wi, wo);
    });
  }
  return sum;
}

// The albedos of the models for one direction of incidence, which decide between them.
struct Albedos {
  double of[Optic::most_laws];  // as many as there are models
  double total = 0;
};
STRAY_HD Albedos albedos_of(LawPool const& pool, Optic const& optic, Vec3 wi, double n_in = 1, double n_out = 1) {
  Albedos all;
  for (int i = 0; i < optic.laws; ++i) all.total += all.of[i] = law_albedo(pool, optic, i, wi, n_in, n_out);
  return all;
}
// What is left of their sum beyond the crossover angle: a small cone about the specular direction has the solid angle
// of that at normal incidence, and cos theta_i.
STRAY_HD double scattered_share(Optic const& optic, double total, double cos_i) {
  return optic.below > 0 ? std::fmax(total - optic.below * cos_i, 0.0) : total;
}

template <class Incidence>
STRAY_HD double scatter_albedo(LawPool const& pool, Optic const& optic, Incidence in, double n_in = 1,
                               double n_out = 1) {
  double sum = 0;
  for (int i = 0; i < optic.laws; ++i) sum += law_albedo(pool, optic, i, in, n_in, n_out);
  return scattered_share(optic, sum, cosine_of(in));
}

// The BSDF of all models together, and the density of scatter_sample, 1/sr: models are chosen in proportion to their
// albedo.
STRAY_HD ValueAndPdf scatter_both(LawPool const& pool, Optic const& optic, Albedos const& albedos, Vec3 wi, Vec3 wo,
                                  double n_in = 1, double n_out = 1) {
  ValueAndPdf sum;
  for (int i = 0; i < optic.laws; ++i) {
    if (optic.through[i] != (wo.z < 0)) continue;
    ValueAndPdf const one = visit_law(pool, optic, i, [&](auto const& l) {
      return optic.through[i] ? through_both(l, wi, wo, n_in, n_out) : l.both(wi, wo);
    });
    sum.value += one.value;
    if (albedos.of[i] > 0) sum.pdf += albedos.of[i] * one.pdf;
  }
  if (below_crossover(optic, wi, wo)) sum.value = 0;
  sum.pdf = albedos.total > 0 ? sum.pdf / albedos.total : 0;
  return sum;
}
STRAY_HD double scatter_pdf(LawPool const& pool, Optic const& optic, Vec3 wi, Vec3 wo, double n_in = 1,
                            double n_out = 1) {
  return scatter_both(pool, optic, albedos_of(pool, optic, wi, n_in, n_out), wi, wo, n_in, n_out).pdf;
}

// Draws a direction from the sum of the models; value and density returned are those of the whole sum.
STRAY_HD BsdfSample scatter_sample(LawPool const& pool, Optic const& optic, Albedos const& albedos, Vec3 wi,
                                   double choice, double u, double v, double n_in = 1, double n_out = 1) {
  double left = choice * albedos.total;
  for (int i = 0; i < optic.laws; ++i) {
    left -= albedos.of[i];
    if (left > 0 && i + 1 < optic.laws) continue;
    BsdfSample s = visit_law(pool, optic, i, [&](auto const& l) {
      return optic.through[i] ? through_sample(l, wi, u, v, n_in, n_out) : l.sample(wi, u, v);
    });
    if (!(s.pdf > 0)) return s;
    if (optic.laws == 1) return {s.wo, s.pdf, scatter_eval(pool, optic, wi, s.wo, n_in, n_out)};
    ValueAndPdf const all = scatter_both(pool, optic, albedos, wi, s.wo, n_in, n_out);
    return {s.wo, all.pdf, all.value};
  }
  return {};
}
STRAY_HD BsdfSample scatter_sample(LawPool const& pool, Optic const& optic, Vec3 wi, double choice, double u, double v,
                                   double n_in = 1, double n_out = 1) {
  return scatter_sample(pool, optic, albedos_of(pool, optic, wi, n_in, n_out), wi, choice, u, v, n_in, n_out);
}

}  // namespace straytrace::optics
