// SPDX-License-Identifier: BSD-3-Clause
// One-dimensional discrete Fourier transforms of several rows or columns of a field at once.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "wave/field.hpp"

namespace straytrace::wave {

struct ElementRange {
  int first = 0, last = 0;
  bool holds(int i) const { return first <= i && i < last; }
};

// Keeps its tables and its memory between calls; one object per thread. What becomes of a line does not depend on the
// lines beside it.
class LineTransform {
 public:
  static constexpr std::size_t at_once = 16;  // lines of a call at most

  explicit LineTransform(int points);
  ~LineTransform();

  // Element i of line j is lines[j][i * step]. Takes the elements outside `given` as zero; writes the elements inside
  // `wanted`, times `factor`, and leaves the others as they are.
  void forward(std::span<Complex* const> lines, std::ptrdiff_t step, ElementRange given, ElementRange wanted,
               double factor = 1);
  void inverse(std::span<Complex* const> lines, std::ptrdiff_t step, ElementRange given, ElementRange wanted,
               double factor);

  static char const* library();  // "DUCC0" or "Eigen"

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
};

}  // namespace straytrace::wave
