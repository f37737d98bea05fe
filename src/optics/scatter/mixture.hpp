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

template <class Incidence>
STRAY_HD double sum_of_albedos(LawPool const& pool, Optic const& optic, Incidence in, double n_in, double n_out) {
  double sum = 0;
  for (int i = 0; i < optic.laws; ++i) sum += law_albedo(pool, optic, i, in, n_in, n_out);
  return sum;
}
// A small cone about the specular direction has the solid angle of that at normal incidence, and cos theta_i.
template <class Incidence>
STRAY_HD double scatter_albedo(LawPool const& pool, Optic const& optic, Incidence in, double n_in = 1,
                               double n_out = 1) {
  double const sum = sum_of_albedos(pool, optic, in, n_in, n_out);
  return optic.below > 0 ? std::fmax(sum - optic.below * cosine_of(in), 0.0) : sum;
}

// BSDF of all models together, 1/sr.
STRAY_HD double scatter_eval(LawPool const& pool, Optic const& optic, Vec3 wi, Vec3 wo, double n_in = 1,
                             double n_out = 1) {
  if (optic.crossover > 0 && wo.z > 0 && angle_between(specular(wi), wo) < optic.crossover) return 0;
  double sum = 0;
  for (int i = 0; i < optic.laws; ++i) {
    if (optic.through[i] != (wo.z < 0)) continue;
    sum += visit_law(pool, optic, i, [&](auto const& l) {
      return optic.through[i] ? through_eval(l, wi, wo, n_in, n_out) : l.eval(wi, wo);
    });
  }
  return sum;
}

// Density of scatter_sample, 1/sr: models are chosen in proportion to their albedo.
STRAY_HD double scatter_pdf(LawPool const& pool, Optic const& optic, Vec3 wi, Vec3 wo, double n_in = 1,
                            double n_out = 1) {
  double sum = 0, total = 0;
  for (int i = 0; i < optic.laws; ++i)
    visit_law(pool, optic, i, [&](auto const& l) {
      double const share = optic.through[i] ? through_albedo(l, wi.z, n_in, n_out) : l.albedo(wi);
      total += share;
      if (optic.through[i] != (wo.z < 0) || !(share > 0)) return;
      sum += share * (optic.through[i] ? through_pdf(l, wi, wo, n_in, n_out) : l.pdf(wi, wo));
    });
  return total > 0 ? sum / total : 0;
}

// Draws a direction from the sum of the models; the returned pdf is that of the whole sum.
STRAY_HD BsdfSample scatter_sample(LawPool const& pool, Optic const& optic, Vec3 wi, double choice, double u, double v,
                                   double n_in = 1, double n_out = 1) {
  double left = choice * sum_of_albedos(pool, optic, wi, n_in, n_out);
  for (int i = 0; i < optic.laws; ++i) {
    left -= law_albedo(pool, optic, i, wi, n_in, n_out);
    if (left > 0 && i + 1 < optic.laws) continue;
    BsdfSample s = visit_law(pool, optic, i, [&](auto const& l) {
      return optic.through[i] ? through_sample(l, wi, u, v, n_in, n_out) : l.sample(wi, u, v);
    });
    if (s.pdf > 0 && optic.laws > 1) s.pdf = scatter_pdf(pool, optic, wi, s.wo, n_in, n_out);
    return s;
  }
  return {};
}

}  // namespace straytrace::optics
