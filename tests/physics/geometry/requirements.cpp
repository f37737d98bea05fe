// SPDX-License-Identifier: BSD-3-Clause
// Reference numbers of the shapes beyond disk, cap, cylinder, cone and sphere (those are in
// tests/unit/geometry/numbers.cpp), each with a variant that must miss them.
#include <gtest/gtest.h>

#include "base/math/rng.hpp"
#include "geometry/shape_types.hpp"
#include "support/shapes.hpp"

namespace straytrace {
namespace {

using namespace testing;

// R3.14: hole on +x: a ray to +x passes, a ray to -x hits. The control drills through both walls.
TEST(GeometryRequirements, HoleOnOneSideR3_14) {
  PiercedCylinder const wall = pierced(0.5, 0, 2, 0.1, 1);
  EXPECT_EQ(wall.distance({{0, 0, 1}, {1, 0, 0}}, false), infinity);
  EXPECT_NEAR(wall.distance({{0, 0, 1}, {-1, 0, 0}}, false), 0.5, 1e-15);
  EXPECT_NEAR(wall.distance({{0, 0, 1.11}, {1, 0, 0}}, false), 0.5, 1e-15);
  EXPECT_EQ(wall.distance({{0, 0, 1.09}, {1, 0, 0}}, false), infinity);
  EXPECT_NEAR(wall.distance({{1, 0, 1}, {-1, 0, 0}}, false), 1.5, 1e-15);  // in by the hole, onto the other wall
  EXPECT_EQ(pierced(0.5, 0, 2, 0.1, 1, 2).distance({{0, 0, 1}, {-1, 0, 0}}, false), infinity);
}

// Area of a hole: series of 2 R asin(x/R) = 2x + x^3/(3 R^2) + ..., so pi a^2 (1 + a^2/(8 R^2) + ...).
TEST(GeometryRequirements, AreaOfAPiercedWall) {
  double const a = 0.01, r = 0.5, gone = 2 * pi * r * 2 - pierced(r, 0, 2, a, 1).area();
  EXPECT_NEAR(gone / (pi * a * a * (1 + a * a / (8 * r * r))), 1, 1e-7);
  EXPECT_GT(std::fabs(gone / (pi * a * a) - 1), 1e-5);  // control: the flat disk
}

// R3.15, rectangle and apertures: edges to 1e-4 m.
TEST(GeometryRequirements, EdgesOfPlatesR3_15) {
  auto const hit = [](auto const& s, double x, double y) { return s.distance({{x, y, -1}, {0, 0, 1}}, false) == 1; };
  Rectangle const frame = rectangle(0.8, 0.6, 0.4, 0.2);
  EXPECT_TRUE(hit(frame, 0.3999, 0) && !hit(frame, 0.4001, 0) && hit(frame, 0, 0.2999) && !hit(frame, 0, 0.3001));
  EXPECT_TRUE(hit(frame, 0.2001, 0) && !hit(frame, 0.1999, 0) && hit(frame, 0.1999, 0.1001) &&
              !hit(frame, 0.19, 0.0999));
  Ellipse const iris = ellipse(0.4, 0.4, 0.3, 0.1);
  EXPECT_TRUE(hit(iris, 0.3001, 0) && !hit(iris, 0.2999, 0) && hit(iris, 0, 0.1001) && !hit(iris, 0, 0.0999));
  EXPECT_TRUE(hit(iris, 0, -0.3999) && !hit(iris, 0, -0.4001));
  Polygon const blades = [] {
    Polygon s;
    s.sides = 6;
    s.radius = 1;
    s.place({});
    return s;
  }();
  double const apothem = std::sqrt(0.75);  // at 30 degrees from a corner
  EXPECT_TRUE(hit(blades, 0.9999, 0) && !hit(blades, 1.0001, 0));
  EXPECT_TRUE(hit(blades, 0, apothem - 1e-4) && !hit(blades, 0, apothem + 1e-4));
  EXPECT_FALSE(hit(blades, 0.9999 * std::cos(0.5), 0.9999 * std::sin(0.5)));  // inside the circle, beyond the side
}

// R3.17: unit box about the origin: t = 0.5 from the centre; through the box: in and out; the face is known.
TEST(GeometryRequirements, BoxR3_17) {
  Cuboid const box = cuboid(1, 1, 1);
  for (std::uint32_t face = 0; face < 6; ++face) {
    Vec3 const n = box.normal({}, face);
    Crossing const c = box.crossing({{0, 0, 0}, n}, no_piece);
    EXPECT_EQ(c.distance, 0.5);
    EXPECT_EQ(c.piece, face);
    Crossing const in = box.crossing({2 * n, -n}, no_piece);
    EXPECT_TRUE(in.distance == 1.5 && in.piece == face);
    Crossing const out = box.crossing({0.5 * n, -n}, face);
    EXPECT_TRUE(out.distance == 1 && out.piece == (face ^ 1));
    EXPECT_EQ(box.crossing({0.5 * n, n}, face).distance, infinity);
    EXPECT_GT(dot(n, box.project({0.1, 0.2, 0.3}, face)), 0.5 - 1e-15);
  }
  EXPECT_NE(cuboid(1.001, 1.001, 1.001).crossing({{0, 0, 0}, {1, 0, 0}}, no_piece).distance, 0.5);
}

// Largest distance from the focus at which lines parallel to the axis pass it after reflection.
double blur(Conic const& mirror, double focus) {
  Rng rng(1, 0, 0, Stream::source);
  double most = 0;
  for (int i = 0; i < 2000; ++i) {
    double const rho = mirror.outer_radius * std::sqrt(rng.uniform()), angle = 2 * pi * rng.uniform();
    Ray const ray{{mirror.decentre_x + rho * std::cos(angle), rho * std::sin(angle), 10}, {0, 0, -1}};
    Vec3 const p = ray.origin + mirror.distance(ray, false) * ray.dir, d = reflected(ray.dir, mirror.normal(p));
    Vec3 const to_focus = Vec3{0, 0, focus} - p;
    double const miss = length(to_focus - dot(to_focus, d) * d);
    if (!(miss <= most)) most = miss;  // a ray that finds no mirror counts as lost: NaN
    if (std::isnan(miss)) return miss;
  }
  return most;
}

// R3.19: parabola f = 0.5 m: all parallel rays meet at the focus to 1e-12 m, on axis and off.
TEST(GeometryRequirements, ParabolaR3_19) {
  EXPECT_LT(blur(conic(1, -1, 0, 0.8), 0.5), 1e-12);
  EXPECT_LT(blur(conic(1, -1, 0, 0.3, 0.9), 0.5), 1e-12);
  EXPECT_GT(blur(conic(1, -0.99, 0, 0.8), 0.5), 1e-4);
  EXPECT_GT(blur(asphere(conic(1, -1, 0, 0.8), 1e-4), 0.5), 1e-5);
}

// An ellipse sends light from one focus to the other: foci at (1 -+ e)/(c q), q = 1 + k = 1 - e^2.
TEST(GeometryRequirements, EllipsoidHasTwoFoci) {
  Conic const mirror = conic(1, -0.36, 0, 0.6);
  double const e = 0.6, q = 1 - e * e;
  double most = 0;
  for (int i = 1; i < 200; ++i) {
    double const rho = 0.6 * i / 200;
    Vec3 const p{rho, 0, mirror.sag(rho * rho)}, from = Vec3{0, 0, (1 - e) / q};
    Vec3 const d = reflected(unit(p - from), mirror.normal(p)), to = Vec3{0, 0, (1 + e) / q} - p;
    most = std::fmax(most, length(to - dot(to, d) * d));
  }
  EXPECT_LT(most, 1e-14);
  Conic const other = conic(1, -0.35, 0, 0.6);
  Vec3 const p{0.4, 0, other.sag(0.16)}, d = reflected(unit(p - Vec3{0, 0, (1 - e) / q}), other.normal(p));
  Vec3 const to = Vec3{0, 0, (1 + e) / q} - p;
  EXPECT_GT(length(to - dot(to, d) * d), 1e-4);
}

// Area of a paraboloid, closed form 2 pi/(3 c^2) ((1 + c^2 r^2)^(3/2) - 1); off axis against sums over fine cells.
TEST(GeometryRequirements, AreaOfAParaboloid) {
  EXPECT_NEAR(conic(1, -1, 0, 0.8).area() / (2 * pi / 3 * (std::pow(1.64, 1.5) - 1)), 1, 1e-13);
  Conic const mirror = conic(0.5, -1, 0.1, 0.3, 0.7);
  double sum = 0;
  int const n = 1500;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      double const rho = 0.1 + 0.2 * (i + 0.5) / n, angle = 2 * pi * (j + 0.5) / n;
      double const x = 0.7 + rho * std::cos(angle), y = rho * std::sin(angle);
      sum += std::sqrt(1 + 0.25 * (x * x + y * y)) * rho * 0.2 / n * 2 * pi / n;
    }
  EXPECT_NEAR(mirror.area() / sum, 1, 1e-7);
  EXPECT_GT(std::fabs(mirror.area() / (pi * 0.08) - 1), 0.01);  // control: the flat ring
}

// R3.20 for the box: 1e6 bounces inside, every one on another face. The control forgets the face it starts on.
TEST(GeometryRequirements, NoSelfHitsInABoxR3_20) {
  auto const self_hits = [](bool know_face, int bounces) {
    Cuboid const box = cuboid(1, 2, 3, {{5, -3, 3000}, unit({0.1, 0.2, 0.9})});
    Rng rng(1, 0, 0, Stream::direction);
    SurfacePoint at = box.sample(0.3, 0.4);
    int wrong = 0;
    for (int i = 0; i < bounces; ++i) {
      double const z = std::sqrt(1 - rng.uniform()), r = std::sqrt(1 - z * z);
      SinCos const a = sincos_turn(rng.uniform());
      Vec3 const d = Frame::around(-box.normal({}, at.piece)).to_world({r * a.cos, r * a.sin, z});
      Crossing const c = box.crossing({at.point, d}, know_face ? at.piece : no_piece);
      wrong += c.distance == infinity || c.piece == at.piece;
      if (c.distance < infinity) at = {box.project(at.point + c.distance * d, c.piece), c.piece};
    }
    return wrong;
  };
  EXPECT_EQ(self_hits(true, 1000000), 0);
  EXPECT_GT(self_hits(false, 10000), 100);
}

// Lines through points of the edges of a box, to rounding: it is left as often as it is entered. The control takes the
// faces as six rectangles.
TEST(GeometryRequirements, BoxIsWatertightAtItsEdges) {
  Cuboid const box = cuboid(1, 2, 3, {{5, -3, 300}, unit({0.1, 0.2, 0.9})});
  Rng rng(3, 0, 0, Stream::direction);
  int odd = 0, control = 0, touched = 0;
  for (int i = 0; i < 200000; ++i) {
    Vec3 const edge = box.centre + 0.5 * box.e1 + box.e2 + (3 * rng.uniform() - 1.5) * box.axis;
    double const z = 2 * rng.uniform() - 1, r = std::sqrt(1 - z * z);
    SinCos const a = sincos_turn(rng.uniform());
    Vec3 const d{r * a.cos, r * a.sin, z};
    Ray const ray{edge - 10.0 * d, d};
    int crossings = 0;
    Crossing c = box.crossing(ray, no_piece);
    Vec3 at = ray.origin;
    for (; c.distance < infinity && crossings < 5; ++crossings) {
      at = box.project(at + c.distance * d, c.piece);
      c = box.crossing({at, d}, c.piece);
    }
    odd += crossings % 2;
    touched += crossings > 0;
    int faces = 0;
    for (std::uint32_t face = 0; face < 6; ++face) {
      Vec3 const n = box.normal({}, face), size{box.width, box.height, box.depth};
      std::uint32_t const i0 = face / 2;
      Vec3 const e[3] = {box.e1, box.e2, box.axis};
      double const sizes[3] = {size.x, size.y, size.z},
                   t = (0.5 * sizes[i0] - dot(ray.origin - box.centre, n)) / dot(d, n);
      Vec3 const p = ray.origin + t * d - box.centre;
      faces += std::fabs(dot(p, e[(i0 + 1) % 3])) < 0.5 * sizes[(i0 + 1) % 3] &&
               std::fabs(dot(p, e[(i0 + 2) % 3])) < 0.5 * sizes[(i0 + 2) % 3];
    }
    control += faces % 2;
  }
  EXPECT_EQ(odd, 0);
  EXPECT_GT(touched, 100000);
  EXPECT_GT(control, 0);
}

TEST(GeometryRequirements, ImpossibleShapesAreErrors) {
  auto const rejected = [](auto const& s) { return !impossible(s).what.empty() && !impossible(s).suggestion.empty(); };
  EXPECT_TRUE(rejected(torus(1, 1)) && rejected(torus(1, 1e-5)) && !rejected(torus(1, 0.9)));
  EXPECT_TRUE(rejected(zone(1, 0.5, 0.4)) && rejected(zone(1, 0, 1.1)) && !rejected(zone(1, -1, 1)));
  EXPECT_TRUE(rejected(rectangle(1, 1, 0.5, 0)) && rejected(rectangle(1, 1, 2, 0.5)) &&
              !rejected(rectangle(1, 1, 1, 0.5)));
  EXPECT_TRUE(rejected(ellipse(1, 0.5, 0.6, 0.6)) && !rejected(ellipse(1, 0.5, 0.6, 0.4)));
  EXPECT_TRUE(rejected(polygon(2, 1)) && rejected(polygon(5.5, 1)) && rejected(polygon(4, 1, 0, 0.8)));
  EXPECT_TRUE(!rejected(polygon(4, 1, 0, 0.7)) && !rejected(polygon(6, 1, 6, 0.99)) &&
              rejected(polygon(6, 1, 4, 0.99)));
  EXPECT_TRUE(rejected(conic(1, 0, 0, 1)) && rejected(conic(1, -1, 0.5, 0.4)) && !rejected(conic(1, -1, 0, 20)));
  EXPECT_TRUE(rejected(asphere(conic(0, 0, 0, 0.5), 1e6)) && !rejected(asphere(conic(0, 0, 0, 0.5), 1)));
  EXPECT_TRUE(rejected(pierced(1, 0, 1, 0.6, 0.5)) && rejected(pierced(1, 0, 2, 0.6, 1, 6)));
  EXPECT_TRUE(rejected(serrated(0.4, 0.5, 0.5, 0.2, 10)) && rejected(serrated(0.4, 0.5, pi / 2 - 1e-5, 0.02, 10)));
  EXPECT_TRUE(!rejected(serrated(0.4, 0.5, pi / 2, 0.02, 10)) && rejected(cut_cylinder(1, 0, 0.5, 0.8)));
}

}  // namespace
}  // namespace straytrace
