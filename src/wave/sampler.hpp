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

// The interpolation of a field whose spectrum is zero beyond 0.72 of Nyquist's frequency along each axis, to 1e-8 of
// its largest value, by a Kaiser-Bessel kernel whose own transform is divided out.
class Sampler {
 public:
  Sampler(Field spectrum, Transform const&, int columns);  // columns: as for Transform::inverse
  WaveValue at(double x, double y) const;                  // m from the axis, inside the window

 private:
  Field prepared_;
};

}  // namespace straytrace::wave
