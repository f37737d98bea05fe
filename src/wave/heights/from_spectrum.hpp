// SPDX-License-Identifier: BSD-3-Clause
// Heights on a grid from the amplitudes of their frequencies.
#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "wave/heights/height_map.hpp"
#include "wave/transform.hpp"

namespace straytrace::wave {

// spectrum(column, row): the amplitude [m] of the frequency (column, row)/window along x and y, times the number of
// points of the grid; that of the opposite frequency is its conjugate, because heights are real. Frequencies up to
// `largest_frequency` [1/m].
template <class Spectrum>
std::vector<double> heights_from_spectrum(Grid const& grid, double largest_frequency, Spectrum const& spectrum) {
  int const n = grid.points;
  double const largest = periods_across(largest_frequency, grid);
  int const most = int(std::fmin(n / 2 - 1, largest));
  Field field(grid);
  // Half of the frequencies. The inverse transform divides by the number of points; signs put the axis into the middle
  // of the grid.
  for (int column = 0; column <= most; ++column)
    for (int row = column == 0 ? 0 : -most; row <= most; ++row) {
      if (std::hypot(row, column) > largest) continue;
      Complex const amplitude = spectrum(column, row), value = (row + column) % 2 == 0 ? amplitude : -amplitude;
      field((n - row) % n, (n - column) % n) = std::conj(value);
      field((row + n) % n, column) = value;
    }
  Transform(n, 0).inverse(field, 2 * most + 2, n);
  std::vector<double> heights;
  heights.reserve(grid.size());
  for (Complex const v : field.values) heights.push_back(v.real());
  return heights;
}

}  // namespace straytrace::wave
