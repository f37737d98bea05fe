// SPDX-License-Identifier: BSD-3-Clause
// Particles lying on a reflecting surface: Mie scatter over a size distribution, four paths per particle (direct,
// reflected before or after or both), physics.md eq. 3.22 and 3.23. Particles hide one another at grazing: the factor
// 1/(cos_i cos_s) of eq. 3.22 is replaced by (1 - exp(-tau (1/cos_i + 1/cos_s)))/(tau (cos_i + cos_s)), tau =
// (1 + R) times the optical depth of the layer, which keeps the albedo below 1 and is the same for tau -> 0. Page:
// docs/reference/scatter/dust.md.
#pragma once

#include <vector>

#include "optics/lobe_table.hpp"

namespace straytrace {

struct Dust {
  static constexpr int nodes = 512;
  double optical_depth = 0;        // particles per area times their mean extinction cross-section
  double reflectance = 0;          // of the surface below
  double scatter[nodes + 1] = {};  // particles per area times |S|^2/k^2, 1/sr, at chords 2 (i/nodes)^4
  double smallest = 1e-3;          // chord inside which it is flat
  LobeTable<EvenChordRings> lobe;  // set by prepare()
  static constexpr char const* key = "dust";

  void prepare();  // host

  static double chord(int i) {  // 2 sin(scattering angle/2)
    double const root = double(i) / nodes * (double(i) / nodes);
    return 2 * root * root;
  }
  STRAY_HD double scatter_at(double t) const {
    double const x = nodes * std::sqrt(std::sqrt(t < 2 ? 0.5 * t : 1));
    int const i = x < nodes ? static_cast<int>(x) : nodes - 1;
    return scatter[i] + (x - i) * (scatter[i + 1] - scatter[i]);
  }
  STRAY_HD double eval(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    double const back = scatter_at(length(wi + wo)), forward = scatter_at(length(wo - specular(wi)));
    double const depth = (1 + reflectance) * optical_depth, slant = depth * (1 / wi.z + 1 / wo.z);
    double const lit = slant < 1e-6 ? 1 / (wi.z * wo.z) : (1 - exp_number(-slant)) / (depth * (wi.z + wo.z));
    return lit * ((1 + reflectance * reflectance) * back + 2 * reflectance * forward);
  }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const { return lobe.pdf(wi, wo); }
  STRAY_HD double albedo(double cos_i) const { return lobe.albedo.at(cos_i); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const { return lobe.sample(wi, u, v); }
};

// Particles per area and size: IEST-STD-CC1246 (physics.md eq. 3.21). Host only.
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
void add_grains(Dust&, std::vector<Grain> const&, double wavelength, double index, double extinction);

}  // namespace straytrace
