// SPDX-License-Identifier: BSD-3-Clause
// Particles lying on a reflecting surface: Mie scatter over a size distribution, four paths per particle (direct,
// reflected before or after or both), docs/theory/surfaces.md, eq. 3.22 and 3.23. Particles hide one another at
// grazing: the factor 1/(cos_i cos_s) of eq. 3.22 is replaced by (1 - exp(-tau (1/cos_i + 1/cos_s)))/(tau (cos_i +
// cos_s)), tau = (1 + R) times the optical depth of the layer, which keeps the albedo below 1 and is the same for tau
// -> 0. Page: docs/reference/scatter/dust.md.
#pragma once

#include <vector>

#include "optics/lobes/deflection_table.hpp"
#include "optics/lobes/lobe_table.hpp"

namespace straytrace {

struct Dust {
  double optical_depth = 0;  // particles per area times their mean extinction cross-section
  double reflectance = 0;    // of the surface below
  double smallest = 1e-3;    // chord inside which the forward lobe is flat
  DeflectionTable scatter;   // particles per area times |S|^2/k^2, 1/sr
  LobeTable<EvenChordRings>
      lobe;  // set by prepare(); its albedo is that of the layer times grazed(), which varies little
  static constexpr char const* key = "dust";

  void prepare();  // host

  STRAY_HD double seen_depth() const { return (1 + reflectance) * optical_depth; }
  // Factor of the scatter for the paths of light that comes in and goes out at these cosines, 1/(cos cos) where thin.
  STRAY_HD double lit(double cos_i, double cos_s) const {
    double const depth = seen_depth(), slant = depth * (1 / cos_i + 1 / cos_s);
    return slant < 1e-6 ? 1 / (cos_i * cos_s) : (1 - exp_number(-slant)) / (depth * (cos_i + cos_s));
  }
  STRAY_HD double eval(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    Vec3 const away = wi + wo, aside = wo - specular(wi);
    double const back = scatter.at(0.25 * dot(away, away)), forward = scatter.at(0.25 * dot(aside, aside));
    return lit(wi.z, wo.z) * ((1 + reflectance * reflectance) * back + 2 * reflectance * forward);
  }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const { return lobe.pdf(wi, wo); }
  static constexpr double lowest_cosine = 1e-9;  // of incidence, stands for the limit at grazing
  STRAY_HD double grazed(double cos_i) const { return (cos_i > lowest_cosine ? cos_i : lowest_cosine) + seen_depth(); }
  STRAY_HD double albedo(double cos_i) const { return lobe.albedo.at(cos_i) / grazed(cos_i); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const { return lobe.sample(wi, u, v); }
};

// Particles per area and size: IEST-STD-CC1246 (docs/theory/surfaces.md, eq. 3.21). Host only.
struct Cleanliness {
  double level = 0, slope = 0.926;          // level: size in um at which one particle per 0.1 m^2 is larger
  double smallest = 1e-6, largest = 0;      // m; 0: the level
  double more_than(double diameter) const;  // particles per m^2 larger than this (m)
  double covered() const;                   // share of the area, by integration
  double covered_by_fit() const;            // 10^(-7.245 + 0.926 log10^2 level) %
};

struct Grain {
  double diameter, per_area;  // m, 1/m^2
};
std::vector<Grain> grains(Cleanliness const&, int classes = 160);
// Fills optical depth and scatter table. Throws NumericalError for sizes beyond the reach of mie().
void set_grains(Dust&, std::vector<Grain> const&, double wavelength, double index, double extinction, Storage&);

}  // namespace straytrace
