// SPDX-License-Identifier: BSD-3-Clause
#include "wave/sampler.hpp"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/functions.hpp"

namespace straytrace::wave {
namespace {

constexpr int kernel_points = 14;
constexpr double half_kernel = kernel_points / 2;  // pitches
constexpr double interpolated_band = 0.5 * 0.72;   // cycles per pitch
// Aliases of the band begin at 1 - 0.36 cycles per pitch. A little below that, their sum is smallest.
constexpr double kernel_shape = 2 * pi * half_kernel * 0.635;

// Kaiser-Bessel kernel at t pitches from its centre, 1 there.
double kaiser_bessel(double t) {
  double const x = t / half_kernel;
  return std::cyl_bessel_i(0.0, kernel_shape * std::sqrt(std::fmax(0.0, 1 - x * x))) /
         std::cyl_bessel_i(0.0, kernel_shape);
}

// Its transform at a frequency in the band, cycles per pitch.
double kernel_transform(double frequency) {
  double const q = 2 * pi * half_kernel * frequency, root = std::sqrt(kernel_shape * kernel_shape - q * q);
  return 2 * half_kernel * std::sinh(root) / (root * std::cyl_bessel_i(0.0, kernel_shape));
}

// Between two points of the grid the kernels of the next 14 points are polynomials of v, from -1 at the lower point to
// 1 at the upper one.
class KernelPieces {
 public:
  using Weights = std::array<double, kernel_points>;

  KernelPieces() {
    for (int piece = 0; piece < kernel_points; ++piece) fill(piece);
  }

  // Kernels of points -6 to 7 from the lower one, and their derivatives by the place in pitches.
  void evaluate(double v, Weights& value, Weights& slope) const {
    value = coefficients_[terms - 1];
    slope = {};
    for (int n = terms - 2; n >= 0; --n)
      for (int i = 0; i < kernel_points; ++i) {
        slope[i] = slope[i] * v + value[i];
        value[i] = value[i] * v + coefficients_[n][i];
      }
    for (double& s : slope) s *= 2;
  }

 private:
  static constexpr int terms = 16;
  std::array<Weights, terms> coefficients_{};  // of v^n

  // Interpolation at Chebyshev's points: its series in Chebyshev polynomials, as powers.
  void fill(int piece) {
    std::array<double, terms> polynomial{1}, before{};
    for (int order = 0; order < terms; ++order) {
      double sum = 0;
      for (int j = 0; j < terms; ++j) {
        double const turn = (j + 0.5) / (2 * terms);
        sum +=
            kaiser_bessel(0.5 * (sincos_turn(turn).cos + 1) + half_kernel - 1 - piece) * sincos_turn(order * turn).cos;
      }
      for (int n = 0; n < terms; ++n) coefficients_[n][piece] += polynomial[n] * sum * (order == 0 ? 1.0 : 2.0) / terms;
      std::array<double, terms> next{};
      for (int n = 0; n < terms; ++n)
        next[n] = (n > 0 ? (order == 0 ? 1 : 2) * polynomial[n - 1] : 0) - (order == 0 ? 0 : before[n]);
      before = std::exchange(polynomial, next);
    }
  }
};

KernelPieces const& kernel_pieces() {
  static KernelPieces const pieces;
  return pieces;
}

// The points of one axis that a place takes part of.
struct KernelSpan {
  std::array<int, kernel_points> index;
  KernelPieces::Weights value, slope;

  KernelSpan(Grid const& grid, double place) {
    double const at = place / grid.pitch() + grid.points / 2, lower = std::floor(at);
    kernel_pieces().evaluate(2 * (at - lower) - 1, value, slope);
    for (int i = 0; i < kernel_points; ++i)
      index[i] = (int(lower) - kernel_points / 2 + 1 + i + grid.points) % grid.points;
  }
};

// Columns that are not wanted become zero, whatever they hold.
Field divided_by_kernel(Field spectrum, int columns) {
  int const n = spectrum.grid.points;
  std::vector<double> factor(static_cast<std::size_t>(n));  // 0 beyond the band
  for (int i = 0; i < n; ++i) {
    double const frequency = spectrum.grid.frequency(i) * spectrum.grid.pitch();
    factor[i] = std::fabs(frequency) <= interpolated_band ? 1 / kernel_transform(frequency) : 0;
  }
  double inside = 0, beyond = 0;
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column) {
      Complex& value = spectrum(row, column);
      bool const wanted = column < columns / 2 || column >= n - columns / 2;
      double const scale = wanted ? factor[row] * factor[column] : 0;
      if (wanted) (scale > 0 ? inside : beyond) += std::norm(value);
      value *= scale;
    }
  if (beyond > 1e-18 * inside)
    throw NumericalError(
        "the grid is too coarse for its field: it holds light beyond 0.72 of the largest angle of the grid, where it "
        "cannot be interpolated");
  return spectrum;
}

}  // namespace

Sampler::Sampler(Field spectrum, Transform const& transform, int columns)
    : prepared_(divided_by_kernel(std::move(spectrum), columns)) {
  transform.inverse(prepared_, columns, prepared_.grid.points);
}

WaveValue Sampler::at(double x, double y) const {
  Grid const& grid = prepared_.grid;
  if (!(std::fabs(x) <= grid.window / 2 && std::fabs(y) <= grid.window / 2))
    throw NumericalError("a point of a rim lies outside the window of the grid");
  KernelSpan const across(grid, x), up(grid, y);
  WaveValue sum{};
  for (int i = 0; i < kernel_points; ++i) {
    Complex const* row = prepared_.values.data() + std::size_t(up.index[i]) * std::size_t(grid.points);
    Complex value = 0, slope = 0;
    for (int j = 0; j < kernel_points; ++j) {
      Complex const point = row[across.index[j]];
      value += across.value[j] * point;
      slope += across.slope[j] * point;
    }
    sum.value += up.value[i] * value;
    sum.dx += up.value[i] * slope;
    sum.dy += up.slope[i] * value;
  }
  sum.dx /= grid.pitch();
  sum.dy /= grid.pitch();
  return sum;
}

}  // namespace straytrace::wave
