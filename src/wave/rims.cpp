// SPDX-License-Identifier: BSD-3-Clause
#include "wave/rims.hpp"

#include <array>
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

namespace {

double patches(SpeckledRim const& rim, double spot, double distance) {
  return std::pow(pi * rim.radius * spot / (rim.wavelength * distance), 2);
}

// Light from one of the mirrors at the rim: speckle, or the coherent wave from the outline of the mirror.
struct RimLight {
  double power;     // irradiance times distance squared, 1/sr
  double patches;   // part of kappa
  double slope;     // rms of its slopes across the rim by the width of the spot, rad
  double straddle;  // rms of its slopes by the two sides of the outline, rad
};
std::array<RimLight, 2> lights(SpeckledRim const& rim, bool first) {
  double const distance = first ? rim.distance1 : rim.distance2, spot = first ? rim.spot1 : rim.spot2;
  return {{{first ? rim.brdf1 : rim.brdf2, patches(rim, spot, distance), spot / (2 * distance), 0},
           {first ? rim.edge1 : rim.edge2, 0, 0, (first ? rim.outline1 : rim.outline2) / distance}}};
}

// Adds the means of the product of two lights, which are independent of the other products.
void add_pair(SpeckleMeans& means, SpeckledRim const& rim, RimLight const& f, RimLight const& b) {
  double const k = 2 * pi / rim.wavelength, a = rim.radius, l1 = rim.distance1, l2 = rim.distance2;
  double const x = f.patches + b.patches, i0 = scaled_bessel(0, x), i1 = scaled_bessel(1, x);
  double const betas = f.power * b.power, power = betas / std::pow(l1 * l2, 2);  // of the product at the rim, 1/m^4
  // Differences of the slopes of both fields across the rim: of their wavefronts, and of speckle about them.
  double const wavefronts = std::pow(a / l1 - a / l2, 2) + std::pow(f.straddle, 2) + std::pow(b.straddle, 2);
  double const unequal = k * k * (std::pow(f.slope, 2) - std::pow(b.slope, 2));
  double const bend = x > 0 ? 2 * (i0 - i1) - i1 / x : 0;
  double const slopes = k * k * wavefronts * i0 + x * i1 / (a * a) + std::pow(a * unequal, 2) * bend;
  means.field += std::pow(2 * rim.wavelength / (l1 + l2), 2) * betas * i0;
  means.transverse += 8 * pi * pi * a * a * power * i1;
  means.longitudinal += 4 * pi * pi * a * a * power * slopes / (k * k);
}

}  // namespace

double SpeckledRim::kappa() const { return patches(*this, spot1, distance1) + patches(*this, spot2, distance2); }

double outline_wave(SpeckledRim const& rim, double distance, double spot, double outline, double curvature) {
  double const k = 2 * pi / rim.wavelength, fall = 2 * outline / (spot * spot);
  double sides = 0;
  for (double const side : {-1, 1}) {
    double const angle = rim.radius / distance + side * outline * (1 / distance - curvature);
    sides += 1 / (std::pow(k * angle, 2) + fall * fall);
  }
  double const irradiance = 2 / (pi * spot * spot) * std::exp(-2 * std::pow(outline / spot, 2));  // at the outline
  return irradiance * k * outline * distance / (2 * pi * rim.radius) * sides;
}

SpeckleMeans speckle_means(SpeckledRim const& rim) {
  SpeckleMeans means;
  for (RimLight const& f : lights(rim, true))
    for (RimLight const& b : lights(rim, false)) add_pair(means, rim, f, b);
  return means;
}

}  // namespace straytrace::wave
