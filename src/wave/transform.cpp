// SPDX-License-Identifier: BSD-3-Clause
#include "wave/transform.hpp"

#include <algorithm>
#include <mutex>
#include <span>
#include <vector>

#include "base/process/threads.hpp"
#include "wave/line_transform.hpp"

namespace straytrace::wave {

// Work is divided into groups of `at_once` rows or columns, whatever the number of threads.
struct Transform::Engine {
  int points;
  unsigned threads;
  std::mutex mutex;
  std::vector<std::unique_ptr<LineTransform>> idle;

  Engine(int count, int wanted) : points(count), threads(unsigned(std::max(0, wanted))) {}

  std::unique_ptr<LineTransform> take() {
    std::lock_guard const lock(mutex);
    if (idle.empty()) return std::make_unique<LineTransform>(points);
    std::unique_ptr<LineTransform> one = std::move(idle.back());
    idle.pop_back();
    return one;
  }
  void give_back(std::unique_ptr<LineTransform> one) {
    std::lock_guard const lock(mutex);
    idle.push_back(std::move(one));
  }

  // Calls work(transform, first, last) for all groups of lines.
  template <class Work>
  void for_groups(Work const& work) {
    int const group = int(LineTransform::at_once);
    in_parallel(std::size_t((points + group - 1) / group), threads, [&](std::size_t i) {
      std::unique_ptr<LineTransform> one = take();
      work(*one, int(i) * group, std::min(points, int(i + 1) * group));
      give_back(std::move(one));
    });
  }

  ElementRange all() const { return {0, points}; }
  ElementRange middle(int rows) const { return {points / 2 - rows / 2, points / 2 + rows / 2}; }
  ElementRange beyond(int columns) const { return {columns / 2, points - columns / 2}; }  // those that are not wanted
  void clear(Complex* row, ElementRange columns) const {
    std::fill(row + columns.first, row + columns.last, Complex());
  }
};

namespace {

// Of the lines `first` to `last`, which start `apart` from each other, those that `chosen` names.
class ChosenLines {
 public:
  template <class Chosen>
  ChosenLines(Field& field, int first, int last, int apart, Chosen const& chosen) {
    for (int i = first; i < last; ++i)
      if (chosen(i)) lines_[count_++] = field.values.data() + std::ptrdiff_t(i) * apart;
  }
  operator std::span<Complex* const>() const { return {lines_, count_}; }
  bool empty() const { return count_ == 0; }

 private:
  Complex* lines_[LineTransform::at_once];
  std::size_t count_ = 0;
};

}  // namespace

Transform::Transform(int points, int threads) : engine_(std::make_unique<Engine>(points, threads)) {}
Transform::~Transform() = default;

char const* Transform::library() { return LineTransform::library(); }

void Transform::forward(Field& field, int rows, int columns) const {
  Engine& engine = *engine_;
  int const n = engine.points;
  ElementRange const kept = engine.middle(rows), dropped = engine.beyond(columns);
  engine.for_groups([&](LineTransform& transform, int first, int last) {
    ChosenLines const lines(field, first, last, n, [&](int row) { return kept.holds(row); });
    if (!lines.empty()) transform.forward(lines, 1, engine.all(), engine.all());
    for (int row = first; row < last; ++row) engine.clear(&field(row, 0), dropped);
  });
  engine.for_groups([&](LineTransform& transform, int first, int last) {
    ChosenLines const lines(field, first, last, 1, [&](int column) { return !dropped.holds(column); });
    if (!lines.empty()) transform.forward(lines, n, kept, engine.all());
  });
}

void Transform::inverse(Field& field, int columns, int rows) const {
  Engine& engine = *engine_;
  int const n = engine.points;
  ElementRange const kept = engine.middle(rows), dropped = engine.beyond(columns);
  engine.for_groups([&](LineTransform& transform, int first, int last) {
    ChosenLines const lines(field, first, last, 1, [&](int column) { return !dropped.holds(column); });
    if (!lines.empty()) transform.inverse(lines, n, engine.all(), kept, 1);
  });
  double const factor = 1 / (double(n) * double(n));
  engine.for_groups([&](LineTransform& transform, int first, int last) {
    ChosenLines const lines(field, first, last, n, [&](int row) { return kept.holds(row); });
    for (int row = first; row < last; ++row) engine.clear(&field(row, 0), kept.holds(row) ? dropped : engine.all());
    if (!lines.empty()) transform.inverse(lines, 1, engine.all(), engine.all(), factor);
  });
}

}  // namespace straytrace::wave
