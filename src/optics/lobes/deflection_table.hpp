// SPDX-License-Identifier: BSD-3-Clause
// A positive function of the scattering angle Theta from 0 to 180 deg, as fine as it varies: each half of the angles
// has panels even in sin(Theta/2) from the forward, in cos(Theta/2) from the backward direction, each panel as many
// cells as it needs, each cell a polynomial. Where the function is even at both ends, as intensities are, it is smooth
// in these.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "base/memory/ids.hpp"

namespace straytrace {

class Storage;

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

// Of the function sum over l of series[l] cos(l Theta), positive everywhere. Host only. With the same bits everywhere.
DeflectionTable make_deflection_table(std::vector<double> series, Storage&);

}  // namespace straytrace
