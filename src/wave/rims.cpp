// SPDX-License-Identifier: BSD-3-Clause
#include "wave/rims.hpp"

#include <cmath>

#include "base/errors.hpp"
#include "base/math/bessel.hpp"
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
      throw NumericalError("the levers of a rim are not finite: no mode has settled in the cavity");
  return levers;
}

double SpeckledRim::kappa() const {
  return std::pow(pi * radius / wavelength, 2) * (std::pow(spot1 / distance1, 2) + std::pow(spot2 / distance2, 2));
}

SpeckleMeans speckle_means(SpeckledRim const& rim) {
  double const k = 2 * pi / rim.wavelength, a = rim.radius, l1 = rim.distance1, l2 = rim.distance2;
  double const x = rim.kappa(), i0 = scaled_bessel(0, x), i1 = scaled_bessel(1, x);
  double const power = rim.brdf1 * rim.brdf2 / std::pow(l1 * l2, 2);  // of the product of both fields at the rim, 1/m^4
  // Differences of the slopes of both fields across the rim: of their wavefronts, and of speckle about them.
  double const wavefronts = k * a * (1 / l1 - 1 / l2);
  double const unequal = std::pow(k * rim.spot1 / (2 * l1), 2) - std::pow(k * rim.spot2 / (2 * l2), 2);
  double const bend = x > 0 ? 2 * (i0 - i1) - i1 / x : 0;
  double const slopes = std::pow(wavefronts, 2) * i0 + x * i1 / (a * a) + std::pow(a * unequal, 2) * bend;
  return {std::pow(2 * rim.wavelength / (l1 + l2), 2) * rim.brdf1 * rim.brdf2 * i0, 8 * pi * pi * a * a * power * i1,
          4 * pi * pi * a * a * power * slopes / (k * k)};
}

}  // namespace straytrace::wave
