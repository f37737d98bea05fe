// SPDX-License-Identifier: BSD-3-Clause
// For every type in LawTypes: laws with their parameters, and quadrature over the hemisphere of what they return. A law
// without instances does not compile here.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "base/rng.hpp"
#include "optics/law_types.hpp"

namespace straytrace::testing {

template <class List>
struct TypesOf;
template <class... T>
struct TypesOf<std::tuple<T...>> {
  using type = ::testing::Types<T...>;
};
using AllLaws = TypesOf<LawTypes>::type;

inline Lambertian lambertian(double reflectance) { return {reflectance}; }
inline PowerLaw power_law(double kappa, double exponent, double above) {
  PowerLaw law;
  law.kappa = kappa;
  law.exponent = exponent;
  law.above = above;
  law.prepare();
  return law;
}
inline Abg abg(double a, double b, double g) {
  Abg law;
  law.a = a;
  law.b = b;
  law.g = g;
  law.prepare();
  return law;
}

template <class Law>
std::vector<Law> instances();
template <>
inline std::vector<Lambertian> instances() {
  return {lambertian(0.1), lambertian(0.95)};
}
template <>
inline std::vector<PowerLaw> instances() {
  return {power_law(1e-3, 2, 5e-5), power_law(3e-9, 2.3986, 5e-5), power_law(1e-4, 3.1, 1e-2)};
}
template <>
inline std::vector<Abg> instances() {
  return {abg(0.0025, 0.001, 1.8), abg(1e-6, 1e-8, 2.5), abg(0.1, 0.5, 3)};
}

// Degrees; the last is where the horizon cuts every lobe in half.
constexpr double incidences[] = {0, 30, 60, 85, 89.7};
inline Vec3 incoming(double degrees, double azimuth = 0.1) {
  SinCos const t = sincos_turn(degrees / 360), a = sincos_turn(azimuth);
  return {t.sin * a.cos, t.sin * a.sin, t.cos};
}

// Directions about the specular one: angle from it, and azimuth in turns.
struct Polar {
  double theta, turn;
};
inline Polar about_specular(Vec3 wi, Vec3 wo) {
  Frame const f = Frame::around(specular(wi));
  Vec3 const l = f.to_local(wo);
  return {angle_between(f.e3, wo), 0.5 + std::atan2(l.y, l.x) / (2 * pi)};
}
inline Vec3 direction_at(Frame const& about, Polar p) {
  double const s = std::sin(p.theta), c = std::cos(p.theta), azimuth = 2 * pi * (p.turn - 0.5);
  return s * std::cos(azimuth) * about.e1 + s * std::sin(azimuth) * about.e2 + c * about.e3;
}

// Integral of f(wo) over a cell of angle and azimuth, midpoint rule with n by n points, even in ln(theta) where it can
// be.
template <class F>
double cell_integral(Vec3 wi, F f, double theta1, double theta2, double turn1, double turn2, int n) {
  Frame const about = Frame::around(specular(wi));
  double const ratio = theta1 > 0 ? std::log(theta2 / theta1) / n : 0;
  double sum = 0, low = theta1;
  for (int i = 0; i < n; ++i) {
    double const high = theta1 > 0 ? theta1 * std::exp(ratio * (i + 1)) : theta2 * (i + 1) / n;
    double const theta = 0.5 * (low + high), ring = std::cos(low) - std::cos(high);
    double const solid = low < 1e-3 ? (high - low) * std::sin(theta) : ring;
    for (int j = 0; j < n; ++j) sum += solid * f(direction_at(about, {theta, turn1 + (j + 0.5) / n * (turn2 - turn1)}));
    low = high;
  }
  return sum * 2 * pi * (turn2 - turn1) / n;
}

// Integral of f(wo) over the hemisphere; `finest` is the angle where the lobe begins (nothing of weight inside it).
template <class F>
double hemisphere(Vec3 wi, F f, double finest) {
  constexpr int decades_cells = 12;
  double sum = cell_integral(wi, f, 0, finest, 0, 1, 100), low = finest;
  for (int i = 1; i <= decades_cells; ++i) {
    double const high = finest * std::pow(pi / finest, double(i) / decades_cells);
    sum += cell_integral(wi, f, low, high, 0, 1, 100);
    low = high;
  }
  return sum;
}
inline double finest(Lambertian const&) { return 0.1; }
inline double finest(PowerLaw const& l) { return l.above; }
inline double finest(Abg const& l) { return 1e-2 * std::pow(l.b, 1 / l.g); }

template <class Law>
double albedo_by_quadrature(Law const& law, Vec3 wi) {
  return hemisphere(
      wi, [&](Vec3 wo) { return law.eval(wi, wo) * std::fmax(wo.z, 0); }, finest(law));
}

// The lobe of ABg is round in direction cosines (eval cos dOmega = eval dA), not in angle: rings about the specular
// point.
inline double albedo_by_quadrature(Abg const& law, Vec3 wi) {
  constexpr int rings = 4000, sectors = 90;
  double sum = 0, low = 0;
  for (int i = 0; i <= rings; ++i) {
    double const high = finest(law) * std::pow(2 / finest(law), double(i) / rings), rho = 0.5 * (low + high);
    double share = 0, shift = std::fmod(0.618034 * i, 1);  // so that the cuts at the horizon do not repeat
    for (int j = 0; j < sectors; ++j) {
      double const azimuth = 2 * pi * (j + shift) / sectors;
      double const x = -wi.x + rho * std::cos(azimuth), y = -wi.y + rho * std::sin(azimuth), z2 = 1 - x * x - y * y;
      if (z2 > 0) share += law.eval(wi, {x, y, std::sqrt(z2)}) / sectors;
    }
    sum += pi * (high * high - low * low) * share;
    low = high;
  }
  return sum;
}

}  // namespace straytrace::testing
