// SPDX-License-Identifier: BSD-3-Clause
// Host side of lobe_table.hpp: quadrature of a model over rings about the specular direction. Without libm, so that the
// tables, and with them the fingerprint of a model, have the same bits everywhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/math/gauss_points.hpp"
#include "optics/lobes/lobe_table.hpp"

namespace straytrace::optics {

// Mean of eval cos along a ring, per area; `cut`: by the horizon. `turns`: points on half of the arc.
template <class Rings, class Law>
double mean_on_ring(Law const& law, Vec3 wi, double r, bool cut, Arc const& arc, GaussPoints const& turns) {
  if constexpr (requires { law.even_on_rings(); })
    if (!cut && law.even_on_rings()) return law.value_at({}, {}, r * r) * Rings::mean_cosine(arc);
  double mean = 0;
  for (std::size_t j = 0; j < turns.at.size(); ++j) {
    double const y = turns.at[j], turn = cut ? y * y * (3 - 2 * y) : y, rate = cut ? 6 * y * (1 - y) : 1;
    Vec3 const wo = Rings::direction(wi, r, sincos_turn(0.5 + 0.5 * turn * arc.half / pi));
    if (wo.z > 0) mean += turns.weight[j] * rate * law.eval(wi, wo) * wo.z / Rings::per_steradian(wo);
  }
  return mean;
}

// Integral of eval cos over the part of the ring [low, high] above the horizon. The horizon may cut the ring anywhere
// only when low >= Rings::cut; there the ends are approached smoothly, for the square roots at the horizon.
template <class Rings, class Law>
double ring_power(Law const& law, double cos_i, double sin_i, double low, double high, GaussPoints const& turns) {
  static GaussPoints const gauss(6);
  Vec3 const wi{sin_i, 0, cos_i};
  bool const cut = low >= Rings::cut(cos_i, sin_i) * (1 - 1e-12);
  double sum = 0;
  for (std::size_t i = 0; i < gauss.at.size(); ++i) {
    double const x = gauss.at[i], smooth = cut ? x * x * (3 - 2 * x) : x, slope = cut ? 6 * x * (1 - x) : 1;
    double const r = low + smooth * (high - low);
    Arc const arc = Rings::arc(wi, r * r);
    if (!(arc.half > 0)) continue;
    sum += gauss.weight[i] * slope * (high - low) * r * 2 * arc.half * mean_on_ring<Rings>(law, wi, r, cut, arc, turns);
  }
  return sum;
}

template <class Rings>
template <class Law>
void LobeTable<Rings>::ring_powers(Law const& law, double cos_i, GaussPoints const& turns, double* power) const {
  double const sin_i = std::sqrt((1 - cos_i) * (1 + cos_i)), cut = Rings::cut(cos_i, sin_i),
               last = std::sqrt(std::min(Rings::last2(sin_i), edge2[rings]));
  for (int i = 0; i < rings; ++i) {
    double const low = std::sqrt(edge2[i]), high = std::min(std::sqrt(edge2[i + 1]), last),
                 middle = std::clamp(cut, low, std::max(low, high));
    power[i] = 0;
    if (middle > low) power[i] += ring_power<Rings>(law, cos_i, sin_i, low, middle, turns);
    if (high > middle) power[i] += ring_power<Rings>(law, cos_i, sin_i, middle, high, turns);
  }
}

// As many rings as there is room for, from the ring that holds `first2` to the largest square, 4.
template <class Rings>
void LobeTable<Rings>::cut_into_rings(double first2, int inner) {
  constexpr int most_steps = 3;
  for (dropped = 52 - most_steps;; ++dropped) {
    before = static_cast<std::int64_t>(bits_of(first2) >> dropped) - inner;
    rings = static_cast<std::int64_t>(bits_of(4) >> dropped) - before;
    if (rings < most_rings) break;
  }
  for (std::int64_t i = 1; i <= rings; ++i) edge2[i] = number_of(static_cast<std::uint64_t>(before + i) << dropped);
  edge2[rings] *= 1 + 2e-15;  // opposite grazing directions are just inside
}

template <class Rings>
template <class Law>
void LobeTable<Rings>::prepare_rings(Law const& law, double smallest, double hole, GaussPoints const& turns) {
  double const first = hole > 0 ? hole : std::clamp(0.02 * smallest, 1e-12, 0.02);
  cut_into_rings(first * first, hole > 0 ? 0 : 1);
  edge2[0] = hole * hole;
  double power[most_rings];
  for (int row = 0; row < rows; ++row) {
    ring_powers(law, std::max(row_cosine(row), 1e-4), turns, power);
    double total = 0;
    for (int i = 0; i < rings; ++i) total += power[i];
    cumulative[row][0] = 0;
    for (int i = 0; i < rings; ++i) {
      double const share = total > 0 ? power[i] / total : (edge2[i + 1] - edge2[i]) / edge2[rings];
      cumulative[row][i + 1] = cumulative[row][i] + share;
    }
    double const all = cumulative[row][rings];
    for (int i = 1; i <= rings; ++i) cumulative[row][i] /= all;
  }
}

template <class Rings>
template <class Law>
void LobeTable<Rings>::prepare(Law const& law, double smallest, double hole, int azimuths) {
  GaussPoints const turns(azimuths);
  prepare_rings(law, smallest, hole, turns);
  double power[most_rings];
  constexpr double lowest = 1e-9;  // replaces the limit at grazing
  for (int k = 0; k < AlbedoTable::size; ++k) {
    ring_powers(law, std::max(AlbedoTable::cosine(k), lowest), turns, power);
    albedo.value[k] = 0;
    for (int i = 0; i < rings; ++i) albedo.value[k] += power[i];
  }
}

}  // namespace straytrace::optics
