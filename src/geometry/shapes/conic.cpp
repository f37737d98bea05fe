// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/shapes/conic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/input/table.hpp"
#include "geometry/drawing.hpp"

namespace straytrace::geometry {
namespace {

// Nodes and weights of Gauss-Legendre quadrature of 16 points on (0, 1), positive half; the others are 1 - x.
constexpr double nodes[8] = {0.0950125098376374, 0.2816035507792589, 0.4580167776572274, 0.6178762444026438,
                             0.7554044083550030, 0.8656312023878318, 0.9445750230732326, 0.9894009349916499};
constexpr double weights[8] = {0.1894506104550685, 0.1826034150449236, 0.1691565193950025, 0.1495959888165767,
                               0.1246289712555339, 0.0951585116824928, 0.0622535239386479, 0.0271524594117541};

template <class F>
double integral(F const& f, double from, double to, int panels) {
  double sum = 0;
  double const half = 0.5 * (to - from) / panels;
  for (int i = 0; i < panels; ++i) {
    double const middle = from + (2 * i + 1) * half;
    for (int j = 0; j < 8; ++j) sum += weights[j] * half * (f(middle - half * nodes[j]) + f(middle + half * nodes[j]));
  }
  return sum;
}

// Area over the aperture: rings about its centre, as rho = R sin(x), which is smooth where the surface turns vertical.
double area_of(Conic const& s) {
  int const turns = s.decentre() == 0 ? 1 : 128;
  auto const ring = [&](double x) {
    double const rho = s.outer_radius * std::sin(x);
    double sum = 0;
    for (int i = 0; i < turns; ++i) {
      double const angle = 2 * pi * (i + 0.5) / turns;
      double const px = s.decentre_x + rho * std::cos(angle), py = s.decentre_y + rho * std::sin(angle);
      double const w = px * px + py * py, slope = 2 * s.steepness(w);
      sum += std::sqrt(1 + slope * slope * w);
    }
    return 2 * pi * sum / turns * rho * s.outer_radius * std::cos(x);
  };
  return integral(ring, std::asin(s.inner_radius / s.outer_radius), pi / 2, 8);
}

// Largest |ds/dw|, |d2s/dw2|, |d3s/dw3| up to w, as sums of the largest of each term.
struct Derivatives {
  double first, second, third;
};
Derivatives most_up_to(Conic const& s, double w) {
  double const c = std::fabs(s.curvature), q = 1 + s.conic_constant, e = q > 0 ? s.root_of(w) : 1;
  Derivatives d{c / (2 * e), std::fabs(q) * c * c * c / (4 * e * e * e),
                3 * q * q * c * c * c * c * c / (8 * std::pow(e, 5))};
  double const higher[] = {s.a4, s.a6, s.a8, s.a10};
  for (int n = 2; n <= 5; ++n) {
    double const a = std::fabs(higher[n - 2]);
    d.first += a * n * std::pow(w, n - 1);
    d.second += a * n * (n - 1) * std::pow(w, n - 2);
    if (n > 2) d.third += a * n * (n - 1) * (n - 2) * std::pow(w, n - 3);
  }
  return d;
}

}  // namespace

void Conic::place(Pose const& pose) {
  vertex = pose.origin;
  e1 = pose.e1;
  e2 = pose.e2;
  axis = pose.e3;
  double const off_axis = decentre(), edge = off_axis + outer_radius;
  // Along a line with w' = dw/ds, |w'| <= 2 rho, w'' <= 2; slightly widened, like the cylinder that is searched.
  Derivatives const most = most_up_to(*this, edge * edge * (1 + 1e-9));
  bend = 4 * edge * edge * most.second + 2 * most.first;
  twist = 8 * edge * edge * edge * most.third + 12 * edge * most.second;
  double const from = std::max({0.0, off_axis - outer_radius, inner_radius - off_axis});
  constexpr int steps = 512;
  double const step = (edge - from) / steps;
  lowest = infinity;
  highest = -infinity;
  double slope = 0;
  for (int i = 0; i <= steps; ++i) {
    double const rho = from + i * step, z = sag(rho * rho);
    lowest = std::min(lowest, z);
    highest = std::max(highest, z);
    slope = std::max(slope, std::fabs(2 * rho * steepness(rho * rho)));
  }
  slope += pure() ? 0 : bend * step / 2;
  steepest = std::sqrt(1 + slope * slope);
  double const between = pure() ? 0 : bend * step * step / 8;  // a parabola over its chord; a pure conic is monotone
  lowest -= between;
  highest += between;
  surface = area_of(*this);
}

std::span<Key<Conic> const> Conic::keys() {
  static constexpr Key<Conic> keys[] = {
      {"curvature", &Conic::curvature, dim::per_metre, 0, -1e3, 1e3,
       "c, 1/radius at the vertex; positive when concave towards the axis"},
      {"conic_constant", &Conic::conic_constant, dim::plain, 0, -1e3, 1e3,
       "k: 0 sphere, −1 parabola, between them a prolate ellipse, below −1 a hyperbola, above 0 an oblate ellipse"},
      {"a4", &Conic::a4, {-6}, 0, -1e12, 1e12, "aspheric terms"},
      {"a6", &Conic::a6, {-10}, 0, -1e18, 1e18, "aspheric terms"},
      {"a8", &Conic::a8, {-14}, 0, -1e24, 1e24, "aspheric terms"},
      {"a10", &Conic::a10, {-18}, 0, -1e30, 1e30, "aspheric terms"},
      {"outer_radius", &Conic::outer_radius, dim::length, required, 1e-6, 1e3,
       "clear radius of the aperture, measured across the axis"},
      {"inner_radius", &Conic::inner_radius, dim::length, 0, 0, 1e3, "radius of a hole, concentric with the aperture"},
      {"decentre_x", &Conic::decentre_x, dim::length, 0, -1e3, 1e3, "centre of the aperture, across the axis"},
      {"decentre_y", &Conic::decentre_y, dim::length, 0, -1e3, 1e3, "centre of the aperture, across the axis"},
  };
  return keys;
}

ShapeComplaint Conic::impossible() const {
  if (inner_radius >= outer_radius)
    return {fmt::format("the hole ({:g} m) is not smaller than the surface ({:g} m)", inner_radius, outer_radius),
            "make inner_radius smaller than outer_radius"};
  double const edge = decentre() + outer_radius;
  double const part = (1 + conic_constant) * curvature * curvature * edge * edge;
  if (part > 0.99)
    return {fmt::format("(1 + conic_constant) curvature^2 r^2 is {:g} at the edge, r = {:g} m: the conic ends at 1",
                        part, edge),
            "lower the curvature or the aperture; the limit is 0.99 (a 'sphere', 'cap' or 'zone' goes further)"};
  Derivatives const most = most_up_to(*this, edge * edge);
  if (!pure() && 2 * edge * most.first > 20)
    return {fmt::format("the slope of the asphere may reach {:g}", 2 * edge * most.first),
            "check the units of a4 to a10: 1/m^3, 1/m^5, 1/m^7, 1/m^9; the limit of the slope is 20"};
  return {};
}

SurfaceCurvature Conic::curvature_at(Vec3 p) const {
  Vec3 const o = local(p - vertex), n = normal(p);
  double const w = o.x * o.x + o.y * o.y, rho = std::sqrt(w), root = root_of(w), c = curvature;
  double const slope_w = steepness(w);
  double const bend_w = (1 + conic_constant) * c * c * c / (4 * root * root * root) + 2 * a4 +
                        w * (6 * a6 + w * (12 * a8 + w * 20 * a10));
  double const long_way = std::sqrt(1 + 4 * w * slope_w * slope_w);
  double const around = 2 * slope_w / long_way;
  if (!(rho > 0)) return SurfaceCurvature::uniform(n, around);
  double const across = (2 * slope_w + 4 * w * bend_w) / (long_way * long_way * long_way);
  return SurfaceCurvature::revolved(axis, world({o.x / rho, o.y / rho, 0}), n, around, across);
}

Drawing Conic::drawing() const {
  return Drawing::grid(Drawing::along_curve, Drawing::around, true, [&](double u, double v) {
    double const rho = inner_radius + u * (outer_radius - inner_radius);
    double const x = decentre_x + rho * std::cos(2 * pi * v), y = decentre_y + rho * std::sin(2 * pi * v);
    return vertex + world({x, y, sag(x * x + y * y)});
  });
}

}  // namespace straytrace::geometry
