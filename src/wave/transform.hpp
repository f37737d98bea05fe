// SPDX-License-Identifier: BSD-3-Clause
// Fields between grids: the two-dimensional discrete Fourier transform, and values between the points of a grid.
#pragma once

#include <memory>
#include <vector>

#include "base/math/vec3.hpp"
#include "wave/field.hpp"

namespace straytrace::wave {

// The two-dimensional discrete Fourier transform of a field, without the parts of it that are known to be zero.

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

// A field and its gradient between the points of its grid, for rims that pass between them.

struct WaveValue {
  Complex value;   // sqrt(W)/m
  Complex dx, dy;  // derivatives across the axis. sqrt(W)/m^2
};

// The interpolation of a field whose spectrum is zero beyond 0.72 of Nyquist's frequency along each axis, as behind
// each leg, by sums over 48 x 48 points with a sinc under a Kaiser window: values to 1e-9 of the largest value,
// derivatives to 1e-8 of the largest derivative. A point within 24 pitches of the border of the window also takes the
// field from beyond the opposite border. The same bits for any number of threads and any processor.
class Sampler {
 public:
  explicit Sampler(Field const& field) : field_(field) {}  // which outlives it
  // m from the axis. NumericalError outside the window.
  WaveValue at(double x, double y) const;
  std::vector<WaveValue> at(std::vector<Vec3> const& places, int threads) const;

 private:
  void check(double x, double y) const;
  WaveValue inside(double x, double y) const;

  Field const& field_;
};

// Throws NumericalError if it is not zero beyond the limit of Sampler.
void check_band(Field const& spectrum);

}  // namespace straytrace::wave
