// SPDX-License-Identifier: BSD-3-Clause
// What every shape must keep (architecture.md section 10): hits lie on the surface, normals are those of the surface, a
// leaving ray does not hit its own start point, bounds hold. Each predicate is also given broken variants.
#include <gtest/gtest.h>

#include "geometry_instances.hpp"

namespace straytrace::testing {
namespace {

constexpr int rays = 2000;
constexpr double eps = 0x1p-52;

template <class T>
class ShapeHits : public ::testing::Test {};
TYPED_TEST_SUITE(ShapeHits, AllShapes);

// Whether check(shape) holds for all instances of Shape, seen as Variant (the shape itself or a broken twin of it).
template <class Variant, class Shape, class Check>
bool holds(Check check) {
  for (Shape const& s : instances<Shape>()) {
    Variant variant;
    static_cast<Shape&>(variant) = s;
    if (!check(variant)) return false;
  }
  return true;
}

// A ray aimed at a point of the surface from `far` away.
template <class Shape>
Ray aimed(Shape const& s, Vec3 target, double far, Directions& random) {
  for (;;) {
    Vec3 const d = random.direction();
    if (std::fabs(dot(d, s.normal(target))) > 0.05) return {target - far * d, d};
  }
}
constexpr double distances[] = {1e-2, 1, 300, 4e4};  // m

// Tolerance of a point computed at distance `far` on a shape placed at s.reference(): rounding of coordinates and of
// the distance; 1e-12 of the size for near shapes.
template <class Shape>
double spacing(Shape const& s, double far) {
  return 1e-13 * size(s) + 4 * eps * (far + length(s.reference()));
}

auto const hits_lie_on_the_surface = [](auto const& s) {
  Directions random(1);
  for (double far : distances)
    for (int i = 0; i < rays; ++i) {
      Vec3 const target = random.point(s);
      Ray const ray = aimed(s, target, far, random);
      double const t = s.distance(ray, false), slack = 100 * spacing(s, far);
      if (!(t <= far + slack)) return false;  // nothing found, or something behind the target
      Vec3 const p = ray.origin + t * ray.dir, q = s.project(p), r = s.project(q);
      double const slope = std::fabs(dot(ray.dir, s.normal(p)));
      if (slope < 0.05) continue;  // the near side of a convex shape may be grazed
      if (!(length(q - p) <= spacing(s, far))) return false;
      if (!(length(r - q) <= 1e-14 * size(s) + 2 * eps * length(s.reference()))) return false;
      if (!(std::fabs(implicit(s, q)) <= 1e-13 * size(s) + 4 * eps * length(s.reference()))) return false;
    }
  return true;
};

auto const normals_are_gradients = [](auto const& s) {
  Directions random(2);
  double const step = 1e-3 * axial(s, s.sample(0.5, 0.5)).radius;  // errors of second order: (step/radius)^2
  for (int i = 0; i < rays; ++i) {
    Vec3 const p = random.point(s), n = s.normal(p);
    auto const along = [&](Vec3 e) { return (implicit(s, p + step * e) - implicit(s, p - step * e)) / (2 * step); };
    Vec3 const gradient{along({1, 0, 0}), along({0, 1, 0}), along({0, 0, 1})};
    double const noise = 5e-5 + 20 * eps * length(s.reference()) / step;
    if (axial(s, p).radius < 100 * step) continue;
    if (!(std::fabs(length(n) - 1) < 1e-15 * 4)) return false;
    if (!(length(n - unit(gradient)) < noise)) return false;
  }
  return true;
};

auto const extent_contains_everything = [](auto const& s) {
  Directions random(3);
  double low, high, r_min, r_max;
  s.extent(low, high, r_min, r_max);
  for (int i = 0; i < rays; ++i) {
    Vec3 const target = random.point(s);
    Ray const ray = aimed(s, target, 3, random);
    double const t = s.distance(ray, false), pad = spacing(s, 3);
    for (Vec3 p : {target, ray.origin + t * ray.dir}) {
      Axial const a = axial(s, p);
      if (!(a.height >= low - pad && a.height <= high + pad && a.radius >= r_min - pad && a.radius <= r_max + pad))
        return false;
    }
  }
  return true;
};

// From one point of the surface: no hit at zero in a random direction; towards another point of the surface exactly
// that point (the shapes are quadrics: a line meets them twice), nothing for flat shapes.
auto const leaving_is_exact = [](auto const& s) {
  Directions random(4);
  for (int i = 0; i < rays; ++i) {
    Vec3 const p = s.project(random.point(s)), n = s.normal(p), d = random.direction();
    double const scale = axial(s, p).radius, again = s.distance({p, d}, true);
    if (std::fabs(dot(d, n)) > 1e-3 && again < 1e-6 * scale) return false;
    Vec3 const target = random.point(s), span = target - p;
    double const far = length(span), slope = std::fabs(dot(span, n)) / far;
    double const found = s.distance({p, (1 / far) * span}, true);
    if (slope < 1e-3) continue;
    double const rounding = 1e-11 * size(s) + 20 * eps * length(s.reference());
    if (!(std::fabs(found - far) < rounding / slope)) return false;
  }
  return true;
};

auto const ends_at_t_max = [](auto const& s) {
  Directions random(5);
  for (int i = 0; i < rays; ++i) {
    Ray ray = aimed(s, random.point(s), 5, random);
    double const t = s.distance(ray, false);
    ray.t_max = t;
    if (s.distance(ray, false) < infinity) return false;
    ray.t_max = std::nextafter(t, infinity);
    if (s.distance(ray, false) != t) return false;
  }
  return true;
};

// Along the axis, across it, at the very radius, through the reference point: a hit on the surface or none, never NaN.
auto const special_rays_are_sound = [](auto const& s) {
  Frame const f = Frame::around(s.axis);
  double low, high, r_min, r_max;
  s.extent(low, high, r_min, r_max);
  for (double radius : {0.0, r_min, 0.5 * (r_min + r_max), r_max, r_max * (1 - 1e-12), r_max * (1 + 1e-12), 2 * r_max})
    for (double height : {low, 0.5 * (low + high), high, 3 * high + 1})
      for (Vec3 d : {s.axis, -s.axis, f.e1, -f.e1, f.e2, unit(s.axis + 1e-9 * f.e2), unit(f.e2 + 1e-9 * s.axis)})
        for (bool leaving : {false, true}) {
          Ray const ray{s.reference() + height * s.axis + radius * f.e1, d};
          double const t = s.distance(ray, leaving);
          if (!(t > 0)) return false;
          if (t == infinity || leaving) continue;
          Axial const a = axial(s, ray.origin + t * ray.dir);
          double const slack = 1e-5 * size(s) + 1e-9;  // a tangent root is only good to the square root of rounding
          if (!(std::fabs(implicit(s, ray.origin + t * ray.dir)) < slack && a.radius < r_max + slack)) return false;
        }
  return true;
};

template <class S>
struct IgnoresLeaving : S {
  double distance(Ray const& r, bool) const { return S::distance(r, false); }
};
template <class S>
struct DropsFarSide : S {
  double distance(Ray const& r, bool leaving) const { return leaving ? infinity : S::distance(r, false); }
};
template <class S>
struct TiltedNormal : S {
  Vec3 normal(Vec3 p) const {
    Vec3 const n = S::normal(p);
    return unit(n + 1e-3 * any_normal(n));
  }
};
template <class S>
struct OffTheSurface : S {
  double distance(Ray const& r, bool leaving) const { return (1 + 1e-11) * S::distance(r, leaving); }
};
template <class S>
struct TightExtent : S {
  void extent(double& low, double& high, double& r_min, double& r_max) const {
    S::extent(low, high, r_min, r_max);
    r_max *= 0.99;
  }
};
template <class S>
struct IgnoresEnd : S {
  double distance(Ray const& r, bool leaving) const { return S::distance({r.origin, r.dir}, leaving); }
};
template <class S>
struct DividesByZero : S {
  double distance(Ray const& r, bool leaving) const {
    double const t = S::distance(r, leaving);
    return t < infinity ? t : 0 * t;
  }
};

TYPED_TEST(ShapeHits, lie_on_the_surface) {
  EXPECT_TRUE((holds<TypeParam, TypeParam>(hits_lie_on_the_surface)));
  EXPECT_FALSE((holds<OffTheSurface<TypeParam>, TypeParam>(hits_lie_on_the_surface)));
}
TYPED_TEST(ShapeHits, normals_are_gradients) {
  EXPECT_TRUE((holds<TypeParam, TypeParam>(normals_are_gradients)));
  EXPECT_FALSE((holds<TiltedNormal<TypeParam>, TypeParam>(normals_are_gradients)));
}
TYPED_TEST(ShapeHits, extent_contains_everything) {
  EXPECT_TRUE((holds<TypeParam, TypeParam>(extent_contains_everything)));
  EXPECT_FALSE((holds<TightExtent<TypeParam>, TypeParam>(extent_contains_everything)));
}
TYPED_TEST(ShapeHits, leaving_is_exact) {
  EXPECT_TRUE((holds<TypeParam, TypeParam>(leaving_is_exact)));
  EXPECT_FALSE((holds<IgnoresLeaving<TypeParam>, TypeParam>(leaving_is_exact)));
}
TYPED_TEST(ShapeHits, far_side_of_curved_shapes_is_found) {
  bool const flat = std::is_same_v<TypeParam, Disk>;  // dropping the far side of a plane is right
  EXPECT_EQ((holds<DropsFarSide<TypeParam>, TypeParam>(leaving_is_exact)), flat);
}
TYPED_TEST(ShapeHits, end_at_t_max) {
  EXPECT_TRUE((holds<TypeParam, TypeParam>(ends_at_t_max)));
  EXPECT_FALSE((holds<IgnoresEnd<TypeParam>, TypeParam>(ends_at_t_max)));
}
TYPED_TEST(ShapeHits, special_rays_are_sound) {
  EXPECT_TRUE((holds<TypeParam, TypeParam>(special_rays_are_sound)));
  EXPECT_FALSE((holds<DividesByZero<TypeParam>, TypeParam>(special_rays_are_sound)));
}

}  // namespace
}  // namespace straytrace::testing
