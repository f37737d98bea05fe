// SPDX-License-Identifier: BSD-3-Clause
// Rims that move in the main beam: docs/theory/diffraction.md, eq. N.11 and N.21.
#include "trace/deterministic/moving_rims.hpp"

#include <boost/math/special_functions/bessel.hpp>
#include <gtest/gtest.h>

#include <cmath>

#include "support/ghost_support.hpp"
#include "support/recorded.hpp"
#include "support/shapes.hpp"

namespace straytrace::testing::moving_rims {
namespace {

using Round = world::BeamAperture::Round;

constexpr double w = 1e-3, a = 1.2e-3, d = 0.5e-3;  // m

// A hole across a beam along z, its centre off the axis by `offset` along x; pivot at `lever` below along y.
Round hole(double offset, double radius = a, double at = 0) {
  Mode const waist = circular_mode({}, {0, 0, 1}, w, 0, lambda);
  return {{offset, 0, at}, {0, 0, 1}, radius, 0, waist};
}

// Eq. N.11.
double slope_of(double radius, double offset) {
  return -4 * radius / (w * w) * std::exp(-2 * (radius * radius + offset * offset) / (w * w)) *
         boost::math::cyl_bessel_i(1, 4 * radius * offset / (w * w));
}

TEST(MovingRims, passed_field_and_its_slope) {
  RimDerivatives const found = rim_derivatives(hole(d), {});
  EXPECT_NEAR(1 - found.removed, 0.8557401455, 1e-10);
  EXPECT_NEAR(found.slope[0] / -375.57728, 1, 1e-7);
  EXPECT_NEAR(found.slope[0] / slope_of(a, d), 1, 1e-7);
  EXPECT_LT(std::fabs(found.slope[1]), 1e-4);
  EXPECT_GT(std::fabs(found.slope[0] / slope_of(a, 1.01 * d) - 1), 1e-3) << "control: another offset";
  EXPECT_GT(rim_derivatives(hole(-d), {}).slope[0], 375) << "control: towards the beam more passes";
}

// d^2 K_00/dx^2 of a centred hole: the limit of eq. N.11 over the offset, -(8 a^2/w^4) exp(-2 a^2/w^2).
TEST(MovingRims, centred_hole) {
  RimDerivatives const found = rim_derivatives(hole(0), {});
  double const curvature = -8 * a * a / std::pow(w, 4) * std::exp(-2 * a * a / (w * w));
  for (int i : {0, 1}) {
    EXPECT_LT(std::fabs(found.slope[i]), 1e-5 * 375);
    EXPECT_NEAR(found.curvature(i, i) / curvature, 1, 1e-6);
  }
  EXPECT_LT(std::fabs(found.curvature(0, 1)), 1e-5 * std::fabs(curvature));
  EXPECT_NEAR(slope_of(a, 1e-8) / 1e-8 / curvature, 1, 1e-6);
}

// Along the beam the radius changes: dK_00/dz = -(4 a^2/w^3) exp(-2 a^2/w^2) dw/dz, also for a centred hole.
TEST(MovingRims, along_a_beam_that_diverges) {
  double const reach = pi * w * w / lambda, z = 2 * reach;
  double const there = w * std::sqrt(5), steep = w / reach * 2 / std::sqrt(5);
  double const radius = 1.2 * there;
  RimDerivatives const found = rim_derivatives(hole(0, radius, z), {});
  double const closed = -4 * radius * radius / std::pow(there, 3) * std::exp(-2 * 1.44) * steep;
  EXPECT_NEAR(found.slope[2] / closed, 1, 1e-6);
  EXPECT_LT(std::fabs(rim_derivatives(hole(0), {}).slope[2]), 1e-6) << "control: at the waist";
}

// A rotation about a pivot below the hole moves it sideways by the lever; the tilt itself counts to second order.
TEST(MovingRims, rotation_about_a_pivot) {
  double const lever = 0.4;
  RimDerivatives const found = rim_derivatives(hole(d), {d, -lever, 0});
  EXPECT_NEAR(found.slope[5] / (-lever * found.slope[0]), 1, 1e-6);
  EXPECT_LT(std::fabs(found.slope[3]), 1e-6);
}

using Flat = world::BeamAperture::Flat;

// A plate across a beam along z, and the beam at the plate.
Flat plate(world::Outline const& outer, Vec3 centre, Mode const& mode) {
  return {{centre, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, outer, {}, false}, mode, true};
}
world::Outline box(double half_x, double half_y) { return {half_x, half_y, 4, 0, 0, true}; }
Mode waist() { return circular_mode({}, {0, 0, 1}, w, 0, lambda); }

// Eq. N.21, a straight edge at d: K_00 = (1 + erf(sqrt 2 d/w))/2, dK_00/dd = sqrt(2/pi)/w exp(-2 d^2/w^2).
TEST(MovingRims, straight_edge) {
  double const half = 10 * w;
  for (double const at : {-0.4 * w, 0.0, 0.1 * w, 1.5 * w, 3.5 * w}) {
    RimDerivatives const found = rim_derivatives(plate(box(half, half), {half + at, 0, 0}, waist()), {});
    double const closed = std::sqrt(2 / pi) / w * std::exp(-2 * at * at / (w * w));
    EXPECT_NEAR(found.removed / (0.5 * std::erfc(std::sqrt(2) * at / w)), 1, 1e-6) << at;
    EXPECT_NEAR(found.slope[0] / closed, 1, 1e-9) << at;
    double const bent = -4 * at / (w * w) * closed;
    EXPECT_NEAR(found.curvature(0, 0), bent, 1e-6 * closed / w + 1e-5 * std::fabs(bent)) << at;
    EXPECT_LT(std::fabs(found.slope[1]), 1e-9 * closed) << at;
  }
  RimDerivatives const left = rim_derivatives(plate(box(half, half), {-half - 1.5 * w, 0, 0}, waist()), {});
  EXPECT_LT(left.slope[0], 0) << "control: the edge on the other side";
}

// A rectangular hole is a product of two slits; K_00 = erf(sqrt 2 a/w) erf(sqrt 2 b/w) in the middle.
TEST(MovingRims, rectangular_hole) {
  double const half_x = 1.1 * w, half_y = 1.4 * w, off = 0.2 * w;
  Flat frame = plate(box(20 * w, 20 * w), {off, 0, 0}, waist());
  frame.rim.hole = true;
  frame.rim.inner = box(half_x, half_y);
  RimDerivatives const found = rim_derivatives(frame, {off, -0.4, 0});
  auto const edge = [](double at) { return std::sqrt(2 / pi) / w * std::exp(-2 * at * at / (w * w)); };
  auto const below = [](double at) { return std::erf(std::sqrt(2) * at / w); };
  double const slope = below(half_y) * (edge(off + half_x) - edge(off - half_x)),
               kept = 0.5 * below(half_y) * (below(half_x + off) + below(half_x - off));
  EXPECT_NEAR(found.removed / (1 - kept), 1, 1e-9);
  EXPECT_NEAR(found.slope[0] / slope, 1, 1e-9);
  EXPECT_NEAR(found.slope[5] / (-0.4 * slope), 1, 1e-9) << "about a pivot below";
  double const across = -4 * half_y / (w * w) * edge(half_y) * (below(half_x + off) + below(half_x - off));
  EXPECT_NEAR(found.curvature(1, 1) / across, 1, 1e-6);
  EXPECT_GT(std::fabs(found.slope[0] / slope_of(half_x, off) - 1), 0.1) << "control: a round hole";
}

// A mirror or lens takes what falls beside it. The edge integral of a circle is eq. N.11, also where an elliptic beam
// meets it at an angle and where a beam diverges.
TEST(MovingRims, edge_integral_of_a_circle) {
  world::Outline const circle{a, a};
  Flat lens = plate(circle, {d, 0, 0}, waist());
  lens.screen = false;
  EXPECT_NEAR(rim_derivatives(lens, {}).slope[0] / slope_of(a, d), 1, 1e-9);
  EXPECT_NEAR(rim_derivatives(lens, {}).removed, 1 - 0.8557401455, 1e-10);
  constexpr double sides = 400;  // of a polygon between its circles: their radii differ by (pi/sides)^2/2 = 3e-5
  lens.rim.outer = {a, a, sides, 0.2, a * std::cos(pi / sides)};
  EXPECT_NEAR(rim_derivatives(lens, {}).slope[0] / slope_of(a, d), 1, 1e-3);
  lens.rim.outer = {a, a, 6, 0.2, a * std::cos(pi / 6)};
  EXPECT_GT(std::fabs(rim_derivatives(lens, {}).slope[0] / slope_of(a, d) - 1), 0.02) << "control: a hexagon";
  Vec3 const axis = unit({0.5, 0.2, 1});
  Frame const f = Frame::around(axis);
  Mode const beam = propagated(elliptic_mode({}, {1, 0, 0}, {0, 0, 1}, {w, 0.6 * w}, {0.3, -0.2}, lambda), 0.4);
  Vec3 const centre{d, 0.1e-3, 0.4}, pivot{0.1, 0.2, 0.3};
  RimDerivatives const by_edge =
                           rim_derivatives(Flat{{centre, f.e1, f.e2, axis, circle, {}, false}, beam, false}, pivot),
                       by_area = rim_derivatives(Round{centre, axis, a, 0, beam}, pivot);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(by_edge.slope[i], by_area.slope[i], 2e-3 * by_area.slope.norm()) << i;
  double const reach = pi * w * w / lambda, there = w * std::sqrt(5), steep = w / reach * 2 / std::sqrt(5);
  lens.rim.centre = {0, 0, 2 * reach};
  lens.rim.outer = {1.2 * there, 1.2 * there};
  lens.mode = propagated(waist(), 2 * reach);
  EXPECT_NEAR(rim_derivatives(lens, {}).slope[2] / (-4 * 1.44 / there * std::exp(-2 * 1.44) * steep), 1, 1e-9);
}

// A beam along z from z = -1 m through a hole of a body that is displaced, and a port on the disk behind.
World bench(double offset, double radius = a) {
  World world;
  world.wavelength = lambda;
  std::uint32_t const black = black_optic(world);
  BodyId const mount = world.add_body("mount", {offset, 0, 0}), table = world.add_body("table", {});
  world.add_surface(disk(radius, 0.1, {{offset, 0, 0}, {0, 0, -1}}), black, black, mount, world.add_group("iris"));
  world.add_surface(disk(0, 0.1, {{0, 0, 1}, {0, 0, -1}}), black, black, table, world.add_group("end"));
  Footprint f = free_beam(world.add_group("beam"), {0, 0, -1e-3}, {0, 0, 1}, Profile::gaussian, w);
  f.index = 1;
  world.add_footprint(f);
  Footprint at_end = f;
  at_end.surface = SurfaceId{1};
  at_end.centre = {0, 0, 1};
  world.add_footprint(at_end);
  world.open_port("port", {1});
  world.finish();
  return world;
}

// A route holds d^2 as coupling and A/d as phase sensitivity, so that their product is A^2.
TEST(MovingRims, route_of_an_iris) {
  MovingRimClasses const found = moving_rim_classes(bench(d));
  ASSERT_EQ(found.classes.size(), 1u);
  CouplingClass const& c = found.classes[0];
  EXPECT_EQ(c.kind, ClassKind::rim);
  EXPECT_TRUE(c.deterministic());
  double const removed = 1 - 0.8557401455;
  EXPECT_NEAR(c.coupling.mean / (removed * removed), 1, 1e-5);
  PathRecord const& first = c.records.at(0);
  ASSERT_EQ(RimTerm(first.event), RimTerm::first);
  EXPECT_NEAR(first.phase_sensitivities.at(0).d[0] * std::sqrt(first.weight) / slope_of(a, d), 1, 1e-4);
  EXPECT_EQ(first.phase_sensitivities.at(0).body.value, 0u);
  for (std::size_t i = 1; i < c.records.size(); ++i) EXPECT_EQ(c.records[i].weight, 0);
  EXPECT_TRUE(moving_rim_classes(bench(d, 5e-3)).classes.empty()) << "control: a hole that clips 1e-18";
}

// Beside the chief ray, and with a hole that is not round.
TEST(MovingRims, routes_of_other_outlines) {
  World world = bench(d, 5e-3);
  BodyId const body = world.add_body("knife", {});
  std::uint32_t const black = black_optic(world);
  Rectangle knife = rectangle(20e-3, 20e-3);
  knife.place({{10e-3 + 1.5 * w, 0, 0.5}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  world.add_surface(knife, black, black, body, world.add_group("knife"));
  world.finish();
  MovingRimClasses const found = moving_rim_classes(world);
  ASSERT_EQ(found.classes.size(), 1u);
  EXPECT_TRUE(found.warnings.empty());
  PathRecord const& first = found.classes[0].records.at(0);
  double const there = w * std::hypot(1, 0.5 * lambda / (pi * w * w));
  double const closed = std::sqrt(2 / pi) / there * std::exp(-2 * 2.25 * w * w / (there * there));
  EXPECT_NEAR(first.phase_sensitivities.at(0).d[0] * std::sqrt(first.weight) / closed, 1, 1e-3);
  world.add_surface(cuboid(20e-3, 20e-3, 1e-3, {{0, 11.5e-3, 0.6}}), black, black, body, world.add_group("block"));
  world.finish();
  std::vector<std::string> const left_out = moving_rim_classes(world).warnings;
  ASSERT_EQ(left_out.size(), 1u);
  EXPECT_NE(left_out[0].find("'block' clips"), std::string::npos) << left_out[0];
}

}  // namespace
}  // namespace straytrace::testing::moving_rims
