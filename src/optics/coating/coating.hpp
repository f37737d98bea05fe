// SPDX-License-Identifier: BSD-3-Clause
// Surfaces known by their shares of power against the angle of incidence. Page: docs/reference/interfaces/coating.md.
#pragma once

#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include "base/memory/storage.hpp"
#include "optics/polarisation.hpp"

namespace straytrace::optics {

// Columns of numbers against the angle of incidence, as measured or specified. Between the entries: cubics in the
// cosine, smooth, without overshoot, and the same for all columns, so that relations between columns (sums, shares)
// that hold at the entries hold everywhere.
template <int N>
struct AngleKnot {
  double cosine = 0;
  double value[N] = {}, slope[N] = {};  // slope: per cosine
};

template <int N>
struct AngleColumns {
  double value[N] = {};
};

template <int N>
struct AngleTable {
  View<AngleKnot<N> const> knots;  // by rising cosine, at least two; constant beyond the last ones

  STRAY_HD AngleColumns<N> at(double cosine) const {
    std::size_t low = 0, high = knots.size - 1;
    while (high - low > 1) {
      std::size_t const mid = low + (high - low) / 2;
      (knots[mid].cosine <= cosine ? low : high) = mid;
    }
    AngleKnot<N> const &a = knots[low], &b = knots[high];
    double const step = b.cosine - a.cosine, raw = (cosine - a.cosine) / step;
    double const x = raw < 0 ? 0 : raw > 1 ? 1 : raw, y = 1 - x;
    AngleColumns<N> out;
    for (int i = 0; i < N; ++i)
      out.value[i] = y * y * (1 + 2 * x) * a.value[i] + x * x * (1 + 2 * y) * b.value[i] +
                     step * x * y * (y * a.slope[i] - x * b.slope[i]);
    return out;
  }
};

// Fills in the slopes of knots sorted by rising cosine: those of the parabola through three neighbours, times one
// factor per knot for all columns, so that each column stays between its entries (Fritsch and Carlson 1980).
template <int N>
void smooth(std::vector<AngleKnot<N>>& knots) {
  constexpr double rounding = 1e-12;  // slopes and chords below it are zero
  std::size_t const last = knots.size() - 1;
  auto const chord = [&](std::size_t k, int i) {
    return (knots[k + 1].value[i] - knots[k].value[i]) / (knots[k + 1].cosine - knots[k].cosine);
  };
  for (std::size_t k = 0; k <= last; ++k) {
    double factor = 1;
    auto const keep_between = [&](double slope, double secant) {
      if (std::fabs(slope) < rounding) return;
      if (slope * secant <= 0) factor = 0;
      if (std::fabs(slope) > 3 * std::fabs(secant)) factor = std::fmin(factor, 3 * std::fabs(secant / slope));
    };
    for (int i = 0; i < N; ++i) {
      double const left = chord(k > 0 ? k - 1 : 0, i), right = chord(k < last ? k : last - 1, i);
      double const before = k > 0 ? knots[k].cosine - knots[k - 1].cosine : 1;
      double const after = k < last ? knots[k + 1].cosine - knots[k].cosine : 1;
      double const slope = (after * left + before * right) / (before + after);
      knots[k].slope[i] = slope;
      keep_between(slope, left);
      keep_between(slope, right);
    }
    for (double& slope : knots[k].slope) slope *= factor;
  }
}

// Shares of power reflected and transmitted, for s and p, and scattered; the rest is absorbed. Phases are those of the
// unitary interface (docs/theory/conventions.md).
struct Coating {
  enum Column { reflect_s, reflect_p, transmit_s, transmit_p, scatter, absorb_s, absorb_p, columns };
  AngleTable<columns> table;
  bool scatters = false;  // the table gives the scattered share; otherwise the models of the material do

  static constexpr char const* key = "coating";
  static constexpr bool yields_to_scatter = false;

  // Angle of the incident light. Beyond the critical angle no light passes: the transmitted share of the table is
  // reflected instead.
  STRAY_HD Amplitudes amplitudes(double cos_i, double n_in, double n_out, bool /*front*/) const {
    AngleColumns<columns> const c = table.at(cos_i);
    double share[4];
    for (int i = 0; i < 4; ++i) share[i] = std::fmax(0.0, c.value[i]);
    if (n_in * n_in * (1 - cos_i * cos_i) >= n_out * n_out && n_in > n_out)
      for (int i = 0; i < 2; ++i) {
        share[i] += share[i + 2];
        share[i + 2] = 0;
      }
    return unitary_amplitudes(share[reflect_s], share[reflect_p], share[transmit_s], share[transmit_p]);
  }
  STRAY_HD double scattered(double cos_i) const {
    return scatters ? std::fmax(0.0, table.at(cos_i).value[scatter]) : -1;
  }
  template <class F>
  void numbers(F&& f) const {
    for (std::size_t k = 0; k < table.knots.size; ++k) {
      f(table.knots[k].cosine);
      for (double x : table.knots[k].value) f(x);
    }
    f(double(scatters));
  }
};

struct CoatingRow {
  double angle = 0;  // rad, of incidence
  double reflect_s = 0, reflect_p = 0, transmit_s = 0, transmit_p = 0;
  double scatter = 0;

  double absorb_s() const { return 1 - reflect_s - transmit_s - scatter; }
  double absorb_p() const { return 1 - reflect_p - transmit_p - scatter; }
};

// Rows by rising angle, two or more, each with shares that sum to at most 1.
Coating make_coating(std::span<CoatingRow const>, bool scatters, Storage&);

struct CoatingPreset {
  std::string_view name, source;
  std::vector<CoatingRow> rows;
};
std::span<CoatingPreset const> coating_presets();

}  // namespace straytrace::optics
