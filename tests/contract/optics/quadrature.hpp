// SPDX-License-Identifier: BSD-3-Clause
// Quadrature over the hemisphere of what the laws of optics_instances.hpp return.
#pragma once

#include "contract/optics/instances.hpp"

namespace straytrace::testing {

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

// Integral of f(wo) over a cell of angle and azimuth, midpoint rule with n by m points (m = 0: n), even in ln(theta)
// where it can be.
template <class F>
double cell_integral(Vec3 wi, F f, double theta1, double theta2, double turn1, double turn2, int n, int m = 0) {
  if (m == 0) m = n;
  Frame const about = Frame::around(specular(wi));
  double const ratio = theta1 > 0 ? std::log(theta2 / theta1) / n : 0;
  double sum = 0, low = theta1;
  for (int i = 0; i < n; ++i) {
    double const high = theta1 > 0 ? theta1 * std::exp(ratio * (i + 1)) : theta2 * (i + 1) / n;
    double const theta = 0.5 * (low + high), ring = std::cos(low) - std::cos(high);
    double const solid = low < 1e-3 ? (high - low) * std::sin(theta) : ring;
    for (int j = 0; j < m; ++j) sum += solid * f(direction_at(about, {theta, turn1 + (j + 0.5) / m * (turn2 - turn1)}));
    low = high;
  }
  return sum * 2 * pi * (turn2 - turn1) / m;
}

// Whether the law samples by rings in the plane of direction cosines, and whether by rings in angle.
template <class Law>
constexpr bool has_rings = requires(Law law) {
  law.lobe;
};
template <class Law>
constexpr bool offset_rings = requires(Law law, LobeTable<OffsetRings>& rings) {
  rings = law.lobe;
};
template <class Law>
constexpr bool chord_rings = has_rings<Law> && !offset_rings<Law>;

// Angles from the specular direction between which samples are counted; where the pdf has steps at normal incidence.
template <class Law>
std::vector<double> cell_edges(Law const& law) {
  std::vector<double> edges{0};
  if constexpr (std::is_base_of_v<Lambertian, Law>) {
    for (int i = 1; i <= 30; ++i) edges.push_back(pi * i / 30);
  } else if constexpr (!has_rings<Law>) {
    double const first = 0.2 * finest(law);
    for (int i = 0; i <= 36; ++i) edges.push_back(first * std::pow(pi / 2 / first, i / 36.0));
    for (int i = 1; i <= 3; ++i) edges.push_back(pi / 2 + i * pi / 6);
  } else {
    for (int i = law.lobe.edge2[0] > 0 ? 0 : 1; i <= law.lobe.rings; ++i) {
      double const edge = std::sqrt(law.lobe.edge2[i]);
      double const angle = chord_rings<Law> ? 2 * std::asin(std::fmin(1, edge / 2)) : std::asin(edge);
      if (angle < 1.5) edges.push_back(angle);
    }
    for (int i = 1; i <= 4; ++i) edges.push_back(pi / 2 + (i - 1) * pi / 6);
  }
  return edges;
}

// Integral of eval cos over the hemisphere along rays from the specular point in the plane of direction cosines
// (cos dOmega = dA), each up to the horizon, midpoints even in the logarithm of the offset.
template <class Law>
double albedo_by_rays(Law const& law, Vec3 wi, double flat_inside) {
  constexpr int rays = 360, steps = 300;
  double const sine = std::hypot(wi.x, wi.y), toward = std::atan2(-wi.y, -wi.x);
  double sum = 0;
  for (int j = 0; j < rays; ++j) {
    double const phi = 2 * pi * (j + 0.5) / rays, c = std::cos(phi + toward), s = std::sin(phi + toward);
    double const last = -sine * std::cos(phi) + std::sqrt(1 - std::pow(sine * std::sin(phi), 2));
    double const first = std::fmin(flat_inside / 10, 0.01 * last), decades = std::log(last / first);
    auto const value = [&](double rho) {
      double const x = -wi.x + rho * c, y = -wi.y + rho * s;
      return law.eval(wi, {x, y, std::sqrt(std::fmax(1 - x * x - y * y, 1e-300))});
    };
    sum += 0.5 * first * first * value(0.7 * first);
    for (int i = 0; i < steps; ++i) {
      double const q = (i + 0.5) / steps, rho = last * std::exp(-decades * q * q);  // dense at the horizon
      sum += value(rho) * rho * rho * 2 * decades * q / steps;
    }
  }
  return sum * 2 * pi / rays;
}
// The same for lobes that are round in angle: cones about the specular direction, each as far as it is above the
// horizon.
template <class Law>
double albedo_by_cones(Law const& law, Vec3 wi) {
  constexpr int cones = 1000, steps = 64;
  Frame const about = Frame::around(specular(wi));
  double const sine = std::hypot(wi.x, wi.y), top = std::atan2(about.e2.z, about.e1.z);  // azimuth that points up
  double const last = pi / 2 + std::asin(sine), first = finest(law), ratio = std::log(last / first) / cones;
  double sum = 0;
  for (int i = -1; i < cones; ++i) {
    double const theta = i < 0 ? 0.7 * first : first * std::exp((i + 0.5) * ratio);
    double const width = i < 0 ? 0.5 * first * first / theta : theta * ratio;
    double const level = std::cos(theta) * wi.z / (std::sin(theta) * sine + 1e-300);  // cos_s = 0 where cos = -level
    double const half = level >= 1 ? pi : level <= -1 ? 0 : std::acos(-level);
    double ring = 0;
    for (int j = 0; j < steps; ++j) {
      double const azimuth = top + half * (2 * (j + 0.5) / steps - 1);
      Vec3 const wo = direction_at(about, {theta, azimuth / (2 * pi) + 0.5});
      ring += law.eval(wi, wo) * std::fmax(wo.z, 0);
    }
    sum += ring / steps * 2 * half * std::sin(theta) * width;
  }
  return sum;
}
template <class Law>
double albedo_by_quadrature(Law const& law, Vec3 wi) {
  if constexpr (std::is_same_v<Law, Lambertian> || chord_rings<Law>)
    return albedo_by_cones(law, wi);
  else
    return albedo_by_rays(law, wi, finest(law));
}

}  // namespace straytrace::testing
