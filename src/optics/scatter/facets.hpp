// SPDX-License-Identifier: BSD-3-Clause
// Surfaces of small mirrors: microfacet (rough) and grooves (machined). GGX (Trowbridge-Reitz) distribution of normals,
// height-correlated Smith shadowing, one reflection: BSDF = F(i.h) D(h) G(i, o)/(4 cos_i cos_s), h = unit(wi + wo).
// Samples are drawn from the normals seen from wi (Heitz 2018; as spherical caps, Dupuy and Benyoub 2023):
// eval cos/pdf = F G/G1, at most F. Pages:
// docs/reference/scatter/microfacet.md, docs/reference/scatter/grooves.md.
#pragma once

#include "optics/lobes/bsdf.hpp"

namespace straytrace::optics {

struct Facets {
  double across = 1, along = 1;  // widths of the normals
  double reflectance = 0, grazing = 0;
};

// Integral of eval cos over the hemisphere, wi.z > 0, never above the larger reflectance. The energy balance calls
// 1 - total absorbed, so it must be the mean of the samples. step: of the quadrature; the default leaves 1e-7.
double facets_total(Facets const&, Vec3 wi, double step = 0.14);

// From 0 (v = 0) to 1 (v = most): half even in v, half in its logarithm above 1, crowded at 0.
STRAY_HD double crowded(double v, double most) {
  double const x = log_positive(v + std::sqrt(v * v + 1)) / log_positive(most + std::sqrt(most * most + 1));
  double const y = 0.5 * (x + v / most);
  return std::sqrt(y < 1 ? y : 1);
}
double uncrowded(double x, double most);  // host

// Lagrange's polynomial through six of `size` nodes even over 0 to 1.
struct Stencil {
  static constexpr int points = 6;
  int first;
  double weight[points];

  STRAY_HD Stencil(double x, int size) {
    x *= size - 1;
    int const left = static_cast<int>(x) - 2;
    first = left < 0 ? 0 : left > size - points ? size - points : left;
    constexpr double scale[points] = {-1.0 / 120, 1.0 / 24, -1.0 / 12, 1.0 / 12, -1.0 / 24, 1.0 / 120};
    for (int i = 0; i < points; ++i) {
      weight[i] = scale[i];
      for (int k = 0; k < points; ++k)
        if (k != i) weight[i] *= x - (first + k);
    }
  }
  STRAY_HD double of(double const* value) const {
    double sum = 0;
    for (int i = 0; i < points; ++i) sum += weight[i] * value[first + i];
    return sum;
  }
};

// Common part of both models. A model has widths of its normals, `across` along local x and `along` along local y;
// normals(h), D in 1/sr, whose integral times the cosine over the hemisphere is 1; and slant(w) = cos (1 + 2 Lambda) of
// Smith's shadowing, G1 = 2 cos/(cos + slant).
template <class Model>
struct SmallMirrors {
  STRAY_HD double factor(double cosine) const {  // F: Schlick 1994; cosine: incidence on the small mirror
    double const x = cosine < 1 ? 1 - cosine : 0, square = x * x;
    return model().reflectance + (model().grazing - model().reflectance) * square * square * x;
  }
  STRAY_HD double limited(double total) const {
    double const most = model().reflectance > model().grazing ? model().reflectance : model().grazing;
    return total > most ? most : total;
  }
  STRAY_HD double eval(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    Vec3 const sum = wi + wo;
    double const size = length(sum);  // 2 i.h
    return factor(size / 2) * model().normals((1 / size) * sum) /
           (2 * (wo.z * model().slant(wi) + wi.z * model().slant(wo)));
  }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    return model().normals(unit(wi + wo)) / (2 * (wi.z + model().slant(wi)));
  }
  STRAY_HD ValueAndPdf both(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    Vec3 const sum = wi + wo;
    double const size = length(sum), slant = model().slant(wi), normals = model().normals((1 / size) * sum);
    return {factor(size / 2) * normals / (2 * (wo.z * slant + wi.z * model().slant(wo))),
            normals / (2 * (wi.z + slant))};
  }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const {
    if (!(wi.z > 0)) return {};
    double const x = model().width_x(), y = model().width_y();
    Vec3 const seen = unit(Vec3{x * wi.x, y * wi.y, wi.z});  // where the surface is a hemisphere
    double const up = (1 - v) * (1 + seen.z), z = up - seen.z, round = std::sqrt(std::fmax(0.0, (1 - z) * (1 + z)));
    SinCos const turn = sincos_turn(u);
    Vec3 const h = unit(Vec3{x * (round * turn.cos + seen.x), y * (round * turn.sin + seen.y), up});
    Vec3 const wo = unit(2 * dot(wi, h) * h - wi);
    if (!(wo.z > 0)) return {};
    return {wo, pdf(wi, wo)};
  }

 private:
  STRAY_HD Model const& model() const { return static_cast<Model const&>(*this); }
};

struct Microfacet : SmallMirrors<Microfacet> {
  double alpha = 0.1;      // roughness, above 0 and at most 1
  double reflectance = 0;  // F at normal incidence on a small mirror
  double grazing = 0;      // F at grazing incidence; equal to `reflectance`: the same at every angle
  static constexpr int cosines = 128;
  // Set by prepare(): total above factor(cosine), even in crowded(cosine/alpha, 1/alpha).
  double totals[cosines] = {};
  static constexpr char const* key = "microfacet";
  static ModelKeys<Microfacet> keys();

  void prepare();  // host

  STRAY_HD double width_x() const { return alpha; }
  STRAY_HD double width_y() const { return alpha; }
  STRAY_HD double normals(Vec3 h) const {
    double const square = alpha * alpha, spread = h.x * h.x + h.y * h.y + square * h.z * h.z;
    return square / (pi * spread * spread);
  }
  STRAY_HD double slant(Vec3 w) const { return std::sqrt(w.z * w.z + alpha * alpha * (w.x * w.x + w.y * w.y)); }
  STRAY_HD double albedo(double cos_i) const {
    return limited(factor(cos_i) + Stencil(crowded((cos_i > 0 ? cos_i : 0) / alpha, 1 / alpha), cosines).of(totals));
  }
};

// Fine grooves whose flanks are small mirrors, across local x.
struct Grooves : SmallMirrors<Grooves> {
  double across = 0.3, along = 0.02;  // widths of the normals, tangents of slope, above 0 and at most 1
  double reflectance = 0;             // F at normal incidence on a flank
  double grazing = 0;                 // F at grazing incidence
  static constexpr int azimuths = 64, cosines = 96;
  double totals[azimuths][cosines] = {};  // set by prepare(): the part above factor(cosine), at node()
  AlbedoTable mean;                       // over the azimuth
  static constexpr char const* key = "grooves";
  static ModelKeys<Grooves> keys();
  ModelComplaint impossible() const;

  void prepare();                        // host
  Vec3 node(int row, int column) const;  // host: incidence of an entry

  STRAY_HD double width_x() const { return across; }
  STRAY_HD double width_y() const { return along; }
  // Width of the normals in the plane of incidence, on which the total at a cosine depends most.
  STRAY_HD double width(double cos_azimuth) const {
    double const x = across * cos_azimuth, square = (1 - cos_azimuth) * (1 + cos_azimuth) * along * along;
    return std::sqrt(x * x + square);
  }
  STRAY_HD double normals(Vec3 h) const {
    double const x = h.x / across, y = h.y / along, spread = x * x + y * y + h.z * h.z;
    return 1 / (pi * across * along * spread * spread);
  }
  STRAY_HD double slant(Vec3 w) const {
    double const x = across * w.x, y = along * w.y;
    return std::sqrt(w.z * w.z + x * x + y * y);
  }
  // It depends on the azimuth, most of all where light comes nearly along the grooves.
  STRAY_HD double albedo(Vec3 wi) const {
    double const sine = std::sqrt(wi.x * wi.x + wi.y * wi.y), ratio = sine > 0 ? std::fabs(wi.x) / sine : 0,
                 c = ratio < 1 ? ratio : 1, a = width(c);
    Stencil const row(crowded(c * across / along, across / along), azimuths),
        column(crowded((wi.z > 0 ? wi.z : 0) / a, 1 / a), cosines);
    double sum = factor(wi.z);
    for (int i = 0; i < Stencil::points; ++i) sum += row.weight[i] * column.of(totals[row.first + i]);
    return limited(sum);
  }
  STRAY_HD double albedo(double cos_i) const { return mean.at(cos_i); }
};

}  // namespace straytrace::optics
