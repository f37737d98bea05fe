// SPDX-License-Identifier: BSD-3-Clause
// A field and its gradient between the points of its grid, for rims that pass between them.
#pragma once

#include <vector>

#include "base/math/vec3.hpp"
#include "wave/field.hpp"

namespace straytrace::wave {

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
