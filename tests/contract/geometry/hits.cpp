// SPDX-License-Identifier: BSD-3-Clause
// Contract of every shape (docs/develop/testing.md): hits lie on the surface, normals are those of the surface, a
// leaving ray does not hit its own start point, bounds hold. Each predicate is also given broken variants.
#include <gtest/gtest.h>

#include "contract/geometry/instances.hpp"

namespace straytrace::testing {
namespace {

constexpr int rays = 2000;
constexpr double eps = 0x1p-52;

template <class T>
class ShapeHits : public ::testing::Test {};
TYPED_TEST_SUITE(ShapeHits, AllShapes);

// Whether check holds for all instances of Shape, called through Variant (Seen itself or a negative control of it).
template <class Variant, class Shape, class Check>
bool holds(Check check) {
  for (Shape const& s : instances<Shape>()) {
    Variant variant;
    variant.s = s;
    if (!check(variant)) return false;
  }
  return true;
}

// A ray aimed at a point of the surface from `far` away.
template <class View>
Ray aimed(View const& v, SurfacePoint target, double far, Directions& random) {
  for (;;) {
    Vec3 const d = random.direction();
    if (std::fabs(dot(d, v.normal(target))) > 0.05) return {target.point - far * d, d};
  }
}
constexpr double distances[] = {1e-2, 1, 300, 4e4};  // m

// Tolerance of a point computed at distance `far` on a shape placed at s.reference(): rounding of coordinates and of
// the distance; 1e-12 of the size for near shapes.
template <class Shape>
double spacing(Shape const& s, double far) {
  return 1e-13 * size(s) + 4 * eps * (far + length(s.reference()));
}

auto const hits_lie_on_the_surface = [](auto const& v) {
  auto const& s = v.s;
  Directions random(1);
  for (double far : distances)
    for (int i = 0; i < rays; ++i) {
      Ray const ray = aimed(v, random.point(s), far, random);
      Crossing const c = v.cross(ray, false);
      double const slack = 100 * spacing(s, far);
      if (!(c.distance <= far + slack)) return false;  // nothing found, or something behind the target
      SurfacePoint const p{ray.origin + c.distance * ray.dir, c.piece}, q = v.project(p), r = v.project(q);
      double const slope = std::fabs(dot(ray.dir, v.normal(p)));
      if (slope < 0.05) continue;  // the near side of a convex shape may be grazed
      if (!(length(q.point - p.point) <= spacing(s, far))) return false;
      if (!(length(r.point - q.point) <= 1e-14 * size(s) + 2 * eps * length(s.reference()))) return false;
      if (!(std::fabs(implicit(s, q.point, q.piece)) <= 1e-13 * size(s) + 4 * eps * length(s.reference())))
        return false;
    }
  return true;
};

auto const normals_are_gradients = [](auto const& v) {
  auto const& s = v.s;
  Directions random(2);
  double const step = 1e-3 * feature(s);  // errors of second order: (step/radius)^2
  for (int i = 0; i < rays; ++i) {
    SurfacePoint const p = random.point(s);
    Vec3 const n = v.normal(p);
    auto const along = [&](Vec3 e) {
      return (implicit(s, p.point + step * e, p.piece) - implicit(s, p.point - step * e, p.piece)) / (2 * step);
    };
    Vec3 const gradient{along({1, 0, 0}), along({0, 1, 0}), along({0, 0, 1})};
    double const noise = 5e-5 + 20 * eps * length(s.reference()) / step;
    if (axial(s, p.point).radius < 100 * step) continue;
    if (!(std::fabs(length(n) - 1) < 1e-15 * 4)) return false;
    if (!(length(n - unit(gradient)) < noise)) return false;
  }
  return true;
};

auto const extent_contains_everything = [](auto const& v) {
  auto const& s = v.s;
  Directions random(3);
  auto const [low, high, r_min, r_max] = v.extent();
  for (int i = 0; i < rays; ++i) {
    SurfacePoint const target = random.point(s);
    Ray const ray = aimed(v, target, 3, random);
    double const t = v.cross(ray, false).distance, pad = spacing(s, 3);
    for (Vec3 p : {target.point, ray.origin + t * ray.dir}) {
      Axial const a = axial(s, p);
      if (!(a.height >= low - pad && a.height <= high + pad && a.radius >= r_min - pad && a.radius <= r_max + pad))
        return false;
    }
  }
  return true;
};

// The box holds all samples and hits, and no side is longer than `loosest` times what the samples need.
constexpr double loosest = 2;
auto const bounds_are_close = [](auto const& v) {
  auto const& s = v.s;
  Directions random(8);
  Box const box = v.bounds();
  Box needed;
  for (int i = 0; i < 2 * rays; ++i) {
    SurfacePoint const target = random.point(s);
    Ray const ray = aimed(v, target, 3, random);
    needed.add(target.point);
    needed.add(ray.origin + v.cross(ray, false).distance * ray.dir);
  }
  double const pad = 2 * spacing(s, 3);
  for (double Vec3::*x : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    if (!(box.lower.*x <= needed.lower.*x + pad && box.upper.*x >= needed.upper.*x - pad)) return false;
    if (!(box.upper.*x - box.lower.*x <= loosest * (needed.upper.*x - needed.lower.*x) + pad)) return false;
  }
  return true;
};

// From one point of the surface: no hit at zero in a random direction; towards another point of the surface that point
// is met, after whatever lies between, and nothing is met on flat faces.
auto const leaving_is_exact = [](auto const& v) {
  auto const& s = v.s;
  Directions random(4);
  for (int i = 0; i < rays; ++i) {
    SurfacePoint const start = v.project(random.point(s));
    Vec3 const n = v.normal(start), d = random.direction();
    double const again = v.cross({start.point, d}, true, start.piece).distance;
    if (std::fabs(dot(d, n)) > 1e-3 && again < 1e-6 * std::fmin(feature(s), axial(s, start.point).radius)) return false;
    SurfacePoint const target = random.point(s);
    Vec3 const span = target.point - start.point;
    double const far = length(span),
                 slope = std::fabs(std::fmin(std::fabs(dot(span, n)), std::fabs(dot(span, v.normal(target))))) / far;
    if (slope < 1e-3) continue;
    double const rounding = (1e-11 * size(s) + 20 * eps * length(s.reference())) / slope;
    SurfacePoint at = start;
    double travelled = 0;
    while (travelled < far - rounding) {
      Crossing const c = v.cross({at.point, (1 / far) * span}, true, at.piece);
      travelled += c.distance;
      at = v.project({at.point + (c.distance / far) * span, c.piece});
    }
    if (!(travelled < far + rounding)) return false;
  }
  return true;
};

auto const ends_at_t_max = [](auto const& v) {
  Directions random(5);
  for (int i = 0; i < rays; ++i) {
    Ray ray = aimed(v, random.point(v.s), 5, random);
    double const t = v.cross(ray, false).distance;
    ray.t_max = t;
    if (v.cross(ray, false).distance < infinity) return false;
    ray.t_max = std::nextafter(t, infinity);
    if (v.cross(ray, false).distance != t) return false;
  }
  return true;
};

// Along the axis, across it, at the very radius, through the reference point: a hit on the surface or none, never NaN.
auto const special_rays_are_sound = [](auto const& v) {
  auto const& s = v.s;
  Frame const f = Frame::around(s.axis);
  auto const [low, high, r_min, r_max] = s.extent();
  for (double radius : {0.0, r_min, 0.5 * (r_min + r_max), r_max, r_max * (1 - 1e-12), r_max * (1 + 1e-12), 2 * r_max})
    for (double height : {low, 0.5 * (low + high), high, 3 * high + 1})
      for (Vec3 d : {s.axis, -s.axis, f.e1, -f.e1, f.e2, unit(s.axis + 1e-9 * f.e2), unit(f.e2 + 1e-9 * s.axis)})
        for (bool leaving : {false, true}) {
          Ray const ray{s.reference() + height * s.axis + radius * f.e1, d};
          Crossing const c = v.cross(ray, leaving);
          if (!(c.distance > 0)) return false;
          if (c.distance == infinity || leaving) continue;
          Vec3 const p = ray.origin + c.distance * ray.dir;
          double const slack = 1e-5 * size(s) + 1e-9;  // a tangent root is only good to the square root of rounding
          if (!(std::fabs(implicit(s, p, c.piece)) < slack && axial(s, p).radius < r_max + slack)) return false;
        }
  return true;
};

template <class S>
struct IgnoresLeaving : Seen<S> {
  Crossing cross(Ray const& r, bool, std::uint32_t = 0) const { return Seen<S>::cross(r, false); }
};
template <class S>
struct DropsFarSide : Seen<S> {
  Crossing cross(Ray const& r, bool leaving, std::uint32_t = 0) const {
    return leaving ? Crossing{} : Seen<S>::cross(r, false);
  }
};
template <class S>
struct TiltedNormal : Seen<S> {
  Vec3 normal(SurfacePoint p) const {
    Vec3 const n = Seen<S>::normal(p);
    return unit(n + 1e-3 * any_normal(n));
  }
};
template <class S>
struct OffTheSurface : Seen<S> {
  Crossing cross(Ray const& r, bool leaving, std::uint32_t piece = 0) const {
    Crossing c = Seen<S>::cross(r, leaving, piece);
    c.distance *= 1 + 1e-11;
    return c;
  }
};
template <class S>
struct TightExtent : Seen<S> {
  Extent extent() const {
    Extent e = Seen<S>::extent();
    e.r_max *= 0.99;
    return e;
  }
};
template <class S>
struct ScaledBounds : Seen<S> {
  double factor = 1;
  Box bounds() const {
    Box const b = Seen<S>::bounds();
    Vec3 const middle = 0.5 * (b.lower + b.upper);
    return {middle + factor * (b.lower - middle), middle + factor * (b.upper - middle)};
  }
};
template <class S>
struct TightBounds : ScaledBounds<S> {
  TightBounds() { this->factor = 0.9; }
};
template <class S>
struct LooseBounds : ScaledBounds<S> {
  LooseBounds() { this->factor = 2.5; }
};
template <class S>
struct IgnoresEnd : Seen<S> {
  Crossing cross(Ray const& r, bool leaving, std::uint32_t piece = 0) const {
    return Seen<S>::cross({r.origin, r.dir}, leaving, piece);
  }
};
template <class S>
struct DividesByZero : Seen<S> {
  Crossing cross(Ray const& r, bool leaving, std::uint32_t piece = 0) const {
    Crossing c = Seen<S>::cross(r, leaving, piece);
    if (c.distance == infinity) c.distance *= 0;
    return c;
  }
};

template <class T, class Check>
void expect_kept(Check check) {
  int index = 0;
  for (T const& s : instances<T>()) {
    EXPECT_TRUE(check(Seen<T>{s})) << T::key << ", instance " << index;
    ++index;
  }
}

TYPED_TEST(ShapeHits, lie_on_the_surface) {
  expect_kept<TypeParam>(hits_lie_on_the_surface);
  EXPECT_FALSE((holds<OffTheSurface<TypeParam>, TypeParam>(hits_lie_on_the_surface)));
}
TYPED_TEST(ShapeHits, normals_are_gradients) {
  expect_kept<TypeParam>(normals_are_gradients);
  EXPECT_FALSE((holds<TiltedNormal<TypeParam>, TypeParam>(normals_are_gradients)));
}
TYPED_TEST(ShapeHits, extent_contains_everything) {
  expect_kept<TypeParam>(extent_contains_everything);
  EXPECT_FALSE((holds<TightExtent<TypeParam>, TypeParam>(extent_contains_everything)));
}
TYPED_TEST(ShapeHits, bounds_are_close) {
  expect_kept<TypeParam>(bounds_are_close);
  EXPECT_FALSE((holds<TightBounds<TypeParam>, TypeParam>(bounds_are_close)));
  EXPECT_FALSE((holds<LooseBounds<TypeParam>, TypeParam>(bounds_are_close)));
}
TYPED_TEST(ShapeHits, leaving_is_exact) {
  expect_kept<TypeParam>(leaving_is_exact);
  EXPECT_FALSE((holds<IgnoresLeaving<TypeParam>, TypeParam>(leaving_is_exact)));
}
TYPED_TEST(ShapeHits, far_side_of_curved_shapes_is_found) {
  // dropping the far side of a plane is right
  bool const flat = std::is_same_v<TypeParam, Disk> || std::is_base_of_v<PlaneFrame, TypeParam>;
  EXPECT_EQ((holds<DropsFarSide<TypeParam>, TypeParam>(leaving_is_exact)), flat);
}
TYPED_TEST(ShapeHits, end_at_t_max) {
  expect_kept<TypeParam>(ends_at_t_max);
  EXPECT_FALSE((holds<IgnoresEnd<TypeParam>, TypeParam>(ends_at_t_max)));
}
TYPED_TEST(ShapeHits, special_rays_are_sound) {
  expect_kept<TypeParam>(special_rays_are_sound);
  EXPECT_FALSE((holds<DividesByZero<TypeParam>, TypeParam>(special_rays_are_sound)));
}

}  // namespace
}  // namespace straytrace::testing
