// SPDX-License-Identifier: BSD-3-Clause
// Columns of numbers against the angle of incidence, as measured or specified. Between the entries: cubics in the
// cosine, smooth, without overshoot, and the same for all columns, so that what holds at the entries between columns
// (sums, shares) holds everywhere.
#pragma once

#include <cmath>
#include <vector>

#include "base/memory/ids.hpp"

namespace straytrace {

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

}  // namespace straytrace
