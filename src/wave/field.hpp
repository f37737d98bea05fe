// SPDX-License-Identifier: BSD-3-Clause
// Scalar paraxial fields on a square grid across an axis (docs/theory/wave.md).
#pragma once

#include <algorithm>
#include <complex>
#include <vector>

#include "base/math/functions.hpp"
#include "base/namespaces.hpp"
#include "base/process/threads.hpp"

namespace straytrace::wave {

using Complex = std::complex<double>;

inline Complex turned(double turns) {  // exp(2 pi i turns)
  SinCos const at = sincos_turn(turns);
  return {at.cos, at.sin};
}

// N x N points of one pitch. Point (row, column) is at y = at(row), x = at(column); point N/2 is on the axis.
struct Grid {
  int points = 0;     // even
  double window = 0;  // m, side of the square

  double pitch() const { return window / points; }  // m
  double at(int i) const { return (i - points / 2) * pitch(); }
  // Of element i of a transform: i for i < N/2, i - N from there. 1/m
  double frequency(int i) const { return (i < points / 2 ? i : i - points) / window; }
  double largest_angle(double wavelength) const { return wavelength / (2 * pitch()); }  // rad, of Nyquist's frequency
  std::size_t size() const { return std::size_t(points) * std::size_t(points); }
  bool operator==(Grid const&) const = default;
};

// exp(i(kz - wt)) with exp(ikz) taken out, in sqrt(W)/m; or its spectrum in the order of `Grid::frequency`.
struct Field {
  Grid grid;
  std::vector<Complex> values;  // [row * N + column]

  explicit Field(Grid const& g) : grid(g), values(g.size()) {}
  Complex& operator()(int row, int column) { return values[std::size_t(row) * std::size_t(grid.points) + column]; }
  Complex operator()(int row, int column) const { return values[std::size_t(row) * std::size_t(grid.points) + column]; }
};

// Calls work(row) for rows first to last - 1, each once, on `threads` threads (0: all). `work` must not throw.
template <class Work>
void for_rows(int first, int last, int threads, Work const& work) {
  constexpr int group = 16;
  if (last <= first) return;
  in_parallel(std::size_t((last - first + group - 1) / group), unsigned(threads), [&](std::size_t i) {
    int const from = first + int(i) * group;
    for (int row = from; row < std::min(from + group, last); ++row) work(row);
  });
}

}  // namespace straytrace::wave
