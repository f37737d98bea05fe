// SPDX-License-Identifier: BSD-3-Clause
#include "wave/transform.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/process/threads.hpp"
#include "wave/lines/line_kernels.hpp"

namespace straytrace::wave {
namespace {

struct ElementRange {
  int first = 0, last = 0;
  bool holds(int i) const { return first <= i && i < last; }
};

// Of the lines `first` to `last`, which start `apart` from each other, those that `chosen` names.
template <class Chosen>
Lines chosen_lines(Field& field, int first, int last, int apart, Chosen const& chosen) {
  Lines lines;
  for (int i = first; i < last; ++i)
    if (chosen(i))
      lines.line[lines.count++] = reinterpret_cast<double*>(field.values.data() + std::ptrdiff_t(i) * apart);
  return lines;
}

void set(Lines& lines, int step, ElementRange given, ElementRange wanted, double factor = 1) {
  lines.step = step;
  lines.given_first = given.first;
  lines.given_last = given.last;
  lines.wanted_first = wanted.first;
  lines.wanted_last = wanted.last;
  lines.factor = factor;
}

}  // namespace

struct Transform::Engine {
  LineTables tables;
  int points;
  unsigned threads;

  Engine(int count, int wanted) : tables(count), points(count), threads(unsigned(std::max(0, wanted))) {}

  // Calls work(memory, first, last) for all groups of lines.
  template <class Work>
  void for_groups(Work const& work) const {
    in_parallel(std::size_t((points + block_lines - 1) / block_lines), threads, [&](std::size_t i) {
      tables.with_work(
          [&](double* memory) { work(memory, int(i) * block_lines, std::min(points, int(i + 1) * block_lines)); });
    });
  }

  ElementRange all() const { return {0, points}; }
  ElementRange middle(int rows) const { return {points / 2 - rows / 2, points / 2 + rows / 2}; }
  ElementRange beyond(int columns) const { return {columns / 2, points - columns / 2}; }  // those that are not wanted
  void clear(Complex* row, ElementRange columns) const {
    std::fill(row + columns.first, row + columns.last, Complex());
  }
};

Transform::Transform(int points, int threads) : engine_(std::make_unique<Engine>(points, threads)) {}
Transform::~Transform() = default;
LineTables const& Transform::tables() const { return engine_->tables; }

void Transform::forward(Field& field, int rows, int columns) const {
  Engine const& engine = *engine_;
  int const n = engine.points;
  ElementRange const kept = engine.middle(rows), dropped = engine.beyond(columns);
  engine.for_groups([&](double* memory, int first, int last) {
    Lines lines = chosen_lines(field, first, last, n, [&](int row) { return kept.holds(row); });
    set(lines, 1, engine.all(), engine.all());
    line_kernels->forward(engine.tables.plan(), memory, lines);
    for (int row = first; row < last; ++row) engine.clear(&field(row, 0), dropped);
  });
  engine.for_groups([&](double* memory, int first, int last) {
    Lines lines = chosen_lines(field, first, last, 1, [&](int column) { return !dropped.holds(column); });
    set(lines, n, kept, engine.all());
    line_kernels->forward(engine.tables.plan(), memory, lines);
  });
}

void Transform::inverse(Field& field, int columns, int rows) const {
  Engine const& engine = *engine_;
  int const n = engine.points;
  ElementRange const kept = engine.middle(rows), dropped = engine.beyond(columns);
  engine.for_groups([&](double* memory, int first, int last) {
    Lines lines = chosen_lines(field, first, last, 1, [&](int column) { return !dropped.holds(column); });
    set(lines, n, engine.all(), kept);
    line_kernels->inverse(engine.tables.plan(), memory, lines);
  });
  double const factor = 1 / (double(n) * double(n));
  engine.for_groups([&](double* memory, int first, int last) {
    Lines lines = chosen_lines(field, first, last, n, [&](int row) { return kept.holds(row); });
    for (int row = first; row < last; ++row) engine.clear(&field(row, 0), kept.holds(row) ? dropped : engine.all());
    set(lines, 1, engine.all(), engine.all(), factor);
    line_kernels->inverse(engine.tables.plan(), memory, lines);
  });
}

namespace {

constexpr int sampled_points = SampleWeights::points, sample_terms = SampleWeights::terms;
constexpr double half_window = sampled_points / 2;  // pitches
constexpr double interpolated_band = 0.72 / 2;      // cycles per pitch
// The spectrum of the window fills the gap between the band and its alias, from 0.36 to 0.64 cycles per pitch.
constexpr double window_shape = 2 * pi * half_window * (0.5 - interpolated_band);

// Weight of a point t pitches away.
double windowed_sinc(double t) {
  double const x = t / half_window;
  double const window = std::cyl_bessel_i(0.0, window_shape * std::sqrt(std::fmax(0.0, 1 - x * x))) /
                        std::cyl_bessel_i(0.0, window_shape);
  return t == 0 ? 1 : window * sincos_turn(t / 2).sin / (pi * t);
}

// Interpolation at Chebyshev's points: its series in Chebyshev polynomials, as powers.
void fit_weight(SampleWeights& weights, int point) {
  std::array<double, sample_terms> polynomial{1}, before{};
  for (int order = 0; order < sample_terms; ++order) {
    double sum = 0;
    for (int j = 0; j < sample_terms; ++j) {
      double const turn = (j + 0.5) / (2 * sample_terms), past_lower = 0.5 * (sincos_turn(turn).cos + 1);
      sum += windowed_sinc(past_lower + half_window - 1 - point) * sincos_turn(order * turn).cos;
    }
    for (int n = 0; n < sample_terms; ++n)
      weights.coefficients[n][point] += polynomial[n] * sum * (order == 0 ? 1.0 : 2.0) / sample_terms;
    std::array<double, sample_terms> next{};
    for (int n = 0; n < sample_terms; ++n)
      next[n] = (n > 0 ? (order == 0 ? 1 : 2) * polynomial[n - 1] : 0) - (order == 0 ? 0 : before[n]);
    before = std::exchange(polynomial, next);
  }
}

SampleWeights const& sample_weights() {
  static SampleWeights const weights = [] {
    SampleWeights made;
    for (int point = 0; point < sampled_points; ++point) fit_weight(made, point);
    return made;
  }();
  return weights;
}

// Between two points of an axis.
struct AxisPlace {
  int first;  // of the points that it takes part of, may lie beyond the border
  double v;   // -1 to 1

  AxisPlace(Grid const& grid, double place) {
    double const at = place / grid.pitch() + grid.points / 2, lower = std::floor(at);
    first = int(lower) - sampled_points / 2 + 1;
    v = 2 * (at - lower) - 1;
  }
};

int wrapped_index(int i, int size) { return (i % size + size) % size; }

}  // namespace

void Sampler::check(double x, double y) const {
  double const half = field_.grid.window / 2;
  if (!(std::fabs(x) <= half && std::fabs(y) <= half))
    throw NumericalError("a point of an edge lies outside the window of the grid");
}

WaveValue Sampler::inside(double x, double y) const {
  Grid const& grid = field_.grid;
  int const n = grid.points;
  AxisPlace const along(grid, x), across(grid, y);
  std::array<double const*, sampled_points> rows;
  std::vector<Complex> copied;  // where they cross the border
  bool const whole = along.first >= 0 && along.first + sampled_points <= n;
  if (!whole) copied.resize(std::size_t(sampled_points) * sampled_points);
  for (int i = 0; i < sampled_points; ++i) {
    Complex const* const row = field_.values.data() + std::size_t(wrapped_index(across.first + i, n)) * std::size_t(n);
    Complex const* from = whole ? row + along.first : nullptr;
    if (!whole) {
      Complex* const copy = copied.data() + std::ptrdiff_t(i) * sampled_points;
      for (int j = 0; j < sampled_points; ++j) copy[j] = row[wrapped_index(along.first + j, n)];
      from = copy;
    }
    rows[std::size_t(i)] = reinterpret_cast<double const*>(from);
  }
  double sums[6];
  line_kernels->sample(sample_weights(), along.v, across.v, rows.data(), sums);
  double const per_metre = 2 / grid.pitch();
  return {{sums[0], sums[1]}, {per_metre * sums[2], per_metre * sums[3]}, {per_metre * sums[4], per_metre * sums[5]}};
}

WaveValue Sampler::at(double x, double y) const {
  check(x, y);
  return inside(x, y);
}

std::vector<WaveValue> Sampler::at(std::vector<Vec3> const& places, int threads) const {
  for (Vec3 const& p : places) check(p.x, p.y);
  std::vector<WaveValue> values(places.size());
  for_rows(0, int(places.size()), threads,
           [&](int i) { values[std::size_t(i)] = inside(places[std::size_t(i)].x, places[std::size_t(i)].y); });
  return values;
}

void check_band(Field const& spectrum) {
  Grid const& grid = spectrum.grid;
  auto const in_band = [&](int i) { return std::fabs(grid.frequency(i)) * grid.pitch() <= interpolated_band; };
  double inside = 0, beyond = 0;
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column)
      (in_band(row) && in_band(column) ? inside : beyond) += std::norm(spectrum(row, column));
  if (beyond > 1e-18 * inside)
    throw NumericalError(
        "the grid is too coarse for its field: it holds light beyond 0.72 of the largest angle of the grid, where it "
        "cannot be interpolated");
}

}  // namespace straytrace::wave
