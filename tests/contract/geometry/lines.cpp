// SPDX-License-Identifier: BSD-3-Clause
// Every shape against random lines, isotropic and even in space: their hits lie evenly on any surface, and their number
// is area/(2 pi R^2) per line through a sphere of radius R (Crofton). This ties area, sampling, and the roots of
// distance together without a formula of the shape.
#include <gtest/gtest.h>

#include <algorithm>

#include "contract/geometry/instances.hpp"
#include "support/chi_square.hpp"

namespace straytrace::testing {
namespace {

constexpr int lines = 60000;

template <class Shape>
std::vector<Shape> tilted_instances() {  // the third placement only: other contracts test the rest
  std::vector<Shape> all = instances<Shape>();
  std::size_t const n = all.size() / placements().size();
  return {all.begin() + std::ptrdiff_t(2 * n), all.begin() + std::ptrdiff_t(3 * n)};
}

struct Crossings {
  std::vector<Vec3> points;
  double radius = 0;   // m, of the sphere the lines pass through
  double squares = 0;  // sum of squared counts
};

// `broken`: 0 as it is, 1 loses every second root after the first, 2 forgets where it starts.
template <class Shape>
Crossings cross(Shape const& s, int broken = 0) {
  Directions random(9);
  Box const box = s.bounds();
  Vec3 const middle = 0.5 * (box.lower + box.upper);
  Crossings all{{}, 0.5 * length(box.upper - box.lower), 0};
  for (int i = 0; i < lines; ++i) {
    Vec3 const d = random.direction();
    Frame const f = Frame::around(d);
    double const rho = all.radius * std::sqrt(random.uniform());
    SinCos const a = sincos_turn(random.uniform());
    Ray ray{middle + (rho * a.cos) * f.e1 + (rho * a.sin) * f.e2 - (2 * all.radius) * d, d};
    int count = 0;
    Crossing c = crossing_of(s, ray, false, 0);
    while (c.distance < infinity && count < 50) {
      ++count;
      Vec3 const p = projected_on(s, ray.origin + c.distance * d, c.piece);
      all.points.push_back(p);
      if (broken == 1) break;
      ray.origin = p;
      c = crossing_of(s, ray, broken != 2, c.piece);
    }
    all.squares += count * count;
  }
  return all;
}

// Deviation of the area computed from the crossings, in standard errors.
double deviation(Crossings const& c, double area) {
  double const mean = double(c.points.size()) / lines, spread = std::sqrt((c.squares / lines - mean * mean) / lines);
  return (mean - area / (2 * pi * c.radius * c.radius)) / spread;
}

// Counts of both sets in cells of a box of 6 x 6 x 6.
template <class Draw>
ChiSquare two_sets(Box const& box, std::vector<Vec3> const& hits, Draw const& draw) {
  constexpr int side = 6;
  std::vector<double> one(side * side * side), two(one.size());
  auto const cell = [&](Vec3 p) {
    auto const along = [&](double x, double low, double high) {
      return high - low < 1e-9 ? 0 : std::clamp(int(side * (x - low) / (high - low)), 0, side - 1);
    };
    return std::size_t((along(p.x, box.lower.x, box.upper.x) * side + along(p.y, box.lower.y, box.upper.y)) * side +
                       along(p.z, box.lower.z, box.upper.z));
  };
  for (Vec3 p : hits) ++one[cell(p)];
  int const n = 60000;
  for (int i = 0; i < n; ++i) ++two[cell(draw())];
  ChiSquare c;
  double const k = std::sqrt(double(n) / double(hits.size()));
  for (std::size_t i = 0; i < one.size(); ++i) {
    if (one[i] + two[i] < 10) continue;
    c.statistic += std::pow(k * one[i] - two[i] / k, 2) / (one[i] + two[i]);
    ++c.dof;
  }
  c.p = chi_square_tail(c.statistic, --c.dof);
  return c;
}

template <class T>
class ShapeLines : public ::testing::Test {};
TYPED_TEST_SUITE(ShapeLines, AllShapes);

int const checks = 8 * 16 * 2;                                          // at most 8 instances of 16 shapes
bool seen_often(Crossings const& c) { return c.points.size() > 2000; }  // not so for long thin shapes

TYPED_TEST(ShapeLines, count_the_area) {  // 5 standard errors
  int counted = 0;
  for (TypeParam const& s : tilted_instances<TypeParam>()) {
    Crossings const c = cross(s);
    if (!seen_often(c)) continue;
    ++counted;
    EXPECT_LT(std::fabs(deviation(c, s.area())), 5) << TypeParam::key << " of " << s.area() << " m^2";
    EXPECT_GT(std::fabs(deviation(c, 1.15 * s.area())), 5);
    EXPECT_GT(std::fabs(deviation(c, 0.85 * s.area())), 5);
  }
  EXPECT_GT(counted, 0);
}

TYPED_TEST(ShapeLines, lie_as_evenly_as_samples) {
  for (TypeParam const& s : tilted_instances<TypeParam>()) {
    Crossings const c = cross(s);
    if (!seen_often(c)) continue;
    Directions random(10);
    auto const even = [&] { return random.point(s).point; };
    auto const uneven = [&] {
      double const u = random.uniform(), v = random.uniform();
      return sample_of(s, u * u * u, v * v * v).point;
    };
    EXPECT_TRUE(passes(two_sets(s.bounds(), c.points, even), checks)) << TypeParam::key << " of " << s.area() << " m^2";
    EXPECT_FALSE(passes(two_sets(s.bounds(), c.points, uneven), checks));
  }
}

// Controls: a shape that has lost its far roots, and one that hits itself where it starts.
TEST(shape_lines, lost_and_invented_roots_are_found) {
  Torus const ring = tilted_instances<Torus>()[0];
  EXPECT_GT(std::fabs(deviation(cross(ring, 1), ring.area())), 5);
  EXPECT_GT(std::fabs(deviation(cross(ring, 2), ring.area())), 5);
  Cuboid const box = tilted_instances<Cuboid>()[0];
  EXPECT_GT(std::fabs(deviation(cross(box, 1), box.area())), 5);
}

}  // namespace
}  // namespace straytrace::testing
