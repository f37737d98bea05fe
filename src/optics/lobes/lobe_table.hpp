// SPDX-License-Identifier: BSD-3-Clause
// Sampling of a lobe about the specular direction, shared by the models. The lobe is cut into rings; for 46 incidences
// a row holds how the scattered power falls on them. A ring is drawn by the row, a point in it over the part above the
// horizon: the weight only carries the variation of the model within one ring.
#pragma once

#include "optics/lobes/bsdf.hpp"

namespace straytrace::optics {

// Rings of |alpha - alpha_0| in the plane of direction cosines; area = integral of cos dOmega.
struct OffsetRings {
  STRAY_HD static double of(Vec3 wi, Vec3 wo) {
    double const x = wo.x + wi.x, y = wo.y + wi.y;
    return std::sqrt(x * x + y * y);
  }
  // A point at radius r lies above the horizon where the cosine of its azimuth, from the direction of alpha_0, is below
  // this.
  STRAY_HD static double horizon(double cos_i, double sin_i, double r) {
    double const room = cos_i * cos_i - r * r;  // 1 - sin_i^2 - r^2
    return sin_i * r > 0 ? room / (2 * sin_i * r) : (room > 0 ? 2 : -2);
  }
  STRAY_HD static Vec3 direction(Vec3 wi, double r, SinCos azimuth) {
    double const sin_i = std::sqrt(wi.x * wi.x + wi.y * wi.y), ex = sin_i > 0 ? -wi.x / sin_i : 1,
                 ey = sin_i > 0 ? -wi.y / sin_i : 0;
    double const x = -wi.x + r * (azimuth.cos * ex - azimuth.sin * ey),
                 y = -wi.y + r * (azimuth.cos * ey + azimuth.sin * ex), z2 = 1 - x * x - y * y;
    return {x, y, z2 > 0 ? std::sqrt(z2) : 0};
  }
  STRAY_HD static double per_steradian(Vec3 wo) { return wo.z; }  // area per solid angle
  // Azimuth from the top of an arc of half-width `half`, both in rad, and its density in 1/rad.
  STRAY_HD static double azimuth(Vec3, double, double half, double v) { return (2 * v - 1) * half; }
  STRAY_HD static double azimuth_density(Vec3, double, double half, double) { return 0.5 / half; }
  static double cut(double cos_i, double sin_i) { return cos_i * cos_i / (1 + sin_i); }  // first radius that is cut
  STRAY_HD static double last(double sin_i) { return 1 + sin_i; }  // beyond it nothing is above the horizon
};

// Rings of the chord t = 2 sin(theta/2) about the specular direction; area = solid angle.
struct ChordRings {
  STRAY_HD static double of(Vec3 wi, Vec3 wo) { return length(wo - specular(wi)); }
  STRAY_HD static double horizon(double cos_i, double sin_i, double t) {
    double const across = sin_i * t * std::sqrt(std::fmax(0.0, 1 - t * t / 4)), up = cos_i * (1 - t * t / 2);
    return across > 0 ? up / across : (up > 0 ? 2 : -2);
  }
  STRAY_HD static Vec3 direction(Vec3 wi, double t, SinCos azimuth) {
    double const sin_i = std::sqrt(wi.x * wi.x + wi.y * wi.y), ex = sin_i > 0 ? -wi.x / sin_i : 1,
                 ey = sin_i > 0 ? -wi.y / sin_i : 0;
    double const polar = 1 - t * t / 2, across = t * std::sqrt(std::fmax(0.0, 1 - t * t / 4));
    double const out = across * azimuth.cos * wi.z, side = across * azimuth.sin;
    return {-wi.x * polar + out * ex - side * ey, -wi.y * polar + out * ey + side * ex,
            wi.z * polar - across * azimuth.cos * sin_i};
  }
  STRAY_HD static double per_steradian(Vec3) { return 1; }
  // cos_s = up + side cos(azimuth from the top of the ring).
  struct Tilt {
    double up, side;
    STRAY_HD Tilt(Vec3 wi, double t)
        : up(wi.z * (1 - t * t / 2)),
          side(std::sqrt((wi.x * wi.x + wi.y * wi.y) * std::fmax(0.0, 1 - t * t / 4)) * t) {}
    STRAY_HD bool even() const { return 4 * side <= up; }  // azimuth drawn evenly, otherwise in proportion to cos_s
    STRAY_HD double integral(double azimuth) const { return up * azimuth + side * sincos_turn(azimuth / (2 * pi)).sin; }
  };
  STRAY_HD static double azimuth(Vec3 wi, double t, double half, double v) {
    Tilt const tilt(wi, t);
    if (tilt.even()) return (2 * v - 1) * half;
    double const share = std::fabs(2 * v - 1), wanted = share * tilt.integral(half);
    double x = half * (1 - std::sqrt(1 - share));
    for (int i = 0; i < 6; ++i) {  // Newton; the integral is concave
      SinCos const at = sincos_turn(x / (2 * pi));
      double const slope = tilt.up + tilt.side * at.cos;
      if (!(slope > 0)) break;
      x -= (tilt.up * x + tilt.side * at.sin - wanted) / slope;
    }
    x = x < 0 ? 0 : x > half ? half : x;
    return v < 0.5 ? -x : x;
  }
  STRAY_HD static double azimuth_density(Vec3 wi, double t, double half, double cos_s) {
    Tilt const tilt(wi, t);
    return tilt.even() ? 0.5 / half : 0.5 * cos_s / tilt.integral(half);
  }
  static double cut(double cos_i, double sin_i) { return std::sqrt(2 * cos_i * cos_i / (1 + sin_i)); }  // 90 deg - i
  STRAY_HD static double last(double sin_i) { return std::sqrt(2 * (1 + sin_i)); }                      // 90 deg + i
};

// The same for models whose value times cos_s, not the value itself, is even along a ring.
struct EvenChordRings : ChordRings {
  STRAY_HD static double azimuth(Vec3, double, double half, double v) { return (2 * v - 1) * half; }
  STRAY_HD static double azimuth_density(Vec3, double, double half, double) { return 0.5 / half; }
};

template <class Rings>
struct LobeTable {
  static constexpr int rings = 96, rows = 46;
  double edge[rings + 1] = {};              // radii
  double cumulative[rows][rings + 1] = {};  // share of the power inside each edge
  AlbedoTable albedo;

  // Host: fills everything from a model whose lobe is flat inside `smallest` and zero inside `hole`. To be called again
  // when the model changes.
  template <class Law>
  void prepare(Law const& law, double smallest, double hole = 0, int azimuths = 6);
  // The same without the albedo.
  template <class Law>
  void prepare_rings(Law const& law, double smallest, double hole, int azimuths);

  // Rows: evenly spaced in the sine up to 45 deg, in the cosine beyond; the row at or beyond the incidence is used.
  STRAY_HD static double row_position(double cos_i) {
    double const sin_i = std::sqrt(std::fmax(0.0, (1 - cos_i) * (1 + cos_i)));
    return (sin_i < cos_i ? sin_i : sqrt_two - cos_i) * ((rows - 1) / sqrt_two);
  }
  STRAY_HD static int row_of(double cos_i) {
    double const x = row_position(cos_i);
    int const below = static_cast<int>(x);
    return below >= rows - 1 ? rows - 1 : x - below < 1e-9 ? below : below + 1;
  }
  static double row_cosine(int row) {
    double const x = row * sqrt_two / (rows - 1);
    return x < sqrt_two / 2 ? std::sqrt(1 - x * x) : sqrt_two - x;
  }

  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return 0;
    double const r = Rings::of(wi, wo);
    if (!(r >= edge[0] && r < edge[rings])) return 0;
    return density(cumulative[row_of(wi.z)], ring_of(r, edge), wi, wo, r);
  }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const {
    if (!(wi.z > 0)) return {};
    double const* const row = cumulative[row_of(wi.z)];
    int const i = ring_of(u, row);
    double const share = (u - row[i]) / (row[i + 1] - row[i]), area = ring_area(wi, i);
    if (!(area > 0)) return {};
    double const r = std::sqrt(edge[i] * edge[i] + share * area);
    double const half = half_arc(wi, r);
    if (!(half > 0)) return {};
    Vec3 const wo = Rings::direction(wi, r, sincos_turn(0.5 + Rings::azimuth(wi, r, half, v) / (2 * pi)));
    if (!(wo.z > 0)) return {};
    return {wo, density(row, i, wi, wo, r)};
  }

  // Area over pi of the ring as far as it reaches above the horizon anywhere.
  STRAY_HD double ring_area(Vec3 wi, int i) const {
    double const last = Rings::last(std::sqrt(wi.x * wi.x + wi.y * wi.y)),
                 high = edge[i + 1] < last ? edge[i + 1] : last;
    return high * high - edge[i] * edge[i];
  }
  // Half of the arc at radius r that lies above the horizon, in rad.
  STRAY_HD static double half_arc(Vec3 wi, double r) {
    double const c = Rings::horizon(wi.z, std::sqrt(wi.x * wi.x + wi.y * wi.y), r);
    return c >= 1 ? pi : c <= -1 ? 0 : 2 * atan_positive(std::sqrt((1 + c) / (1 - c)));
  }
  STRAY_HD double density(double const* row, int i, Vec3 wi, Vec3 wo, double r) const {  // 1/sr
    double const half = half_arc(wi, r);
    if (!(half > 0)) return 0;
    return 2 * (row[i + 1] - row[i]) / ring_area(wi, i) * Rings::azimuth_density(wi, r, half, wo.z) *
           Rings::per_steradian(wo);
  }
  STRAY_HD static int ring_of(double x, double const* edges) {
    int low = 0, high = rings;
    while (high - low > 1) {
      int const mid = (low + high) / 2;
      (edges[mid] <= x ? low : high) = mid;
    }
    return low;
  }

  // Power that the model scatters into each ring, for light incident at cos_i.
  template <class Law>
  void ring_powers(Law const& law, double cos_i, int azimuths, double* power) const;

  static constexpr double sqrt_two = 1.4142135623730951;
};

// Sampling and total of a model that holds a lobe table as its member `lobe`.
template <class Model>
struct SampledByLobe {
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const { return model().lobe.pdf(wi, wo); }
  STRAY_HD double albedo(double cos_i) const { return model().lobe.albedo.at(cos_i); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const { return model().lobe.sample(wi, u, v); }

 private:
  STRAY_HD Model const& model() const { return static_cast<Model const&>(*this); }
};

}  // namespace straytrace::optics
