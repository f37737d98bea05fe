// SPDX-License-Identifier: BSD-3-Clause
// Machined surface: fine grooves whose flanks are small mirrors. GGX (Trowbridge-Reitz) distribution of normals with a
// width across the grooves (local x) and another along them (local y), height-correlated Smith shadowing, one
// reflection: BSDF = F(i.h) D(h) G(i, o)/(4 cos_i cos_s), h = unit(wi + wo). Samples are drawn from the normals seen
// from wi (Heitz 2018; as spherical caps, Dupuy and Benyoub 2023): eval cos/pdf = F G/G1, at most F.
// Page: docs/reference/scatter/grooves.md.
#pragma once

#include "optics/bsdf.hpp"

namespace straytrace {

struct Grooves {
  double across = 0.3, along = 0.02;  // widths of the normals, tangents of slope, above 0 and at most 1
  double reflectance = 0;             // F at normal incidence on a flank
  double grazing = 0;                 // F at grazing incidence
  static constexpr int azimuths = 17;
  AlbedoTable totals[azimuths];  // set by prepare(); row i: cosine of the azimuth from x is (i/16)^2
  AlbedoTable mean;              // over the azimuth
  static constexpr char const* key = "grooves";

  void prepare();  // host

  STRAY_HD static double azimuth_cosine(int i) { return double(i) * i / ((azimuths - 1) * (azimuths - 1)); }
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
    double const sine = std::sqrt(wi.x * wi.x + wi.y * wi.y), c = sine > 0 ? std::fabs(wi.x) / sine : 0,
                 x = (azimuths - 1) * std::sqrt(c < 1 ? c : 1);
    int const i = x < azimuths - 1 ? static_cast<int>(x) : azimuths - 2;
    double const low = azimuth_cosine(i), share = (c - low) / (azimuth_cosine(i + 1) - low), from = totals[i].at(wi.z);
    return from + (share < 0 ? 0 : share > 1 ? 1 : share) * (totals[i + 1].at(wi.z) - from);
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
