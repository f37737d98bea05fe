// SPDX-License-Identifier: BSD-3-Clause
// Shapes with more than two roots against root isolation in long double: no root is lost, none is invented.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/math/rng.hpp"
#include "support/shapes.hpp"

namespace straytrace {
namespace {

using namespace testing;

// Sign changes of the implicit function on a fine grid, refined by bisection, in long double: every root that is not
// closer to the next one than two grid steps.
template <class F>
std::vector<double> isolated_roots(F const& f, long double from, long double to, int steps) {
  std::vector<double> roots;
  long double last = f(from);
  for (int i = 1; i <= steps; ++i) {
    long double a = from + (to - from) * (i - 1) / steps, b = from + (to - from) * i / steps;
    long double const next = f(b);
    if ((last < 0) != (next < 0)) {
      for (int k = 0; k < 64; ++k) {
        long double const m = (a + b) / 2;
        ((f(m) < 0) == (last < 0) ? a : b) = m;
      }
      roots.push_back(double(a));
    }
    last = next;
  }
  return roots;
}

// All hits along a ray, from one to the next.
template <class Shape>
std::vector<double> walk(Shape const& s, Ray ray) {
  std::vector<double> found;
  double at = 0, t = s.distance(ray, false);
  while (t < infinity && found.size() < 20) {
    at += t;
    found.push_back(at);
    ray.origin = s.project(ray.origin + t * ray.dir);
    t = s.distance(ray, true);
  }
  return found;
}

// Number of rays whose hits differ from the isolated roots by more than `tolerance`, or in number. Roots closer
// together than the grid sees are pairs that both sides may have or not.
template <class Shape, class F>
int disagreements(Shape const& s, F const& implicit, int rays, double size, double tolerance) {
  Rng rng(2, 0, 0, Stream::direction);
  auto const ball = [&] {
    double const z = 2 * rng.uniform() - 1, r = std::sqrt(1 - z * z), a = 2 * pi * rng.uniform();
    return Vec3{r * std::cos(a), r * std::sin(a), z};
  };
  int wrong = 0;
  int const steps = 4000;
  for (int i = 0; i < rays; ++i) {
    Vec3 const d = ball();
    Ray const ray{size * rng.uniform() * ball() - (2 * size) * d, d};
    auto const f = [&](long double t) {
      return implicit(ray.origin.x + t * d.x, ray.origin.y + t * d.y, ray.origin.z + t * d.z);
    };
    std::vector<double> const wanted = isolated_roots(f, 0.0L, 4.0L * size, steps);
    std::vector<double> found = walk(s, ray);
    for (std::size_t k = 0; k + 1 < found.size();)  // pairs between two grid points
      if (found[k + 1] - found[k] < 4 * size / steps && wanted.size() < found.size())
        found.erase(found.begin() + std::ptrdiff_t(k), found.begin() + std::ptrdiff_t(k) + 2);
      else
        ++k;
    bool same = found.size() == wanted.size();
    for (std::size_t k = 0; same && k < found.size(); ++k) same = std::fabs(found[k] - wanted[k]) < tolerance;
    wrong += !same;
  }
  return wrong;
}

TEST(GeometryRoots, TorusRootsAgainstIsolation) {
  for (double minor : {0.3, 0.9, 0.02}) {
    auto const implicit = [](double tube) {
      return [tube](long double x, long double y, long double z) {
        long double const off = std::sqrt(x * x + y * y) - 1;
        return off * off + z * z - (long double)tube * tube;
      };
    };
    EXPECT_EQ(disagreements(torus(1, minor), implicit(minor), 1500, 1 + minor, 1e-9), 0) << minor;
    EXPECT_GT(disagreements(torus(1, minor), implicit(1.001 * minor), 300, 1 + minor, 1e-9), 0);
  }
}

// Lines that touch the tube from within a hair: the pair of roots exists or not, depending on the height.
TEST(GeometryRoots, TorusGrazing) {
  Torus const ring = torus(1, 0.3);
  for (double gap : {1e-3, 1e-6, 1e-9, 1e-12}) {
    Ray const above{{-3, 0, 0.3 + gap}, {1, 0, 0}}, below{{-3, 0, 0.3 - gap}, {1, 0, 0}};
    EXPECT_EQ(walk(ring, above).size(), 0u) << gap;
    EXPECT_EQ(walk(ring, below).size(), 4u) << gap;  // over the top of both sections of the tube
    Ray const hole{{0.7 - gap, 0, -3}, {0, 0, 1}}, inside{{0.7 + gap, 0, -3}, {0, 0, 1}};
    EXPECT_EQ(walk(ring, hole).size(), 0u) << gap;
    EXPECT_EQ(walk(ring, inside).size(), 2u) << gap;
  }
}

TEST(GeometryRoots, AsphereRootsAgainstIsolation) {
  Conic const wavy = asphere(conic(1, -0.5, 0, 0.5), -8, 40, -50, 0);
  auto const implicit = [&](double a4) {
    return [=](long double x, long double y, long double z) {
      long double const w = x * x + y * y;
      long double const s = w / (1 + std::sqrt(1 - 0.5L * w)) + w * w * (a4 + w * (40 - w * 50));
      return z - s;
    };
  };
  Rng rng(5, 0, 0, Stream::direction);
  int wrong = 0, control = 0, several = 0;
  for (int i = 0; i < 3000; ++i) {
    Vec3 const through{0.4 * (rng.uniform() - 0.5), 0.4 * (rng.uniform() - 0.5), 0.02 * rng.uniform()};
    Vec3 const d = unit({rng.uniform() - 0.5, rng.uniform() - 0.5, 0.05 * (rng.uniform() - 0.5)});
    Ray const ray{through - 2.0 * d, d};
    double const b = through.x * d.x + through.y * d.y, a = d.x * d.x + d.y * d.y;
    double const rim = std::sqrt(b * b - a * (through.x * through.x + through.y * through.y - 0.25));
    auto const roots = [&](double a4) {
      auto const f = [&](long double t) {
        return implicit(a4)(ray.origin.x + t * d.x, ray.origin.y + t * d.y, ray.origin.z + t * d.z);
      };
      return isolated_roots(f, 2 + (-b - rim) / a + 1e-9, 2 + (-b + rim) / a - 1e-9, 4000);
    };
    std::vector<double> const found = walk(wavy, ray), wanted = roots(-8);
    several += wanted.size() > 2;
    auto const differ = [&](std::vector<double> const& x) {
      bool same = x.size() == found.size();
      for (std::size_t k = 0; same && k < x.size(); ++k) same = std::fabs(x[k] - found[k]) < 1e-9;
      return !same;
    };
    wrong += differ(wanted);
    control += differ(roots(-8.01));
  }
  EXPECT_LE(wrong, 1);  // a pair of roots between two points of the grid
  EXPECT_GT(several, 50);
  EXPECT_GT(control, 1000);
}

}  // namespace
}  // namespace straytrace
