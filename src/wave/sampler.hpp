// SPDX-License-Identifier: BSD-3-Clause
// A field and its gradient between the points of its grid, for rims that pass between them.
#pragma once

#include "wave/field.hpp"
#include "wave/transform.hpp"

namespace straytrace::wave {

struct WaveValue {
  Complex value;   // sqrt(W)/m
  Complex dx, dy;  // derivatives across the axis. sqrt(W)/m^2
};

// The interpolation of a field whose spectrum is zero beyond 0.72 of Nyquist's frequency along each axis, by sums over
// 14 x 14 points with a Kaiser-Bessel kernel whose own transform is divided out: values to 1e-8 of the largest value,
// derivatives to 2e-8 of the largest derivative. A point within 7 pitches of the border of the window also takes the
// field from beyond the opposite border.
class Sampler {
 public:
  // `columns`: as for Transform::inverse. Throws NumericalError if the spectrum is not zero beyond the limit.
  Sampler(Field spectrum, Transform const&, int columns);
  WaveValue at(double x, double y) const;  // m from the axis; throws NumericalError outside the window

 private:
  Field prepared_;
};

}  // namespace straytrace::wave
