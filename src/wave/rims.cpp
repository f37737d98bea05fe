// SPDX-License-Identifier: BSD-3-Clause
#include "wave/rims.hpp"

#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/functions.hpp"

namespace straytrace::wave {
namespace {

struct ComplexVector {
  Complex x, y, z;
};

// eq. W.13; exactly free of divergence for paraxial fields.
ComplexVector flux_vector(WaveValue const& f, WaveValue const& b, double k) {
  Complex const factor = 1.0 / Complex{0, 2 * k};
  return {factor * (b.value * f.dx - f.value * b.dx), factor * (b.value * f.dy - f.value * b.dy), f.value * b.value};
}

ComplexVector crossed(Vec3 a, ComplexVector const& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

void add_scaled(Complex (&sum)[3], ComplexVector const& v, Complex factor) {
  sum[0] += factor * v.x;
  sum[1] += factor * v.y;
  sum[2] += factor * v.z;
}

}  // namespace

std::vector<RimPoint> round_rim(double radius, Vec3 centre, int count) {
  std::vector<RimPoint> rim;
  double const step = 2 * pi * radius / count;
  for (int i = 0; i < count; ++i) {
    SinCos const at = sincos_turn(double(i) / count);
    rim.push_back({centre + Vec3{radius * at.cos, radius * at.sin, 0}, {-step * at.sin, step * at.cos, 0}});
  }
  return rim;
}

RimLevers rim_levers(std::vector<RimPoint> const& rim, WaveAt const& from_mirror1, WaveAt const& from_mirror2,
                     double wavelength, Complex overlap, Vec3 const& reference) {
  double const k = 2 * pi / wavelength;
  Complex const scale = 2.0 / overlap;
  RimLevers levers{};
  for (RimPoint const& point : rim) {
    ComplexVector const flux = flux_vector(from_mirror1(point.place), from_mirror2(point.place), k);
    ComplexVector const pull = crossed(point.step, flux);
    add_scaled(levers.displacement, pull, scale);
    add_scaled(levers.rotation, crossed(point.place - reference, pull), scale);
  }
  for (int i = 0; i < 3; ++i)
    if (!std::isfinite(std::norm(levers.displacement[i])) || !std::isfinite(std::norm(levers.rotation[i])))
      throw NumericalError("the levers of an edge are not finite: no mode has settled in the cavity");
  return levers;
}

}  // namespace straytrace::wave
