// SPDX-License-Identifier: BSD-3-Clause
// Area and sampling of every shape: area() against quadrature of the profile, sample() uniform in area by chi-square.
#include <gtest/gtest.h>

#include "contract/geometry/instances.hpp"
#include "support/chi_square.hpp"

namespace straytrace::testing::geometry_sampling {
namespace {

// Point of the profile (height and radius) at s from 0 to 1; each shape is its profile turned about the axis.
Axial profile(Disk const& d, double s) { return {0, d.inner_radius + s * (d.outer_radius - d.inner_radius)}; }
Axial profile(Cap const& c, double s) {
  double const rho = c.inner_radius + s * (c.outer_radius - c.inner_radius);
  if (c.curvature == 0) return {0, rho};
  double const full = 1 / std::fabs(c.curvature);
  return {std::copysign(rho * rho / (full + std::sqrt(full * full - rho * rho)), c.curvature), rho};
}
Axial profile(Cylinder const& c, double s) { return {c.from + s * (c.to - c.from), c.radius}; }
Axial profile(Cone const& c, double s) {
  double const rho = c.inner_radius + s * (c.outer_radius - c.inner_radius);
  return {(rho - c.inner_radius) / std::tan(c.half_angle), rho};
}
Axial profile(Sphere const& b, double s) { return {-b.radius * std::cos(pi * s), b.radius * std::sin(pi * s)}; }

Axial profile(Conic const& c, double s) {
  double const rho = c.inner_radius + s * (c.outer_radius - c.inner_radius);
  return {c.sag(rho * rho), rho};
}
Axial profile(Torus const& t, double s) {
  return {t.minor_radius * std::sin(2 * pi * s), t.major_radius + t.minor_radius * std::cos(2 * pi * s)};
}
double lowest_angle(Zone const& z) { return std::asin(z.from / z.radius); }
double angles(Zone const& z) { return std::asin(z.to / z.radius) - lowest_angle(z); }
Axial profile(Zone const& z, double s) {
  double const angle = lowest_angle(z) + s * angles(z);
  return {z.radius * std::sin(angle), z.radius * std::cos(angle)};
}

// The inverse: s of a point with this height and radius.
double position(Disk const& d, Axial a) { return (a.radius - d.inner_radius) / (d.outer_radius - d.inner_radius); }
double position(Cap const& c, Axial a) { return (a.radius - c.inner_radius) / (c.outer_radius - c.inner_radius); }
double position(Cylinder const& c, Axial a) { return (a.height - c.from) / (c.to - c.from); }
double position(Cone const& c, Axial a) { return (a.radius - c.inner_radius) / (c.outer_radius - c.inner_radius); }
double position(Sphere const&, Axial a) { return std::atan2(a.radius, -a.height) / pi; }
double position(Conic const& c, Axial a) { return (a.radius - c.inner_radius) / (c.outer_radius - c.inner_radius); }
double position(Torus const& t, Axial a) {
  double const turn = std::atan2(a.height, a.radius - t.major_radius) / (2 * pi);
  return turn < 0 ? turn + 1 : turn;
}
double position(Zone const& z, Axial a) { return (std::atan2(a.height, a.radius) - lowest_angle(z)) / angles(z); }

// Area of the shape between two places of its profile: frusta of fine steps, finer where the profile is steep.
template <class Shape>
double ring_area(Shape const& shape, double from, double to) {
  constexpr int steps = 2000;
  double sum = 0;
  Axial last = profile(shape, from);
  for (int i = 1; i <= steps; ++i) {
    double const x = double(i) / steps, s = from + (to - from) * x * (2 - x);
    Axial const next = profile(shape, s);
    sum += pi * (last.radius + next.radius) * std::hypot(next.height - last.height, next.radius - last.radius);
    last = next;
  }
  return sum;
}

template <class T>
class ShapeArea : public ::testing::Test {};
using Revolved = ::testing::Types<Disk, Cap, Cylinder, Cone, Sphere, Conic, Torus, Zone>;
TYPED_TEST_SUITE(ShapeArea, Revolved);

// Those that are their profile turned about the axis, at the first and the last placement.
template <class Shape>
std::vector<Shape> round_instances() {
  std::vector<Shape> found, all = instances<Shape>();
  std::size_t const n = all.size() / placements().size();
  all.erase(all.begin() + std::ptrdiff_t(n), all.end() - std::ptrdiff_t(n));
  for (Shape const& s : all) {
    if constexpr (std::is_same_v<Shape, Conic>)
      if (s.decentre() > 0) continue;
    found.push_back(s);
  }
  return found;
}

template <class Shape>
double area_error(Shape const& s, double area) {
  return std::fabs(area / ring_area(s, 0, 1) - 1);
}

TYPED_TEST(ShapeArea, equals_quadrature) {
  for (TypeParam const& s : round_instances<TypeParam>()) {
    EXPECT_LT(area_error(s, s.area()), 2e-5);
    EXPECT_GT(area_error(s, s.area() * 1.001), 2e-5);
  }
}

// 16 rings by 16 sectors, 100,000 points; ring areas come from the quadrature, the sectors are even.
template <class Shape, class Draw>
ChiSquare evenness(Shape const& shape, Draw draw) {
  constexpr int rings = 16, sectors = 16, n = 100000;
  std::vector<double> observed(rings * sectors), expected(rings * sectors);
  for (int i = 0; i < rings; ++i) {
    double const share = ring_area(shape, double(i) / rings, double(i + 1) / rings) / ring_area(shape, 0, 1);
    for (int j = 0; j < sectors; ++j) expected[std::size_t(i * sectors + j)] = n * share / sectors;
  }
  bool const fixed_axis = std::is_same_v<Shape, Sphere>;  // the axis of a sphere has no meaning: any axis will do
  Frame const f = Frame::around(fixed_axis ? Vec3{0, 0, 1} : shape.axis);
  Directions random(6);
  for (int i = 0; i < n; ++i) {
    double const u = random.uniform(), v = random.uniform();
    Vec3 const o = f.to_local(draw(shape, u, v) - shape.reference());
    double const s = position(shape, Axial{o.z, std::hypot(o.x, o.y)}), turn = 0.5 + std::atan2(o.y, o.x) / (2 * pi);
    int const ring = std::clamp(int(s * rings), 0, rings - 1), sector = std::clamp(int(turn * sectors), 0, sectors - 1);
    ++observed[std::size_t(ring * sectors + sector)];
  }
  return chi_square(observed, expected, 100);
}

auto const as_is = [](auto const& shape, double u, double v) { return shape.sample(u, v); };
auto const squared = [](auto const& shape, double u, double v) { return shape.sample(u * u, v); };  // a missing root
auto const lopsided = [](auto const& shape, double u, double v) { return shape.sample(u, v * (0.9 + 0.1 * v)); };

TYPED_TEST(ShapeArea, samples_are_uniform) {
  int const checks = 12 * 8;  // at most 12 instances of 8 shapes
  for (TypeParam const& s : round_instances<TypeParam>()) {
    EXPECT_TRUE(passes(evenness(s, as_is), checks));
    EXPECT_FALSE(passes(evenness(s, squared), checks));
    EXPECT_FALSE(passes(evenness(s, lopsided), checks));
  }
}

}  // namespace
}  // namespace straytrace::testing::geometry_sampling
