// SPDX-License-Identifier: BSD-3-Clause
// How much of a beam passes beside the surface that its chief ray meets (physics.md eq. 5.5, 5.6).
#include <algorithm>
#include <cmath>

#include "beams/clipping.hpp"
#include "beams/symmetric.hpp"
#include "world/beam_tree.hpp"

namespace straytrace {
namespace {

constexpr double reach = 4.5;             // radii: beyond lies exp(-2 reach^2) = 3e-18 of the power
constexpr double flat_rim_cosine = 0.02;  // cosine of incidence below which a rim is not taken as flat
constexpr int azimuths = 64, rings = 32, halvings = 40;

// Largest 1/e^2 radius, m.
double widest(Mode const& m) {
  auto const size = eigenvalues(m.q11.imag(), m.q12.imag(), m.q22.imag());
  return std::sqrt(m.wavelength / (pi * std::min(size[0], size[1])));
}

// Round rims: the circle about a point of the axis.
struct Rim {
  Vec3 centre, axis;
  double inner = 0, outer = 0;  // m
};
double beside_round(Rim const& rim, Mode const& mode) {
  double const cosine = std::fabs(dot(mode.travel, rim.axis)), far = reach * widest(mode) / cosine;
  Vec3 const o = mode.origin + (dot(rim.centre - mode.origin, rim.axis) / dot(mode.travel, rim.axis)) * mode.travel;
  double const off = length(o - rim.centre);
  double share = off + far < rim.outer ? 0 : clipped_share(Aperture{rim.centre, rim.axis, rim.outer}, mode);
  if (rim.inner > 0 && off - far < rim.inner)
    share += std::max(0.0, 1 - clipped_share(Aperture{rim.centre, rim.axis, rim.inner}, mode));
  return std::min(share, 1.0);
}

// Any shape: which lines parallel to the chief ray miss it, in polar coordinates in which the beam is round.
class Scan {
 public:
  Scan(WorldView const& world, SurfaceId surface, Mode const& mode) : world_(world), surface_(surface), mode_(mode) {
    double const k = pi / mode.wavelength, a = k * mode.q11.imag(), b = k * mode.q12.imag(), c = k * mode.q22.imag();
    double const root = std::sqrt(a), rest = std::sqrt(c - b * b / a);  // rho^2 = (root x + b/root y)^2 + (rest y)^2
    across_ = (1 / root) * mode.e1;
    up_ = (1 / rest) * (mode.e2 - (b / a) * mode.e1);
    Box const box = world.shapes.visit(world.surfaces[surface.value].shape, [](auto const& s) { return s.bounds(); });
    back_ = length(box.upper - box.lower) + length(mode.origin - box.lower);
  }
  double beside() const {
    if (all_meet()) return 0;
    double sum = 0;
    for (int i = 0; i < azimuths; ++i) sum += along((i + 0.5) / azimuths);
    return sum / azimuths;
  }

 private:
  bool meets(Vec3 direction, double rho) const {
    Ray const line{mode_.origin + rho * direction - back_ * mode_.travel, mode_.travel};
    return world_.cross(surface_.value, line, {}).distance < infinity;
  }
  Vec3 towards(double turn) const {
    SinCos const a = sincos_turn(turn);
    return a.cos * across_ + a.sin * up_;
  }
  bool all_meet() const {
    for (int i = 0; i < 16; ++i)
      for (double rho : {reach, 0.5 * reach})
        if (!meets(towards(i / 16.0), rho)) return false;
    return true;
  }
  static double beyond(double rho) { return std::exp(-2 * rho * rho); }
  double along(double turn) const {
    Vec3 const direction = towards(turn);
    double missed = 0, last = 0;
    bool before = true;  // the chief ray meets it
    for (int i = 1; i <= rings; ++i) {
      double const rho = reach * i / rings;
      bool const now = meets(direction, rho);
      if (now != before) {
        double low = last, high = rho;
        for (int h = 0; h < halvings; ++h) {
          double const middle = 0.5 * (low + high);
          (meets(direction, middle) == before ? low : high) = middle;
        }
        missed += (before ? 1 : -1) * beyond(high);
        before = now;
      }
      last = rho;
    }
    return missed;
  }

  WorldView const& world_;
  SurfaceId surface_;
  Mode const& mode_;
  Vec3 across_, up_;
  double back_ = 0;
};

template <class Shape>
bool round_rim(Shape const&, Rim&) {
  return false;
}
bool round_rim(Disk const& s, Rim& rim) {
  rim = {s.centre, s.axis, s.inner_radius, s.outer_radius};
  return true;
}
bool round_rim(Cap const& s, Rim& rim) {
  rim = {s.vertex + (s.curvature * s.depth(s.outer_radius)) * s.axis, s.axis, s.inner_radius, s.outer_radius};
  return true;
}
bool round_rim(Conic const& s, Rim& rim) {
  double const r = s.outer_radius + s.decentre();
  rim = {s.vertex + s.decentre_x * s.e1 + s.decentre_y * s.e2 + s.sag(r * r) * s.axis, s.axis, s.inner_radius,
         s.outer_radius};
  return true;
}

}  // namespace

double beside_rim(WorldView const& world, SurfaceId surface, Mode const& mode) {
  Rim rim;
  bool const flat =
      world.shapes.visit(world.surfaces[surface.value].shape, [&](auto const& s) { return round_rim(s, rim); });
  if (flat && std::fabs(dot(mode.travel, rim.axis)) > flat_rim_cosine) return beside_round(rim, mode);
  return Scan(world, surface, mode).beside();
}

}  // namespace straytrace
