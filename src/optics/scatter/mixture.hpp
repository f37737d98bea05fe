// SPDX-License-Identifier: BSD-3-Clause
// The sum of the BSDF models on one side of a surface. wo.z > 0: reflected side, models without `through`;
// wo.z < 0: transmitted side, models with it; n_in, n_out: indices on the lit side and behind it.
#pragma once

#include "optics/optic.hpp"
#include "optics/scatter/law_types.hpp"
#include "optics/scatter/through.hpp"

namespace straytrace::optics {

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
