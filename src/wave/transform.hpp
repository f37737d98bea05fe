// SPDX-License-Identifier: BSD-3-Clause
// The two-dimensional discrete Fourier transform of a field, without the parts of it that are known to be zero.
#pragma once

#include <memory>

#include "wave/field.hpp"

namespace straytrace::wave {

class LineTables;

// Between a field f[row][column] and its spectrum F[n][m] = sum f exp(-2 pi i (n row + m column)/N). `rows`: the even
// number of rows about the middle of the plane (N/2 - rows/2 to N/2 + rows/2 - 1) outside which the field is zero or
// not wanted. `columns`: the even number of columns about frequency zero (m = -columns/2 to columns/2 - 1) outside
// which the spectrum is zero or not wanted; what is not wanted is set to zero. The same bits for any number of threads
// and any processor.
class Transform {
 public:
  explicit Transform(int points, int threads = 1);
  ~Transform();

  void forward(Field&, int rows, int columns) const;  // in place
  void inverse(Field&, int columns, int rows) const;  // in place, with 1/N^2

  LineTables const& tables() const;

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
};

}  // namespace straytrace::wave
