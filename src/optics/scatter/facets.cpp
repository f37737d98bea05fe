// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/facets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "optics/scatter/model_keys.hpp"

namespace straytrace::optics {
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

ModelKeys<Microfacet> Microfacet::keys() {
  using M = Microfacet;
  static constexpr ModelKey<M> numbers[] = {
      {"roughness", &M::alpha, dim::plain, required, 1e-4, 1,
       "α, 1e-4 to 1: half of the area is tilted by more than atan α"},
      {"reflectance", &M::reflectance, dim::plain, required, 0, 1, "R₀ of the facets at normal incidence"},
      {"grazing", &M::grazing, dim::plain, optional, 0, 1,
       "R₉₀ at grazing incidence; default R₀, the same at every angle. 1 for bare metal and glass", &M::reflectance},
  };
  return {numbers};
}

void Microfacet::prepare() {
  for (int k = 0; k < cosines; ++k) {
    double const u = alpha * uncrowded(k / (cosines - 1.0), 1 / alpha);
    double const cosine = std::fmin(1, std::fmax(u, 1e-12));  // replaces the limit at grazing
    Vec3 const wi{std::sqrt((1 - cosine) * (1 + cosine)), 0, cosine};
    totals[k] = facets_total({alpha, alpha, reflectance, grazing}, wi) - factor(cosine);
  }
}

ModelKeys<Grooves> Grooves::keys() {
  using M = Grooves;
  static constexpr ModelKey<M> numbers[] = {
      {"across", &M::across, dim::plain, required, 1e-3, 1,
       "a_x, 1e-3 to 1: half of the flanks are steeper than atan a_x across the grooves"},
      {"along", &M::along, dim::plain, required, 1e-4, 1, "a_y, 1e-4 to 'across': the same along the grooves"},
      {"reflectance", &M::reflectance, dim::plain, required, 0, 1, "R₀ of the flanks at normal incidence"},
      {"grazing", &M::grazing, dim::plain, optional, 0, 1, "R₉₀ at grazing incidence; default R₀", &M::reflectance},
  };
  return {numbers};
}

ModelComplaint Grooves::impossible() const {
  if (along > across)
    return {"along", "'along' is larger than 'across': grooves are steep across and smooth along", "exchange the two"};
  return {};
}

namespace {

Vec3 incoming(double cosine, double cos_azimuth) {
  double const sine = std::sqrt((1 - cosine) * (1 + cosine));
  return {sine * cos_azimuth, sine * std::sqrt((1 - cos_azimuth) * (1 + cos_azimuth)), cosine};
}

}  // namespace

Vec3 Grooves::node(int row, int column) const {
  constexpr double lowest = 1e-12;  // replaces the limit at grazing
  double const ratio = along / across, c = std::fmin(1, ratio * uncrowded(row / (azimuths - 1.0), 1 / ratio));
  double const a = width(c), cosine = a * uncrowded(column / (cosines - 1.0), 1 / a);
  return incoming(std::fmin(1, std::fmax(cosine, lowest)), c);
}

void Grooves::prepare() {
  for (int i = 0; i < azimuths; ++i)
    for (int k = 0; k < cosines; ++k) {
      Vec3 const wi = node(i, k);
      totals[i][k] = facets_total({across, along, reflectance, grazing}, wi) - factor(wi.z);
    }
  constexpr int turns = 64;
  for (int k = 0; k < AlbedoTable::size; ++k) {
    double sum = 0;
    for (int i = 0; i < turns; ++i)
      sum += albedo(incoming(AlbedoTable::cosine(k), sincos_turn(0.25 * (i + 0.5) / turns).cos));
    mean.value[k] = sum / turns;
  }
}

}  // namespace straytrace::optics
