// SPDX-License-Identifier: BSD-3-Clause
#include "wave/transform.hpp"

#include <algorithm>
#include <vector>

#include "base/process/threads.hpp"
#include "wave/lines/line_tables.hpp"

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

}  // namespace straytrace::wave
