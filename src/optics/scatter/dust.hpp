// SPDX-License-Identifier: BSD-3-Clause
// Particles on a reflecting surface. Page: docs/reference/scatter/dust.md.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "base/memory/ids.hpp"
#include "optics/lobes/lobe_table.hpp"

namespace straytrace {
class Storage;
}  // namespace straytrace

namespace straytrace::optics {

// A positive function of the scattering angle Theta from 0 to 180 deg, as fine as it varies: each half of the angles
// has panels even in sin(Theta/2) from the forward, in cos(Theta/2) from the backward direction, each panel as many
// cells as it needs, each cell a polynomial. Where the function is even at both ends, as intensities are, it is smooth
// in these.
struct DeflectionTable {
  static constexpr int order = 5, panels = 32;  // order of the polynomials; panels of each half
  static constexpr double tolerance = 2e-5;     // share of the value that interpolation may miss
  struct Panel {
    std::uint32_t first = 0, cells = 1;  // number of its first cell
  };
  View<Panel const> panel;  // those of the forward half, then those of the backward half, both from their end
  View<double const> term;  // order + 1 per cell: divided differences over `order` even steps, for Newton's form

  // At s = sin^2(Theta/2).
  STRAY_HD double at(double s) const {
    bool const behind = s > 0.5;
    double const near = behind ? 1 - s : s, x = near > 0 ? panels * std::sqrt(2 * near) : 0;
    int const p = x < panels ? static_cast<int>(x) : panels - 1;
    Panel const in = panel[static_cast<std::size_t>(behind ? panels + p : p)];
    double const y = (x - p) * in.cells;
    std::uint32_t const cell = y < in.cells ? static_cast<std::uint32_t>(y) : in.cells - 1;
    double const* const t = term.data + std::size_t{in.first + cell} * (order + 1);
    double const z = order * (y - cell);
    double value = t[order];
    for (int k = order - 1; k >= 0; --k) value = t[k] + (z - k) * value;
    return value;
  }
};

// Table of sum over l of series[l] cos(l Theta), which must be positive. Host only; the same bits on every machine.
DeflectionTable make_deflection_table(std::vector<double> series, Storage&);

// Mie scatter over a size distribution, four paths per particle (direct, reflected before or after or both),
// docs/theory/surfaces.md, eq. 3.22 and 3.23. Particles shadow one another at grazing incidence: the factor
// 1/(cos_i cos_s) of eq. 3.22 is replaced by (1 - exp(-tau (1/cos_i + 1/cos_s)))/(tau (cos_i + cos_s)), where tau is
// (1 + R) times the optical depth of the layer. It keeps the albedo below 1 and has the same limit for tau -> 0.
struct Dust : SampledByLobe<Dust, EvenChordRings> {
  double optical_depth = 0;  // particles per area times their mean extinction cross-section
  double reflectance = 0;    // of the surface below
  double smallest = 1e-3;    // chord inside which the forward lobe is flat
  DeflectionTable scatter;   // particles per area times |S|^2/k^2, 1/sr
  // Set by prepare(); its albedo is that of the layer times grazed(), which varies little.
  LobeTable<EvenChordRings> lobe;
  static constexpr char const* key = "dust";

  void prepare();  // host

  STRAY_HD double seen_depth() const { return (1 + reflectance) * optical_depth; }
  // Factor of the scatter for the paths of light that comes in and goes out at these cosines, 1/(cos cos) where thin.
  STRAY_HD double lit(double cos_i, double cos_s) const {
    double const depth = seen_depth(), slant = depth * (1 / cos_i + 1 / cos_s);
    return slant < 1e-6 ? 1 / (cos_i * cos_s) : (1 - exp_number(-slant)) / (depth * (cos_i + cos_s));
  }
  STRAY_HD double value_at(Vec3 wi, Vec3 wo, double t2) const {
    double const back = scatter.at(0.25 * length2(wi + wo)), forward = scatter.at(0.25 * t2);
    return lit(wi.z, wo.z) * ((1 + reflectance * reflectance) * back + 2 * reflectance * forward);
  }
  static constexpr double lowest_cosine = 1e-9;  // of incidence, replaces the limit at grazing
  STRAY_HD double grazed(double cos_i) const { return (cos_i > lowest_cosine ? cos_i : lowest_cosine) + seen_depth(); }
  STRAY_HD double albedo(double cos_i) const { return lobe.albedo.at(cos_i) / grazed(cos_i); }
};

// Particles per area and size: IEST-STD-CC1246 (docs/theory/surfaces.md, eq. 3.21). Host only.
struct Cleanliness {
  double level = 0, slope = 0.926;      // level: size in um at which one particle per 0.1 m^2 is larger
  double smallest = 1e-6, largest = 0;  // m; 0: the level
  double covered() const;               // share of the area, by integration
  double covered_by_fit() const;        // 10^(-7.245 + 0.926 log10^2 level) %
};

struct Grain {
  double diameter, per_area;  // m, 1/m^2
};
std::vector<Grain> grains(Cleanliness const&, int classes = 160);
// Fills optical depth and scatter table. Throws NumericalError for sizes beyond the reach of mie().
void set_grains(Dust&, std::vector<Grain> const&, double wavelength, double index, double extinction, Storage&);

}  // namespace straytrace::optics
