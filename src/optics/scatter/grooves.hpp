// SPDX-License-Identifier: BSD-3-Clause
// Machined surface: fine grooves whose flanks are small mirrors. GGX (Trowbridge-Reitz) distribution of normals with a
// width across the grooves (local x) and another along them (local y), height-correlated Smith shadowing, one
// reflection: BSDF = F(i.h) D(h) G(i, o)/(4 cos_i cos_s), h = unit(wi + wo). Samples are drawn from the normals seen
// from wi (Heitz 2018; as spherical caps, Dupuy and Benyoub 2023): eval cos/pdf = F G/G1, at most F.
// Page: docs/reference/scatter/grooves.md.
#pragma once

#include "optics/lobes/bsdf.hpp"
#include "optics/scatter/facets.hpp"

namespace straytrace {

struct Grooves {
  double across = 0.3, along = 0.02;  // widths of the normals, tangents of slope, above 0 and at most 1
  double reflectance = 0;             // F at normal incidence on a flank
  double grazing = 0;                 // F at grazing incidence
  static constexpr int azimuths = 64, cosines = 96;
  double totals[azimuths][cosines] = {};  // set by prepare(): what is above factor(cosine), at node()
  AlbedoTable mean;                       // over the azimuth
  static constexpr char const* key = "grooves";

  void prepare();                        // host
  Vec3 node(int row, int column) const;  // host: incidence of an entry

  // Width of the normals in the plane of incidence: what the total at a cosine depends on most.
  STRAY_HD double width(double cos_azimuth) const {
    double const x = across * cos_azimuth, square = (1 - cos_azimuth) * (1 + cos_azimuth) * along * along;
    return std::sqrt(x * x + square);
  }
  STRAY_HD double factor(double cosine) const {  // Schlick 1994; cosine: incidence on the flank
    double const x = cosine < 1 ? 1 - cosine : 0, square = x * x;
    return reflectance + (grazing - reflectance) * square * square * x;
  }
  // D in 1/sr; the integral of D cos over the hemisphere is 1.
  STRAY_HD double normals(Vec3 h) const {
    double const x = h.x / across, y = h.y / along, spread = x * x + y * y + h.z * h.z;
    return 1 / (pi * across * along * spread * spread);
  }
  // cos (1 + 2 Lambda) of Smith's shadowing, G1 = 2 cos/(cos + slant).
  STRAY_HD double slant(Vec3 w) const {
    double const x = across * w.x, y = along * w.y;
    return std::sqrt(w.z * w.z + x * x + y * y);
  }

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
  // It depends on the azimuth, most of all where light comes nearly along the grooves.
  STRAY_HD double albedo(Vec3 wi) const {
    double const sine = std::sqrt(wi.x * wi.x + wi.y * wi.y), ratio = sine > 0 ? std::fabs(wi.x) / sine : 0,
                 c = ratio < 1 ? ratio : 1, a = width(c);
    Stencil const row(crowded(c * across / along, across / along), azimuths),
        column(crowded((wi.z > 0 ? wi.z : 0) / a, 1 / a), cosines);
    double sum = factor(wi.z);
    for (int i = 0; i < Stencil::points; ++i) sum += row.weight[i] * column.of(totals[row.first + i]);
    double const most = reflectance > grazing ? reflectance : grazing;
    return sum > most ? most : sum;
  }
  STRAY_HD double albedo(double cos_i) const { return mean.at(cos_i); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const {
    if (!(wi.z > 0)) return {};
    Vec3 const seen = unit(Vec3{across * wi.x, along * wi.y, wi.z});  // where the grooves are a hemisphere
    double const up = (1 - v) * (1 + seen.z), z = up - seen.z, round = std::sqrt(std::fmax(0.0, (1 - z) * (1 + z)));
    SinCos const turn = sincos_turn(u);
    Vec3 const h = unit(Vec3{across * (round * turn.cos + seen.x), along * (round * turn.sin + seen.y), up});
    Vec3 const wo = unit(2 * dot(wi, h) * h - wi);
    if (!(wo.z > 0)) return {};
    return {wo, pdf(wi, wo)};
  }
};

}  // namespace straytrace
