// SPDX-License-Identifier: BSD-3-Clause
// The closed ray of a cavity (docs/theory/beams.md): against the closed form of two tilted mirrors (eq. W.23), against
// the law of reflection, and in a ring.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "beams/cavity_mode.hpp"
#include "beams/eigenmode.hpp"
#include "support/recorded.hpp"

namespace straytrace::beams_closed_axes {
namespace {

using testing::deviation;

constexpr double nd_yag_light = 1.064e-6;  // m

SphericalMirror facing(Vec3 vertex, Vec3 towards, double roc) { return {vertex, unit(towards - vertex), 1 / roc}; }

// The input mode cleaner of LIGO: 0.4648 m between two flat mirrors, 32.9461 m around, RoC 27.24 m on the third.
std::vector<SphericalMirror> mode_cleaner(double tilt = 0) {
  double const half = 0.2324, side = (32.9461 - 2 * half) / 2;
  Vec3 const one{half, 0, 0}, two{0, 0, std::sqrt(side * side - half * half)}, three{-half, 0, 0};
  auto const between = [](Vec3 here, Vec3 a, Vec3 b) { return unit(unit(a - here) + unit(b - here)); };
  Vec3 const normal = unit(between(two, one, three) + Vec3{0, tilt, 0});
  return {{one, between(one, two, three), 0}, {two, normal, 1 / 27.24}, {three, between(three, one, two), 0}};
}

void expect_reflects(std::vector<SphericalMirror> const& mirrors, std::vector<Vec3> const& points) {
  std::size_t const n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    SphericalMirror const& m = mirrors[i];
    Vec3 const p = points[i] - m.vertex, normal = unit(m.axis - m.curvature * p);
    EXPECT_NEAR(m.curvature * dot(p, p), 2 * dot(p, m.axis), 1e-12);  // on the mirror
    Vec3 const in = unit(points[i] - points[(i + n - 1) % n]), out = unit(points[(i + 1) % n] - points[i]);
    EXPECT_LT(length(out - (in - 2 * dot(in, normal) * normal)), 1e-11);
  }
}

TEST(closed_axis, TwoTiltedMirrorsAreEqW23) {
  double const L = 1000, tilt = 1e-6, g1 = 1 - L / 1420, g2 = 1 - L / 1683;
  std::vector<SphericalMirror> mirrors{facing({0, 0, 0}, {0, 0, L}, 1420), facing({0, 0, L}, {0, 0, 0}, 1683)};
  mirrors[1].axis = unit(mirrors[1].axis + Vec3{tilt, 0, 0});
  std::vector<Vec3> const points = closed_axis(mirrors);
  EXPECT_LT(deviation(points[0].x, L * tilt / (1 - g1 * g2)), 1e-6);
  EXPECT_LT(deviation(points[1].x, L * tilt * g1 / (1 - g1 * g2)), 1e-6);
  EXPECT_NEAR(points[0].y, 0, 1e-12);
  expect_reflects(mirrors, points);
}

TEST(closed_axis, ModeCleanerHasItsPublishedMode) {
  ClosedCavity const cavity = closed_cavity(mode_cleaner(), nd_yag_light);
  EXPECT_LT(deviation(cavity.length, 32.9461), 1e-12);
  // Half the way, from the waist between the flat mirrors to the curved one, is a cavity of two mirrors with RoC cos
  // theta in the plane of incidence and RoC/cos theta across it; left and right are exchanged.
  std::vector<SphericalMirror> const mirrors = mode_cleaner();
  double const cosine = -dot(cavity.arriving[1].travel, mirrors[1].axis);
  CavityMode const along = cavity_mode(cavity.length / 2, infinity, 27.24 * cosine, nd_yag_light),
                   across = cavity_mode(cavity.length / 2, infinity, 27.24 / cosine, nd_yag_light);
  EXPECT_NEAR(std::remainder(cavity.gouy[0] - 2 * along.gouy - pi, 2 * pi), 0, 1e-9);
  EXPECT_NEAR(std::remainder(cavity.gouy[1] - 2 * across.gouy, 2 * pi), 0, 1e-9);
  EXPECT_GT(std::fabs(along.gouy - across.gouy), 1e-5);
  EXPECT_LT(deviation(spot(cavity.arriving[1]).major, std::fmax(along.w2, across.w2)), 1e-9);
  EXPECT_LT(deviation(spot(cavity.arriving[1]).minor, std::fmin(along.w2, across.w2)), 1e-9);
  EXPECT_LT(deviation(across.w2, 3.4e-3), 0.02);  // as published
  EXPECT_NEAR(std::acos(-dot(cavity.arriving[0].travel, mirrors[0].axis)) * 180 / pi, 44.59, 0.01);
  EXPECT_EQ(cavity.out_of_plane, 0);
}

// A curved mirror that nods moves the axis over it; the path by way of the flat ones comes back at another height.
TEST(closed_axis, MisalignedRing) {
  double const tilt = 1e-5;
  std::vector<SphericalMirror> const mirrors = mode_cleaner(tilt);
  std::vector<Vec3> const points = closed_axis(mirrors);
  expect_reflects(mirrors, points);
  // Vertical: a plane ring of one curved mirror, RoC/cos(incidence). Normal to the axis there: y = -RoC tilt.
  EXPECT_LT(deviation(std::fabs(points[1].y), 27.24 * tilt), 1e-3);
  ClosedCavity const cavity = closed_cavity(mirrors, nd_yag_light);
  EXPECT_LT(cavity.out_of_plane, 1e-4);
}

TEST(closed_axis, RefusesWhatHasNone) {
  std::vector<SphericalMirror> const flat{facing({0, 0, 0}, {0, 0, 1}, infinity),
                                          facing({0, 0, 1}, {0, 0, 0}, infinity)};
  EXPECT_THROW(closed_axis(flat), NumericalError);
  std::vector<SphericalMirror> turned = mode_cleaner();
  turned[1].axis = {0, 1, 0};
  EXPECT_THROW(closed_axis(turned), NumericalError);
  std::vector<SphericalMirror> convex = mode_cleaner();
  convex[1].curvature = -convex[1].curvature;
  EXPECT_THROW(closed_cavity(convex, nd_yag_light), NumericalError);
}

}  // namespace
}  // namespace straytrace::beams_closed_axes
