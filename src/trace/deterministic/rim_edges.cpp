// SPDX-License-Identifier: BSD-3-Clause
#include "trace/deterministic/rim_edges.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/math/gauss_points.hpp"

namespace straytrace::trace {
namespace {

using Flat = world::BeamAperture::Flat;
using world::FlatRim;
using world::Outline;

constexpr double far_off = 6;  // 1/e^2 radii: e^-72 of the light on the axis
constexpr int points_of_a_piece = 8;

Vec3 corner(Outline const& o, FlatRim const& rim, int k) {
  if (o.rectangle) {
    double const x = k == 0 || k == 3 ? o.semi_x : -o.semi_x, y = k < 2 ? o.semi_y : -o.semi_y;
    return rim.centre + x * rim.e1 + y * rim.e2;
  }
  double const at = o.rotation + 2 * pi * k / o.sides;
  return rim.centre + o.semi_x * std::cos(at) * rim.e1 + o.semi_x * std::sin(at) * rim.e2;
}

// Calls each(point, step) along an outline, from e1 towards e2, in pieces of a radius of the beam.
template <class Each>
void along(Outline const& o, FlatRim const& rim, double piece, Each const& each) {
  static GaussPoints const rule(points_of_a_piece);
  auto const pieces = [&](double length) { return int(std::clamp(std::ceil(length / piece), 1.0, 1e6)); };
  auto const run = [&](int count, auto const& point, auto const& slope) {
    for (int i = 0; i < count; ++i)
      for (int g = 0; g < points_of_a_piece; ++g) {
        double const t = (i + rule.at[std::size_t(g)]) / count;
        each(point(t), (rule.weight[std::size_t(g)] / count) * slope(t));
      }
  };
  if (o.sides == 0) {
    int const count = std::max(16, pieces(2 * pi * std::max(o.semi_x, o.semi_y)));
    run(
        count,
        [&](double t) {
          SinCos const a = sincos_turn(t);
          return rim.centre + o.semi_x * a.cos * rim.e1 + o.semi_y * a.sin * rim.e2;
        },
        [&](double t) {
          SinCos const a = sincos_turn(t);
          return 2 * pi * (o.semi_y * a.cos * rim.e2 - o.semi_x * a.sin * rim.e1);
        });
    return;
  }
  for (int k = 0; k < int(o.sides); ++k) {
    Vec3 const from = corner(o, rim, k), side = corner(o, rim, (k + 1) % int(o.sides)) - from;
    run(
        pieces(length(side)), [&](double t) { return from + t * side; }, [&](double) { return side; });
  }
}

// A beam of power 1: its light and the lines across it.
class Light {
 public:
  explicit Light(Mode const& mode) : mode_(mode), spot_(beams::spot(mode)) {}
  double minor() const { return spot_.minor; }
  bool reaches(Vec3 p) const {
    Vec3 const o = p - mode_.origin;
    return length2(o - dot(o, mode_.travel) * mode_.travel) < far_off * far_off * spot_.major * spot_.major;
  }
  // W/m^2, along the normal of the wavefront. It has no sources, so the power through a surface depends on its edge
  // alone.
  Vec3 flux(Vec3 p) const {
    Mode const at = beams::propagated(mode_, dot(p - mode_.origin, mode_.travel));
    Vec3 const o = p - at.origin;
    double const x = dot(o, at.e1), y = dot(o, at.e2);
    return beams::intensity(at, p) * (at.travel + (at.q11.real() * x + at.q12.real() * y) * at.e1 +
                                      (at.q12.real() * x + at.q22.real() * y) * at.e2);
  }
  // Coordinates of a vector in which the beam is round: exp(-2 rho^2) of its power lies beyond rho.
  world::PlanePoint round(Vec3 v) const {
    double const k = pi / mode_.wavelength, a = k * mode_.q11.imag(), b = k * mode_.q12.imag(),
                 c = k * mode_.q22.imag(), root = std::sqrt(a);
    double const x = dot(v, mode_.e1), y = dot(v, mode_.e2);
    return {root * x + b / root * y, std::sqrt(c - b * b / a) * y};
  }
  Vec3 origin() const { return mode_.origin; }
  double side(FlatRim const& rim) const { return dot(rim.axis, mode_.travel) < 0 ? -1 : 1; }

 private:
  Mode mode_;
  beams::Spot spot_;
};

// Share of the power inside an outline: the turns of its edge about the chief ray less their part beyond rho.
struct Inside {
  double turns = 0;   // 1 or 0, where the edge is not near the chief ray
  double beyond = 0;  // turns weighed by exp(-2 rho^2)
  double share = 0;
  bool near = false;
};
Inside inside(Outline const& o, FlatRim const& rim, Light const& light) {
  constexpr double close = 0.3;  // rho
  Inside sum;
  double nearest = std::numeric_limits<double>::infinity();
  along(o, rim, light.minor(), [&](Vec3 p, Vec3 step) {
    world::PlanePoint const r = light.round(p - light.origin()), d = light.round(step);
    double const square = r.x * r.x + r.y * r.y, turn = light.side(rim) * (r.x * d.y - r.y * d.x) / (2 * pi * square);
    sum.share -= std::expm1(-2 * square) * turn;
    sum.beyond += std::exp(-2 * square) * turn;
    nearest = std::min(nearest, std::sqrt(square));
  });
  sum.near = nearest < close;
  sum.turns = std::round(sum.share + sum.beyond);
  return sum;
}

double removed_by(Flat const& f, Light const& light) {
  Inside const outer = inside(f.rim.outer, f.rim, light),
               inner = f.rim.hole ? inside(f.rim.inner, f.rim, light) : Inside{};
  double const met = outer.share - inner.share, lost = f.screen ? met : 1 - met;
  if (outer.near || inner.near) return lost;
  double const whole = outer.turns - inner.turns, beyond = outer.beyond - inner.beyond;
  return (f.screen ? whole : 1 - whole) - (f.screen ? beyond : -beyond);
}

// Slope of the power on the plate by a motion v of its edge, the integral of S . (v x dl), for each coordinate.
void add_slope(CoordinateGradient& slope, Outline const& o, FlatRim const& rim, Vec3 pivot, Light const& light,
               double sign) {
  along(o, rim, light.minor(), [&](Vec3 p, Vec3 step) {
    if (!light.reaches(p)) return;
    Vec3 const by = cross(step, light.flux(p)), turn = cross(p - pivot, by);  // S . (v x dl) = v . (dl x S)
    double const all[] = {by.x, by.y, by.z, turn.x, turn.y, turn.z};
    for (int i = 0; i < 6; ++i) slope[i] += sign * all[i];
  });
}

CoordinateGradient slope_of(Flat const& f, Vec3 pivot, Light const& light) {
  CoordinateGradient slope = CoordinateGradient::Zero();
  double const sign = (f.screen ? -1 : 1) * light.side(f.rim);
  add_slope(slope, f.rim.outer, f.rim, pivot, light, sign);
  if (f.rim.hole) add_slope(slope, f.rim.inner, f.rim, pivot, light, -sign);
  return slope;
}

Flat displaced(Flat f, Vec3 pivot, CoordinateGradient const& x) {
  Vec3 const turn{x[3], x[4], x[5]};
  f.rim.centre = pivot + turned(f.rim.centre - pivot, turn) + Vec3{x[0], x[1], x[2]};
  for (Vec3* v : {&f.rim.e1, &f.rim.e2, &f.rim.axis}) *v = turned(*v, turn);
  return f;
}

}  // namespace

Vec3 turned(Vec3 v, Vec3 by) {
  double const angle = length(by);
  if (!(angle > 0)) return v;
  Vec3 const axis = (1 / angle) * by;
  return std::cos(angle) * v + std::sin(angle) * cross(axis, v) + (1 - std::cos(angle)) * dot(axis, v) * axis;
}

double size_of(FlatRim const& rim) {
  Outline const& o = rim.hole ? rim.inner : rim.outer;
  return std::hypot(o.semi_x, o.rectangle ? o.semi_y : 0.0);
}

RimDerivatives rim_derivatives(Flat const& f, Vec3 pivot) {
  constexpr double part = 0.005;  // of a radius of the beam
  Light const light(f.mode);
  double const shift = part * light.minor(),
               turn = std::min(part, shift / std::max(length(f.rim.centre - pivot), size_of(f.rim)));
  RimDerivatives d;
  d.removed = removed_by(f, light);
  d.slope = slope_of(f, pivot, light);
  for (int j = 0; j < 6; ++j) {  // differences of fourth order
    double const h = j < 3 ? shift : turn;
    auto const at = [&](double steps) -> CoordinateGradient {
      CoordinateGradient const x = steps * h * CoordinateGradient::Unit(j);
      return slope_of(displaced(f, pivot, x), pivot + Vec3{x[0], x[1], x[2]}, light);
    };
    d.curvature.col(j) = (at(-2) - 8 * at(-1) + 8 * at(1) - at(2)) / (12 * h);
  }
  d.curvature = (0.5 * (d.curvature + d.curvature.transpose())).eval();
  return d;
}

}  // namespace straytrace::trace
