// SPDX-License-Identifier: BSD-3-Clause
// What legs and planes do to each element of a field, for the host and for devices (docs/theory/wave.md, eq. W.1, W.3,
// W.4, W.7).
#pragma once

#include <cstdint>

#include "base/memory/host_device.hpp"
#include "wave/lines/line_kernels.hpp"

namespace straytrace::wave::device {

struct Value {  // as std::complex<double> in memory
  double re, im;
};
STRAY_HD Value times(Value const& a, double re, double im) { return {a.re * re - a.im * im, a.re * im + a.im * re}; }

STRAY_HD int frequency_number(int i, int points) { return i < points / 2 ? i : i - points; }

// The factor of a leg at row frequency n and column frequency m, with the operations of LineKernels::leg_row.
STRAY_HD Value leg_factor(LegTables const& leg, int points, int n, int m) {
  double const x = m * leg.angle_step, y = n * leg.angle_step, angle_squared = x * x + y * y;
  if (angle_squared >= leg.cut_squared) return {0, 0};
  int const column = 2 * (m < 0 ? m + points : m), row = 2 * (n < 0 ? n + points : n);
  Value factor = times({leg.scale * leg.paraxial[column], leg.scale * leg.paraxial[column + 1]}, leg.paraxial[row],
                       leg.paraxial[row + 1]);
  if (leg.quartic > 0) {
    double const phase = leg.quartic * angle_squared * angle_squared;
    factor = times(factor, 1 - phase * phase / 2, -phase);
  }
  if (angle_squared <= leg.keep_squared) return factor;
  double at = (angle_squared - leg.keep_squared) * leg.taper_scale;
  at = at < 0 ? 0 : at > leg.taper_steps ? leg.taper_steps : at;
  int const i = int(at);
  double const limit = leg.taper[i] + (at - i) * (leg.taper[i + 1] - leg.taper[i]);
  return {factor.re * limit, factor.im * limit};
}

// Each of these works on element i of an N x N field; calls may run in any order, also at once.

// A spectrum through a leg that lets `columns` columns about frequency zero through.
struct LegWork {
  Value* spectrum;
  LegTables leg;
  int points, columns;
  STRAY_HD void operator()(std::uint32_t i) const {
    int const n = frequency_number(int(i / std::uint32_t(points)), points),
              m = frequency_number(int(i % std::uint32_t(points)), points);
    if (m < -columns / 2 || m >= columns / 2) {
      spectrum[i] = {0, 0};
      return;
    }
    Value const factor = leg_factor(leg, points, n, m);
    spectrum[i] = times(spectrum[i], factor.re, factor.im);
  }
};

// The columns of a spectrum that a leg would not let through become zero.
struct BandWork {
  Value* spectrum;
  int points, columns;
  STRAY_HD void operator()(std::uint32_t i) const {
    int const m = frequency_number(int(i % std::uint32_t(points)), points);
    if (m < -columns / 2 || m >= columns / 2) spectrum[i] = {0, 0};
  }
};

// A field through a plane, of which nothing passes outside `rows`.
struct PlaneWork {
  Value* field;
  PlaneFactor factor;
  int points;
  RowRange rows;
  STRAY_HD void operator()(std::uint32_t i) const {
    int const row = int(i / std::uint32_t(points));
    if (row < rows.first || row >= rows.last)
      field[i] = {0, 0};
    else if (factor.im)
      field[i] = times(field[i], factor.re[i], factor.im[i]);
    else
      field[i] = {field[i].re * factor.re[i], field[i].im * factor.re[i]};
  }
};

}  // namespace straytrace::wave::device
