// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/facets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace straytrace {
namespace {

// Tanh-sinh over 0 to 1: layers at the ends, however thin, are met.
struct Rule {
  struct Point {
    double at, left, weight;  // left: 1 - at
  };
  std::vector<Point> points;

  explicit Rule(double step) {
    for (double k = -3.1; k < 3.1; k += step) {
      double const e = std::exp(-pi * std::sinh(k)), at = 1 / (1 + e);
      points.push_back({at, e * at, step * pi * std::cosh(k) * e * at * at});
    }
  }
};

// In the plane of slopes s = (across r cos psi, along r sin psi) of the normals h ~ (s, 1), with t = wi/wi.z:
//   total = int dpsi/pi int r dr/(1 + r^2)^2 (1 + s t) F G,   up to a^2 r^2 - 2 b r = 1, where wo is at the horizon,
// a^2 = across^2 cos^2 psi + along^2 sin^2 psi, b = s t/r.
struct Slopes {
  Facets f;
  double tx, ty, cosine, slant;  // slant: 1 + 2 Lambda of wi

  double value(double sx, double sy, double r) const {
    double const square = sx * sx + sy * sy, toward = 1 + sx * tx + sy * ty, up = 2 * toward - (1 + square);
    if (!(up > 0)) return 0;
    double const ox = f.across * (2 * toward * sx - tx * (1 + square)),
                 oy = f.along * (2 * toward * sy - ty * (1 + square));
    double const x = std::max(0.0, 1 - toward * cosine / std::sqrt(1 + square)), x2 = x * x;
    double const factor = f.reflectance + (f.grazing - f.reflectance) * x2 * x2 * x, spread = 1 + r * r;
    return r / (spread * spread) * toward * factor * 2 * up / (slant * up + std::sqrt(up * up + ox * ox + oy * oy));
  }
  double ray(double psi, Rule const& rule) const {
    double const px = f.across * std::cos(psi), py = f.along * std::sin(psi), b = px * tx + py * ty;
    double const square = px * px + py * py, root = std::sqrt(b * b + square);
    double const last = b > 0 ? (b + root) / square : 1 / (root - b);
    double sum = 0;
    for (Rule::Point const& p : rule.points) {  // even in r/(1 + r)
      double const below = 1 / (1 + last * p.left), r = last * p.at * below;
      sum += p.weight * below * below * value(r * px, r * py, r);
    }
    return last * (1 + last) * sum;
  }
};

}  // namespace

double facets_total(Facets const& f, Vec3 wi, double step) {
  Rule const rule(step);
  double const tx = wi.x / wi.z, ty = wi.y / wi.z, x = f.across * tx, y = f.along * ty;
  Slopes const s{f, tx, ty, wi.z, std::sqrt(1 + x * x + y * y)};
  double const zero = std::atan2(x, -y), first = zero - pi * std::floor(zero / pi);
  std::array<double, 5> edges = {first, pi / 2, first + pi, 3 * pi / 2, 0};  // b = 0, and where a is least
  std::sort(edges.begin(), edges.begin() + 4);
  edges[4] = edges[0] + 2 * pi;
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    double const size = edges[i + 1] - edges[i];
    if (!(size > 1e-12)) continue;
    for (Rule::Point const& p : rule.points) sum += p.weight * size * s.ray(edges[i] + size * p.at, rule);
  }
  double const total = sum / pi, most = std::max(f.reflectance, f.grazing);
  return total > most ? most : total;
}

double uncrowded(double x, double most) {
  double low = 0, high = most;
  if (x <= 0) return 0;
  for (int i = 0; i < 200; ++i) {
    double const middle = 0.5 * (low + high);
    (crowded(middle, most) < x ? low : high) = middle;
  }
  return high;
}

}  // namespace straytrace
