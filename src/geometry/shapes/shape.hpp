// SPDX-License-Identifier: BSD-3-Clause
// Common interface of shapes, simple ones or those of many flat pieces (meshes): where a ray meets them, and the
// surface there.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "base/math/constants.hpp"
#include "base/math/vec3.hpp"
#include "base/memory/host_device.hpp"

namespace straytrace::geometry {

// Numerics of shapes. Roots that cannot be lost: bracketed Newton steps, and the search for the first root of a
// function whose second derivative is bounded. Random numbers for sampling by rejection, as functions of two given
// ones.

struct Sloped {
  double value, slope;
};

// The root of f between a and b, where f(a) and f(b) have opposite signs (or one is zero): Newton steps that fall back
// to bisection, until the bracket or the step is exhausted.
template <class F>
STRAY_HD double bracketed_root(F const& f, double a, double b, bool rising) {
  double x = a + 0.5 * (b - a), last = b - a;
  for (int i = 0; i < 200; ++i) {
    Sloped const y = f(x);
    if (y.value == 0) return x;
    ((y.value > 0) == rising ? b : a) = x;
    double const newton = x - y.value / y.slope, step = std::fabs(newton - x);
    bool const good = newton > a && newton < b && step <= 0.5 * std::fabs(last);
    double const next = good ? newton : a + 0.5 * (b - a);
    last = next - x;
    if (next == x || !(next > a && next < b)) return x;
    x = next;
  }
  return x;
}

// The first root in (from, to) that `keep(t)` takes, infinity: none. `bend` bounds |f''| on the interval. Pieces of the
// interval are dropped when f cannot reach zero on them and searched when f is monotone on them; all others are halved.
// `least` is the length below which a piece that is still open (a tangent within rounding) holds no root.
template <class F, class Keep>
STRAY_HD double first_root(F const& f, double from, double to, double bend, double least, Keep const& keep) {
  struct Piece {
    double a, b;
  } stack[128];
  int top = 0;
  stack[top++] = {from, to};
  while (top > 0) {
    Piece const p = stack[--top];
    double const half = 0.5 * (p.b - p.a), middle = p.a + half;
    Sloped const y = f(middle);
    if (std::fabs(y.value) > half * (std::fabs(y.slope) + 0.5 * bend * half)) continue;
    if (std::fabs(y.slope) > bend * half) {
      double const low = f(p.a).value, high = f(p.b).value;
      if ((low < 0) == (high < 0) && low != 0 && high != 0) continue;
      double const t = bracketed_root(f, p.a, p.b, y.slope > 0);
      if (keep(t)) return t;
      continue;
    }
    if (half < least || top + 2 > 128) continue;
    stack[top++] = {middle, p.b};
    stack[top++] = {p.a, middle};
  }
  return infinity;
}

// A sequence of uniform numbers in [0, 1), fixed by u and v (splitmix64; Steele, Lea, Flood 2014).
class Redraw {
 public:
  STRAY_HD Redraw(double u, double v) {
    std::uint64_t a, b;
    std::memcpy(&a, &u, sizeof a);
    std::memcpy(&b, &v, sizeof b);
    state_ = mixed(a) ^ (b * 0xd6e8feb86659fd93ull);
  }
  STRAY_HD double next() {
    state_ += 0x9e3779b97f4a7c15ull;
    return static_cast<double>(mixed(state_) >> 11) * 0x1p-53;
  }

 private:
  STRAY_HD static std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
  }
  std::uint64_t state_;
};

}  // namespace straytrace::geometry

namespace straytrace {
template <class T>
struct Key;  // base/input/table.hpp
}  // namespace straytrace

namespace straytrace::geometry {

struct Drawing;  // geometry/drawing.hpp

constexpr std::uint32_t no_piece = 0xffffffffu;

// Distance to a surface along a ray, m, and the piece of it that is hit (0 for a shape without pieces).
struct Crossing {
  double distance = infinity;
  std::uint32_t piece = 0;
};

// Heights along the axis of a shape from its reference point, and distances from that axis, m, that contain the
// surface.
struct Extent {
  double low = 0, high = 0, r_min = 0, r_max = 0;
};

// A point drawn on a surface, uniform in area.
struct SurfacePoint {
  Vec3 point;
  std::uint32_t piece = 0;
};

// Why the values of its keys, each within its range, do not form a valid shape, and the remedy; empty: they do.
struct ShapeComplaint {
  std::string what, suggestion;
};

// Curvature of a surface at a point, for beams at mirrors or lens faces. Symmetric tensor in the tangent plane,
// 1/m. The height of the surface over that plane, along the unit normal of the shape (normal_of), is (1/2) r.K.r:
// positive where the surface bends towards its normal, so that a mirror is concave to light that travels against the
// normal. The derivative of the unit normal along r is -K r.
struct SurfaceCurvature {
  Vec3 a{1, 0, 0}, b{0, 1, 0};    // unit tangents at right angles to each other
  double aa = 0, ab = 0, bb = 0;  // a.K.a, a.K.b, b.K.b

  // The same in all directions.
  static SurfaceCurvature uniform(Vec3 normal, double curvature) {
    Frame const f = Frame::around(normal);
    return {f.e1, f.e2, curvature, 0, curvature};
  }
  // A surface of revolution: the principal directions run around the axis and at right angles to that.
  static SurfaceCurvature revolved(Vec3 axis, Vec3 outward, Vec3 normal, double around, double across) {
    Vec3 const ring = cross(axis, outward);
    return {ring, cross(normal, ring), around, 0, across};
  }
  bool flat() const { return aa == 0 && ab == 0 && bb == 0; }
  // u.K.v of any two vectors: their parts along the normal do not count.
  double between(Vec3 u, Vec3 v) const {
    double const ua = dot(u, a), ub = dot(u, b), va = dot(v, a), vb = dot(v, b);
    return ua * (aa * va + ab * vb) + ub * (ab * va + bb * vb);
  }
  // The same surface for the opposite normal.
  SurfaceCurvature from_behind() const { return {a, b, -aa, -ab, -bb}; }
};

// A shape with pieces states `static constexpr bool has_pieces = true` and has
//   Crossing crossing(Ray const&, std::uint32_t leaving) const   leaving: the piece the ray starts on, or no_piece
//   Vec3 normal(Vec3 p, std::uint32_t piece) const, Vec3 project(Vec3 p, std::uint32_t piece) const
//   SurfacePoint sample(double u, double v) const
// in place of distance, normal, project and sample of simple shapes (shape_types.hpp).
template <class S>
concept HasPieces = requires {
  requires S::has_pieces;
};

// A straight line between two points of the shape may cross it in between. Lines meet quadrics twice, so these cannot;
// other shapes without pieces state `static constexpr bool hides_itself = true`.
template <class S>
concept MayHideItself = HasPieces<S> || requires {
  requires S::hides_itself;
};

template <class S>
STRAY_HD Crossing crossing_of(S const& s, Ray const& ray, bool leaving, std::uint32_t piece) {
  if constexpr (HasPieces<S>)
    return s.crossing(ray, leaving ? piece : no_piece);
  else
    return {s.distance(ray, leaving), 0};
}
template <class S>
STRAY_HD Vec3 normal_of(S const& s, Vec3 p, std::uint32_t piece) {
  if constexpr (HasPieces<S>)
    return s.normal(p, piece);
  else
    return s.normal(p);
}
template <class S>
bool has_normals(S const& s) {
  if constexpr (requires { s.content.normals; })
    return s.content.normals.size > 0;
  else
    return false;
}
// Interpolated between the normals at the corners of a piece, where the shape has them; otherwise the normal itself.
template <class S>
STRAY_HD Vec3 smooth_normal_of(S const& s, Vec3 p, std::uint32_t piece) {
  if constexpr (requires { s.smooth_normal(p, piece); })
    return s.smooth_normal(p, piece);
  else
    return normal_of(s, p, piece);
}
template <class S>
STRAY_HD Vec3 projected_on(S const& s, Vec3 p, std::uint32_t piece) {
  if constexpr (HasPieces<S>)
    return s.project(p, piece);
  else
    return s.project(p);
}
template <class S>
STRAY_HD SurfacePoint sample_of(S const& s, double u, double v) {
  if constexpr (HasPieces<S>)
    return s.sample(u, v);
  else
    return {s.sample(u, v), 0};
}
// Flat unless the shape has `curvature_at(p)`.
template <class S>
SurfaceCurvature curvature_of(S const& s, Vec3 p, std::uint32_t piece) {
  if constexpr (requires { s.curvature_at(p); })
    return s.curvature_at(p);
  else
    return SurfaceCurvature::uniform(normal_of(s, p, piece), 0);
}
// Checks beyond the ranges of the keys.
template <class S>
ShapeComplaint impossible(S const& s) {
  if constexpr (requires { s.impossible(); })
    return s.impossible();
  else
    return {};
}

}  // namespace straytrace::geometry
