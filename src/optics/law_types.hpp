// SPDX-License-Identifier: BSD-3-Clause
// THE list of scatter laws, and their sum on one side of a surface. A new law is one header, its reader, its page and
// its name here.
#pragma once

#include <tuple>

#include "optics/abg.hpp"
#include "optics/lambertian.hpp"
#include "optics/optic.hpp"
#include "optics/power_law.hpp"

namespace straytrace {

using LawTypes = std::tuple<Lambertian, PowerLaw, Abg>;
using LawPool = Pool<LawTypes>;

STRAY_HD double scatter_albedo(LawPool const& pool, Optic const& optic, double cos_i) {
  double sum = 0;
  for (int i = 0; i < optic.laws; ++i) sum += pool.visit(optic.law[i], [&](auto const& l) { return l.albedo(cos_i); });
  return sum;
}

// BSDF of all laws together, 1/sr.
STRAY_HD double scatter_eval(LawPool const& pool, Optic const& optic, Vec3 wi, Vec3 wo) {
  double sum = 0;
  for (int i = 0; i < optic.laws; ++i) sum += pool.visit(optic.law[i], [&](auto const& l) { return l.eval(wi, wo); });
  return sum;
}

// Density of scatter_sample, 1/sr: laws are chosen in proportion to their albedo.
STRAY_HD double scatter_pdf(LawPool const& pool, Optic const& optic, Vec3 wi, Vec3 wo) {
  double sum = 0, total = 0;
  for (int i = 0; i < optic.laws; ++i)
    pool.visit(optic.law[i], [&](auto const& l) {
      double const share = l.albedo(wi.z);
      total += share;
      sum += share * l.pdf(wi, wo);
    });
  return total > 0 ? sum / total : 0;
}

// Draws a direction from the sum of the laws; the pdf returned is that of the whole sum.
STRAY_HD BsdfSample scatter_sample(LawPool const& pool, Optic const& optic, Vec3 wi, double choice, double u,
                                   double v) {
  double left = choice * scatter_albedo(pool, optic, wi.z);
  for (int i = 0; i < optic.laws; ++i) {
    double const share = pool.visit(optic.law[i], [&](auto const& l) { return l.albedo(wi.z); });
    left -= share;
    if (left > 0 && i + 1 < optic.laws) continue;
    BsdfSample s = pool.visit(optic.law[i], [&](auto const& l) { return l.sample(wi, u, v); });
    if (s.pdf > 0 && optic.laws > 1) s.pdf = scatter_pdf(pool, optic, wi, s.wo);
    return s;
  }
  return {};
}

}  // namespace straytrace
