// SPDX-License-Identifier: BSD-3-Clause
// The curvature of every shape is the slope of its normal: n(p + r) - n(p) = -K r along the surface. A shape without a
// own closed form counts as flat and is found here.
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include "contract/geometry/instances.hpp"
#include "geometry/shapes/shape.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing {
namespace {

template <class T>
class ShapeCurvature : public ::testing::Test {};
TYPED_TEST_SUITE(ShapeCurvature, AllShapes);

// Largest error of K over its tolerance, from central differences; `make` gives the tensor at a point.
template <class Shape, class Make>
double worst(Shape const& s, Make const& make) {
  Directions random(21);
  double worst_ratio = 0;
  double const far = length(s.reference());
  for (int i = 0; i < 500; ++i) {
    SurfacePoint const p = random.point(s);
    Vec3 const at = projected_on(s, p.point, p.piece), n = normal_of(s, at, p.piece);
    double const step = 3e-5 * std::fmin(feature(s), axial(s, at).radius);
    if (!(step > 1e-9 * size(s))) continue;
    SurfaceCurvature const k = make(s, at, p.piece);
    if (!(std::fabs(dot(k.a, n)) < 1e-12 && std::fabs(dot(k.b, n)) < 1e-12 && std::fabs(dot(k.a, k.b)) < 1e-12))
      return infinity;
    double const most = std::fmax(std::fabs(k.aa), std::fabs(k.bb)) + std::fabs(k.ab);
    for (Vec3 r : {k.a, k.b, unit(k.a + 0.3 * k.b)}) {
      Vec3 const up = normal_of(s, at + step * r, p.piece), down = normal_of(s, at - step * r, p.piece);
      for (Vec3 t : {k.a, k.b}) {
        double const slope = dot(up - down, t) / (2 * step);
        double const rounding = 10 * 0x1p-52 * (1 + (far + size(s)) * most) / step;
        worst_ratio = std::fmax(worst_ratio, std::fabs(k.between(r, t) + slope) / (1e-6 * most + rounding));
      }
    }
  }
  return worst_ratio;
}

template <class Shape>
double worst_of_all(auto const& make) {
  double all = 0;
  for (Shape const& s : instances<Shape>()) all = std::fmax(all, worst(s, make));
  return all;
}

TYPED_TEST(ShapeCurvature, is_the_slope_of_the_normal) {
  EXPECT_LT(worst_of_all<TypeParam>([](auto const& s, Vec3 p, std::uint32_t i) { return curvature_of(s, p, i); }), 1);
}

// Negative controls: the other sign, and the two principal directions exchanged.
template <class Shape>
constexpr bool curved =
    !std::is_base_of_v<PlaneFrame, Shape> && !std::is_same_v<Shape, Disk> && !std::is_same_v<Shape, Cuboid>;
TYPED_TEST(ShapeCurvature, controls_are_rejected) {
  if constexpr (curved<TypeParam>) {
    EXPECT_GT(worst_of_all<TypeParam>(
                  [](auto const& s, Vec3 p, std::uint32_t i) { return curvature_of(s, p, i).from_behind(); }),
              1e3);
    if constexpr (std::is_base_of_v<Cylinder, TypeParam> || std::is_base_of_v<Cone, TypeParam> ||
                  std::is_same_v<TypeParam, Torus> || std::is_same_v<TypeParam, Conic>) {
      EXPECT_GT(worst_of_all<TypeParam>([](auto const& s, Vec3 p, std::uint32_t i) {
                  SurfaceCurvature k = curvature_of(s, p, i);
                  std::swap(k.aa, k.bb);
                  return k;
                }),
                1e3);
    }
  } else {
    EXPECT_GT(worst_of_all<TypeParam>([](auto const& s, Vec3 p, std::uint32_t i) {
                SurfaceCurvature k = curvature_of(s, p, i);
                k.aa = 1;
                return k;
              }),
              1e3);
  }
}

// Signs as in the documentation: concave towards the normal is positive (docs/develop/conventions.md).
TEST(Curvature, has_the_sign_of_mirrors) {
  EXPECT_DOUBLE_EQ(curvature_of(cap(1 / 1420.0, 0, 0.175), {0, 0, 0}, 0).aa, 1 / 1420.0);
  EXPECT_DOUBLE_EQ(curvature_of(sphere(2), {0, 0, 2}, 0).bb, -0.5);
  EXPECT_DOUBLE_EQ(curvature_of(conic(0.5, -1, 0, 0.3), {0, 0, 0}, 0).bb, 0.5);
  EXPECT_DOUBLE_EQ(curvature_of(disk(0, 1), {0.1, 0, 0}, 0).aa, 0);
}

}  // namespace
}  // namespace straytrace::testing
