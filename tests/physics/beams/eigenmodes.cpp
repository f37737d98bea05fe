// SPDX-License-Identifier: BSD-3-Clause
// Eigenmodes of cavities in space (docs/theory/beams.md, eq. 6.2): linear, folded, astigmatic and twisted
// rings, against eq. 6.3 with the focal lengths of tilted mirrors and against themselves after a round trip.
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "beams/cavity_mode.hpp"
#include "beams/eigenmode.hpp"
#include "beams/overlap.hpp"
#include "support/beams_support.hpp"
#include "support/recorded.hpp"

namespace straytrace::beams_eigenmodes {
namespace {

using testing::axis_flight;
using testing::axis_mirror;
using testing::deviation;
using testing::transformed_q;
using testing::wavefront;

constexpr double nd_yag = 1.064e-6;  // m
// Closed ring over the points; the round trip starts at the first, e1 near `side`.
struct Ring {
  std::vector<Vec3> points;
  std::vector<double> roc;
  Vec3 side{1, 0, 0};

  Mode start() const {
    Vec3 const travel = unit(points[1] - points[0]);
    return elliptic_mode(points[0], unit(side - dot(side, travel) * travel), travel, {1, 1}, {0, 0}, nd_yag);
  }
  std::vector<OpticalElement> elements() const { return mirrors_through(points, roc, true); }
  CavityEigenmode mode() const { return cavity_eigenmode(start(), 1, elements()); }
};

// The mode comes back: overlap 1 - 1e-9 with itself, and the phases of the rays are those of the beam.
void expect_repeats(Ring const& ring, CavityEigenmode const& found) {
  BeamPath const path = follow(found.mode, 1, ring.elements());
  EXPECT_NEAR(power_overlap(path.mode, found.mode), 1, 1e-9);
  EXPECT_NEAR(std::remainder(2 * found.tem00_gouy - found.gouy[0] - found.gouy[1], 2 * pi), 0, 1e-8);
  Mode wrong = found.mode;
  wrong.q11 *= 1.1;
  EXPECT_LT(power_overlap(follow(wrong, 1, ring.elements()).mode, wrong), 1 - 1e-4);
}

// R2.07 in space: two mirrors 3 km apart.
TEST(eigenmode, linear_cavity_is_eq_6_3) {
  for (auto [roc1, roc2] : {std::pair{1420.0, 1683.0}, {1900.0, 1900.0}}) {
    Ring const arm{{{0, 0, 0}, {0, 0, 3000}}, {roc1, roc2}};
    CavityMode const closed = cavity_mode(3000, roc1, roc2, nd_yag);
    CavityEigenmode const found = arm.mode();
    EXPECT_LT(deviation(spot(found.mode).major, closed.w1), 1e-9);
    EXPECT_LT(deviation(spot(follow(found.mode, 1, arm.elements()).arriving[0]).minor, closed.w2), 1e-9);
    EXPECT_LT(deviation(wavefront(found.mode).first, -1 / roc1), 1e-9);
    EXPECT_NEAR(found.tem00_gouy, 2 * closed.gouy, 1e-9);
    EXPECT_NEAR(found.gouy[0], 2 * closed.gouy, 1e-9);
    EXPECT_EQ(found.optical_length, 6000);
    EXPECT_GT(deviation(spot(found.mode).major, cavity_mode(3000, roc1, roc2 + 1, nd_yag).w1), 1e-5);
  }
  EXPECT_NEAR((Ring{{{0, 0, 0}, {0, 0, 3000}}, {1420, 1683}}.mode().tem00_gouy), 2 * 2.77378, 2e-5);
}

// A square of side a with curved mirrors in two opposite corners, met at 45 degrees: in each axis the cavity of two
// mirrors 2a apart with RoC cos(45) in the plane and RoC/cos(45) across it.
Ring square(double a, double roc, Vec3 side) {
  Frame const f = Frame::around(unit({1, 2, 2}));  // anywhere in space
  std::vector<Vec3> points;
  for (Vec3 p : {Vec3{0, 0, 0}, {a, 0, 0}, {a, a, 0}, {0, a, 0}}) points.push_back(f.to_world(p));
  return {points, {roc, infinity, roc, infinity}, f.to_world(side)};
}

TEST(eigenmode, square_ring_is_astigmatic) {
  double const a = 0.5, roc = 2, c = std::sqrt(0.5);
  Ring const ring = square(a, roc, {0, 1, 0});
  CavityEigenmode const found = ring.mode();
  CavityMode const in_plane = cavity_mode(2 * a, roc * c, roc * c, nd_yag),
                   across = cavity_mode(2 * a, roc / c, roc / c, nd_yag);
  double const scale = nd_yag / pi;
  EXPECT_LT(deviation(std::sqrt(scale / found.mode.q11.imag()), in_plane.w1), 1e-10);
  EXPECT_LT(deviation(std::sqrt(scale / found.mode.q22.imag()), across.w1), 1e-10);
  EXPECT_LT(deviation(found.mode.q11.real(), -1 / (roc * c)), 1e-10);
  EXPECT_LT(deviation(found.mode.q22.real(), -c / roc), 1e-10);
  EXPECT_LT(std::abs(found.mode.q12), 1e-12);
  EXPECT_NEAR(found.gouy[0], 2 * in_plane.gouy, 1e-10);
  EXPECT_NEAR(found.gouy[1], 2 * across.gouy, 1e-10);
  EXPECT_NEAR(found.tem00_gouy, in_plane.gouy + across.gouy, 1e-10);
  EXPECT_GT(deviation(std::sqrt(scale / found.mode.q11.imag()), cavity_mode(2 * a, roc, roc, nd_yag).w1),
            0.01);  // no cos
  expect_repeats(ring, found);
}

// The same ring in a frame that is turned about the beam: the axes look coupled, the mode is the same.
TEST(eigenmode, does_not_depend_on_the_frame) {
  CavityEigenmode const straight = square(0.5, 2, {0, 1, 0}).mode();
  Ring const ring = square(0.5, 2, {0, 1, 0.7});
  CavityEigenmode const turned = ring.mode();
  EXPECT_GT(std::abs(turned.mode.q12), 0.1);
  EXPECT_NEAR(power_overlap(straight.mode, turned.mode), 1, 1e-9);
  EXPECT_NEAR(std::min(turned.gouy[0], turned.gouy[1]), std::min(straight.gouy[0], straight.gouy[1]), 1e-9);
  EXPECT_NEAR(std::max(turned.gouy[0], turned.gouy[1]), std::max(straight.gouy[0], straight.gouy[1]), 1e-9);
  EXPECT_NEAR(turned.tem00_gouy, straight.tem00_gouy, 1e-9);
  expect_repeats(ring, turned);
  Mode untwisted = turned.mode;
  untwisted.q12 = 0;
  EXPECT_LT(power_overlap(straight.mode, untwisted), 0.999);
}

// Mode cleaner: two flat mirrors close together and a curved one far away. Odd number of mirrors: a mode that is odd
// in the plane of the ring changes sign, half a free spectral range against the same mode across the plane.
TEST(eigenmode, ring_of_three_mirrors_turns_left_to_right) {
  double const half = 0.25, far = 13.0;
  Ring const ring{{{-half, 0, 0}, {half, 0, 0}, {0, 0, far}}, {infinity, infinity, 37.3}, {0, 0, 1}};
  CavityEigenmode const found = ring.mode();
  double const leg = std::hypot(half, far), round = 2 * (leg + half), c = far / leg;
  auto const one_axis = [&](double roc) {  // from the middle of the short side
    return eigenmode(AxisMatrix(axis_flight(round / 2) * axis_mirror(roc) * axis_flight(round / 2)));
  };
  EXPECT_NEAR(std::remainder(found.gouy[0] - one_axis(37.3 * c).gouy - pi, 2 * pi), 0, 1e-9);
  EXPECT_NEAR(std::remainder(found.gouy[1] - one_axis(37.3 / c).gouy, 2 * pi), 0, 1e-9);
  EXPECT_NEAR(found.tem00_gouy, 0.5 * (one_axis(37.3 * c).gouy + one_axis(37.3 / c).gouy), 1e-9);
  EXPECT_GT(std::fabs(one_axis(37.3 * c).gouy - one_axis(37.3 / c).gouy), 1e-5);  // astigmatic, if little
  EXPECT_LT(deviation(found.mode.q11.imag(), 1 / one_axis(37.3 * c).q.imag()), 1e-3);
  BeamPath const path = follow(found.mode, 1, ring.elements());
  EXPECT_NEAR(power_overlap(path.mode, found.mode), 1, 1e-9);
}

// A ring out of plane turns the image as well: its mode is twisted, spot and wavefront have axes of their own.
TEST(eigenmode, ring_out_of_plane_is_twisted) {
  Ring const ring{{{0, 0, 0}, {0.2, 0, 1}, {0.6, 0.4, 0}, {0, 0.6, 1}}, {6, infinity, 4, infinity}};
  CavityEigenmode const found = ring.mode();
  expect_repeats(ring, found);
  Mode const& m = found.mode;
  auto const twist = [](Mode const& k) {  // of the commutator of Re Q and Im Q
    return std::fabs((k.q11.real() - k.q22.real()) * k.q12.imag() - k.q12.real() * (k.q11.imag() - k.q22.imag())) /
           (std::abs(k.q11) * std::abs(k.q22));
  };
  EXPECT_GT(twist(m), 1e-4);
  EXPECT_LT(twist(square(0.5, 2, {0, 1, 0.7}).mode().mode), 1e-9);
  EXPECT_GT(m.q11.imag() * m.q22.imag() - m.q12.imag() * m.q12.imag(), 0);
  EXPECT_GT(m.q11.imag(), 0);
}

TEST(eigenmode, unstable_rings_are_explained) {
  try {
    square(0.5, 0.5, {0, 1, 0}).mode();
    FAIL() << "no error";
  } catch (NumericalError const& e) {
    EXPECT_NE(std::string(e.what()).find("first axis: half the trace"), std::string::npos) << e.what();
  }
  try {
    square(0.5, 0.5, {0, 1, 0.7}).mode();
    FAIL() << "no error";
  } catch (NumericalError const& e) {
    EXPECT_NE(std::string(e.what()).find("grows by a factor of"), std::string::npos) << e.what();
  }
  Ring const ring = square(0.5, 2, {0, 1, 0});
  auto open = ring.elements();
  open.pop_back();
  EXPECT_THROW(cavity_eigenmode(ring.start(), 1, open), NumericalError);
  EXPECT_NO_THROW(cavity_eigenmode(ring.start(), 1, ring.elements()));
}

// A folded telescope of two mirrors from point to point, ends open: the same by ray matrices of its two axes.
TEST(eigenmode, folded_telescope_by_axes) {
  std::vector<Vec3> const points{{0, 0, 0}, {0, 0, 4}, {1.5, 0, 1}, {1.8, 0, 6}};
  auto const mirrors = mirrors_through(points, std::array{0.0, 5.0, -3.0, 0.0}, false);
  ASSERT_EQ(mirrors.size(), 2u);
  Mode const start = elliptic_mode({}, {1, 0, 0}, {0, 0, 1}, {3e-3, 3e-3}, {0.1, 0.1}, nd_yag);
  BeamPath const path = follow(start, 1, mirrors);
  Mode const end = propagated(path.mode, length(points[3] - points[2]));
  EXPECT_LT(length(end.origin - points[3]), 1e-12);
  auto const cosine = [&](int i) {
    return std::sqrt(0.5 * (1 + dot(unit(points[i - 1] - points[i]), unit(points[i + 1] - points[i]))));
  };
  for (bool in_plane : {true, false}) {
    auto const seen = [&](double roc, int i) { return in_plane ? roc * cosine(i) : roc / cosine(i); };
    AxisMatrix const chain = axis_flight(length(points[3] - points[2])) * axis_mirror(seen(-3, 2)) *
                             axis_flight(length(points[2] - points[1])) * axis_mirror(seen(5, 1)) * axis_flight(4);
    BeamParameter const q = transformed_q(chain, std::conj(1.0 / start.q11));
    auto const found = in_plane ? end.q11 : end.q22, other = in_plane ? end.q22 : end.q11;
    EXPECT_LT(std::abs(found - std::conj(1.0 / q)), 1e-11 * std::abs(found));
    EXPECT_GT(std::abs(other - std::conj(1.0 / q)), 1e-3 * std::abs(found));
  }
}

}  // namespace
}  // namespace straytrace::beams_eigenmodes
