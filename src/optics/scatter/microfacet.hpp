// SPDX-License-Identifier: BSD-3-Clause
// Rough surface of small mirrors: GGX (Trowbridge-Reitz) distribution of their normals, height-correlated Smith
// shadowing, one reflection: BSDF = F(i.h) D(h) G(i, o)/(4 cos_i cos_s), h = unit(wi + wo). Samples are drawn from the
// normals seen from wi (Heitz 2018; as spherical caps, Dupuy and Benyoub 2023): eval cos/pdf = F G/G1, at most F.
// Page: docs/reference/scatter/microfacet.md.
#pragma once

#include "optics/lobes/bsdf.hpp"
#include "optics/scatter/facets.hpp"

namespace straytrace {

struct Microfacet {
  double alpha = 0.1;      // roughness, above 0 and at most 1
  double reflectance = 0;  // F at normal incidence on a small mirror
  double grazing = 0;      // F at grazing incidence; equal to `reflectance`: the same at every angle
  static constexpr int cosines = 128;
  // Set by prepare(): total above factor(cosine), even in crowded(cosine/alpha, 1/alpha).
  double totals[cosines] = {};
  static constexpr char const* key = "microfacet";

  void prepare();  // host

  STRAY_HD double factor(double cosine) const {  // Schlick 1994; cosine: incidence on the small mirror
    double const x = cosine < 1 ? 1 - cosine : 0, square = x * x;
    return reflectance + (grazing - reflectance) * square * square * x;
  }
  // D in 1/sr; the integral of D cos over the hemisphere is 1.
  STRAY_HD double normals(Vec3 h) const {
    double const square = alpha * alpha, spread = h.x * h.x + h.y * h.y + square * h.z * h.z;
    return square / (pi * spread * spread);
  }
  // cos (1 + 2 Lambda) of Smith's shadowing, G1 = 2 cos/(cos + slant).
  STRAY_HD double slant(Vec3 w) const { return std::sqrt(w.z * w.z + alpha * alpha * (w.x * w.x + w.y * w.y)); }

  STRAY_HD double eval(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    Vec3 const sum = wi + wo;
    double const size = length(sum);  // 2 i.h
    return factor(size / 2) * normals((1 / size) * sum) / (2 * (wo.z * slant(wi) + wi.z * slant(wo)));
  }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    return normals(unit(wi + wo)) / (2 * (wi.z + slant(wi)));
  }
  STRAY_HD double albedo(double cos_i) const {
    double const total =
        factor(cos_i) + Stencil(crowded((cos_i > 0 ? cos_i : 0) / alpha, 1 / alpha), cosines).of(totals);
    double const most = reflectance > grazing ? reflectance : grazing;
    return total > most ? most : total;
  }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const {
    if (!(wi.z > 0)) return {};
    Vec3 const seen = unit(Vec3{alpha * wi.x, alpha * wi.y, wi.z});  // where the rough surface is a hemisphere
    double const up = (1 - v) * (1 + seen.z), z = up - seen.z, across = std::sqrt(std::fmax(0.0, (1 - z) * (1 + z)));
    SinCos const turn = sincos_turn(u);
    Vec3 const h = unit(Vec3{alpha * (across * turn.cos + seen.x), alpha * (across * turn.sin + seen.y), up});
    Vec3 const wo = unit(2 * dot(wi, h) * h - wi);
    if (!(wo.z > 0)) return {};
    return {wo, pdf(wi, wo)};
  }
};

}  // namespace straytrace
