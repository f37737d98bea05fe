// SPDX-License-Identifier: BSD-3-Clause
// Sampling of a lobe about the specular direction, shared by the models. The lobe is cut into rings; for 46 incidences
// a row holds how the scattered power falls on them. A ring is drawn by the row, a point in it over the part above the
// horizon: the weight only carries the variation of the model within one ring.
//
// Value, density and sample of a pair of directions share one number, the square of the radius of its ring.
#pragma once

#include <cstdint>

#include "optics/lobes/bsdf.hpp"

namespace straytrace {
struct GaussPoints;
}
namespace straytrace::optics {

// The part of a ring that lies above the horizon: the cosine of the direction scattered there is
// up + across cos(azimuth from the top of the ring), here up to a common factor.
struct Arc {
  double up, across2;
  double half = 0;  // of the arc, rad
  double side = 0;  // across sin(half); 0 unless the horizon cuts the ring

  STRAY_HD Arc(double up_, double across2_) : up(up_), across2(across2_) {
    double const up2 = up * up;
    if (!(up2 < across2)) {
      half = up > 0 ? pi : 0;
      return;
    }
    side = std::sqrt(across2 - up2);
    half = up < 0 ? atan_ratio(side, -up) : pi - atan_ratio(side, up);
  }
};

// Density of the azimuth as a quotient, 1/rad.
struct ArcDensity {
  double above, below;
};

// Rings of |alpha - alpha_0| in the plane of direction cosines; area = integral of cos dOmega.
struct OffsetRings {
  STRAY_HD static double square(Vec3 wi, Vec3 wo) {
    double const x = wo.x + wi.x, y = wo.y + wi.y;
    return x * x + y * y;
  }
  STRAY_HD static Arc arc(Vec3 wi, double r2) {
    double const sin2_i = wi.x * wi.x + wi.y * wi.y;
    return {wi.z * wi.z - r2, 4 * sin2_i * r2};  // 1 - sin_i^2 - r^2 + 2 sin_i r cos
  }
  STRAY_HD static Vec3 direction(Vec3 wi, double r, SinCos azimuth) {
    double const sin_i = std::sqrt(wi.x * wi.x + wi.y * wi.y), ex = sin_i > 0 ? -wi.x / sin_i : 1,
                 ey = sin_i > 0 ? -wi.y / sin_i : 0;
    double const x = -wi.x + r * (azimuth.cos * ex - azimuth.sin * ey),
                 y = -wi.y + r * (azimuth.cos * ey + azimuth.sin * ex), z2 = 1 - x * x - y * y;
    return {x, y, z2 > 0 ? std::sqrt(z2) : 0};
  }
  STRAY_HD static double per_steradian(Vec3 wo) { return wo.z; }  // area per solid angle
  static double mean_cosine(Arc const&) { return 1; }             // per area, along a ring above the horizon
  // Azimuth from the top of the arc, rad, and its density.
  STRAY_HD static double azimuth(Arc const& arc, double v) { return (2 * v - 1) * arc.half; }
  STRAY_HD static ArcDensity azimuth_density(Arc const& arc, double) { return {1, 2 * arc.half}; }
  static double cut(double cos_i, double sin_i) { return cos_i * cos_i / (1 + sin_i); }  // first radius that is cut
  STRAY_HD static double last2(double sin_i) { return (1 + sin_i) * (1 + sin_i); }       // beyond it nothing is above
  static constexpr double least_last2 = 1;
};

// Rings of the chord t = 2 sin(theta/2) about the specular direction; area = solid angle.
struct ChordRings {
  STRAY_HD static double square(Vec3 wi, Vec3 wo) { return length2(wo - specular(wi)); }
  STRAY_HD static Arc arc(Vec3 wi, double t2) {
    double const sin2_i = wi.x * wi.x + wi.y * wi.y, room = 1 - t2 / 4;
    return {wi.z * (1 - t2 / 2), sin2_i * t2 * (room > 0 ? room : 0)};
  }
  STRAY_HD static Vec3 direction(Vec3 wi, double t, SinCos azimuth) {
    double const sin_i = std::sqrt(wi.x * wi.x + wi.y * wi.y), ex = sin_i > 0 ? -wi.x / sin_i : 1,
                 ey = sin_i > 0 ? -wi.y / sin_i : 0;
    double const polar = 1 - t * t / 2, room = 1 - t * t / 4, across = t * std::sqrt(room > 0 ? room : 0);
    double const out = across * azimuth.cos * wi.z, side = across * azimuth.sin;
    return {-wi.x * polar + out * ex - side * ey, -wi.y * polar + out * ey + side * ex,
            wi.z * polar - across * azimuth.cos * sin_i};
  }
  STRAY_HD static double per_steradian(Vec3) { return 1; }
  static double mean_cosine(Arc const& arc) { return arc.up; }
  // The azimuth is drawn evenly, or in proportion to cos_s where that varies.
  STRAY_HD static bool even(Arc const& arc) { return arc.up > 0 && 16 * arc.across2 <= arc.up * arc.up; }
  STRAY_HD static double azimuth(Arc const& arc, double v) {
    if (even(arc)) return (2 * v - 1) * arc.half;
    double const across = std::sqrt(arc.across2), share = std::fabs(2 * v - 1),
                 wanted = share * (arc.up * arc.half + arc.side);
    double x = arc.half * (1 - std::sqrt(1 - share));
    for (int i = 0; i < 6; ++i) {  // Newton; the integral is concave
      SinCos const at = sincos_turn(x / (2 * pi));
      double const slope = arc.up + across * at.cos;
      if (!(slope > 0)) break;
      x -= (arc.up * x + across * at.sin - wanted) / slope;
    }
    x = x < 0 ? 0 : x > arc.half ? arc.half : x;
    return v < 0.5 ? -x : x;
  }
  STRAY_HD static ArcDensity azimuth_density(Arc const& arc, double cos_s) {
    if (even(arc)) return {1, 2 * arc.half};
    return {cos_s, 2 * (arc.up * arc.half + arc.side)};
  }
  static double cut(double cos_i, double sin_i) { return std::sqrt(2 * cos_i * cos_i / (1 + sin_i)); }  // 90 deg - i
  STRAY_HD static double last2(double sin_i) { return 2 * (1 + sin_i); }                                // 90 deg + i
  static constexpr double least_last2 = 2;
};

// The same for models whose value times cos_s, not the value itself, is even along a ring.
struct EvenChordRings : ChordRings {
  static double mean_cosine(Arc const&) = delete;  // their values are not even
  STRAY_HD static double azimuth(Arc const& arc, double v) { return (2 * v - 1) * arc.half; }
  STRAY_HD static ArcDensity azimuth_density(Arc const& arc, double) { return {1, 2 * arc.half}; }
};

template <class Rings>
struct LobeTable {
  static constexpr int most_rings = 128, rows = 46;
  double edge2[most_rings + 1] = {};             // squares of the radii
  double cumulative[rows][most_rings + 1] = {};  // share of the power inside each edge
  // The squares of the edges, but for the innermost, are 2^e (1 + m/2^steps): their leading bits count the rings.
  std::int64_t rings = 1, dropped = 52, before = 0;  // number; bits dropped from a square; what they leave for ring 0
  AlbedoTable albedo;

  // Host: fills everything from a model whose lobe is flat inside `smallest` and zero inside `hole`. To be called again
  // when the model changes.
  template <class Law>
  void prepare(Law const& law, double smallest, double hole = 0, int azimuths = 6);
  // The same without the albedo.
  template <class Law>
  void prepare_rings(Law const& law, double smallest, double hole, GaussPoints const& turns);

  // Rows: evenly spaced in the sine up to 45 deg, in the cosine beyond; the row at or beyond the incidence is used.
  STRAY_HD static double row_position(double cos_i) {
    double const sin2_i = (1 - cos_i) * (1 + cos_i), sin_i = std::sqrt(sin2_i > 0 ? sin2_i : 0);
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
    return pdf_at(wi, wo, Rings::square(wi, wo));
  }
  STRAY_HD double pdf_at(Vec3 wi, Vec3 wo, double r2) const {  // wi.z > 0, wo.z > 0, r2 of this pair
    if (!(r2 >= edge2[0] && r2 < edge2[rings])) return 0;
    return density(cumulative[row_of(wi.z)], ring_of(r2), wi, wo, Rings::arc(wi, r2));
  }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const {
    if (!(wi.z > 0)) return {};
    double const* const row = cumulative[row_of(wi.z)];
    int const i = drawn_ring(u, row);
    double const share = (u - row[i]) / (row[i + 1] - row[i]), area = ring_area(wi, i);
    if (!(area > 0)) return {};
    double const r2 = edge2[i] + share * area;
    Arc const arc = Rings::arc(wi, r2);
    if (!(arc.half > 0)) return {};
    Vec3 const wo = Rings::direction(wi, std::sqrt(r2), sincos_turn(0.5 + Rings::azimuth(arc, v) * (1 / (2 * pi))));
    if (!(wo.z > 0)) return {};
    return {wo, density(row, i, wi, wo, arc)};
  }

  // Area over pi of the ring as far as it reaches above the horizon anywhere.
  STRAY_HD double ring_area(Vec3 wi, int i) const {
    double high = edge2[i + 1];
    if (high > Rings::least_last2) {
      double const last = Rings::last2(std::sqrt(wi.x * wi.x + wi.y * wi.y));
      high = high < last ? high : last;
    }
    return high - edge2[i];
  }
  STRAY_HD double density(double const* row, int i, Vec3 wi, Vec3 wo, Arc const& arc) const {  // 1/sr
    double const area = ring_area(wi, i);  // 0: at the horizon, which rounding has put into the ring beyond it
    if (!(arc.half > 0 && area > 0)) return 0;
    ArcDensity const azimuth = Rings::azimuth_density(arc, wo.z);
    return 2 * (row[i + 1] - row[i]) * azimuth.above * Rings::per_steradian(wo) / (area * azimuth.below);
  }
  STRAY_HD int ring_of(double r2) const {
    std::int64_t const i = static_cast<std::int64_t>(bits_of(r2) >> dropped) - before;
    return i < 0 ? 0 : i < rings ? int(i) : int(rings - 1);
  }
  // The ring whose interval of a row holds u.
  STRAY_HD int drawn_ring(double u, double const* row) const {
    int low = 0;
    for (int step = most_rings / 2; step > 0; step /= 2)
      if (low + step < rings && row[low + step] <= u) low += step;
    return low;
  }

  void cut_into_rings(double first2, int inner);  // `inner`: rings inside the one that holds first2
  // Power that the model scatters into each ring, for light incident at cos_i.
  template <class Law>
  void ring_powers(Law const& law, double cos_i, GaussPoints const& turns, double* power) const;

  static constexpr double sqrt_two = 1.4142135623730951;
};

// Sampling and total of a model that holds a lobe table as its member `lobe`. Its value is value_at(wi, wo, r2), both
// directions above the surface and r2 as Rings::square() gives it.
template <class Model, class Rings>
struct SampledByLobe {
  STRAY_HD double eval(Vec3 wi, Vec3 wo) const {
    return wi.z > 0 && wo.z > 0 ? model().value_at(wi, wo, Rings::square(wi, wo)) : 0;
  }
  STRAY_HD double pdf(Vec3 wi, Vec3 wo) const { return model().lobe.pdf(wi, wo); }
  STRAY_HD ValueAndPdf both(Vec3 wi, Vec3 wo) const {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    double const r2 = Rings::square(wi, wo);
    return {model().value_at(wi, wo, r2), model().lobe.pdf_at(wi, wo, r2)};
  }
  STRAY_HD double albedo(double cos_i) const { return model().lobe.albedo.at(cos_i); }
  STRAY_HD BsdfSample sample(Vec3 wi, double u, double v) const { return model().lobe.sample(wi, u, v); }

 private:
  STRAY_HD Model const& model() const { return static_cast<Model const&>(*this); }
};

}  // namespace straytrace::optics
