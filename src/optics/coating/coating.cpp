// SPDX-License-Identifier: BSD-3-Clause
#include "optics/coating/coating.hpp"

#include <algorithm>

namespace straytrace::optics {

Coating make_coating(std::span<CoatingRow const> rows, bool scatters, Storage& storage) {
  using Knot = AngleKnot<Coating::columns>;
  std::vector<Knot> knots;
  for (std::size_t i = rows.size(); i-- > 0;) {
    CoatingRow const& r = rows[i];
    double const cosine = r.angle >= pi / 2 ? 0 : std::cos(r.angle);
    knots.push_back({cosine,
                     {r.reflect_s, r.reflect_p, r.transmit_s, r.transmit_p, r.scatter, std::max(0.0, r.absorb_s()),
                      std::max(0.0, r.absorb_p())},
                     {}});
  }
  smooth(knots);
  Coating coating;
  coating.table.knots = storage.keep(std::move(knots));
  coating.scatters = scatters;
  return coating;
}

namespace {

// Absorption and specular share as published at 0 to 60, 70 and 80 deg; the shape from there to
// grazing, and the specular share at 70 deg, as in the table of the original without its offset of 0.2 on S, which
// agrees with the published absorption where both exist. S = 1 - R - A.
CoatingPreset tube_steel() {
  struct Row {
    double degrees, reflect, absorb;
  };
  constexpr Row rows[] = {{0, 0.005, 0.60}, {60, 0.005, 0.60}, {70, 0.02, 0.57}, {80, 0.11, 0.45},
                          {82, 0.19, 0.39}, {84, 0.26, 0.33},  {85, 0.30, 0.30}, {86, 0.40, 0.25},
                          {87, 0.50, 0.20}, {88, 0.70, 0.10},  {89, 0.90, 0.02}, {90, 1, 0}};
  CoatingPreset preset{"tube_steel", "published: Vinet et al. 1997, read off a plot; 1064 nm", {}};
  for (Row const& r : rows)
    preset.rows.push_back({r.degrees * pi / 180, r.reflect, r.reflect, 0, 0, 1 - r.reflect - r.absorb});
  return preset;
}

}  // namespace

std::span<CoatingPreset const> coating_presets() {
  static std::vector<CoatingPreset> const presets = {tube_steel()};
  return presets;
}

}  // namespace straytrace::optics
