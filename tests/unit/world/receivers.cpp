// SPDX-License-Identifier: BSD-3-Clause
// Tables `receivers` and free `beams` -> world (R3.10, R3.28, R3.30).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/math/rng.hpp"
#include "support/message_of.hpp"
#include "support/statistics.hpp"
#include "unit/world/built_scene.hpp"
#include "world/model/world.hpp"

namespace straytrace::testing::world_receivers {
namespace {

using ::testing::HasSubstr;

constexpr char bench[] =
    "straytrace: 1\nmaterials: {black: {}}\nbodies: {b: {motion: still}}\nscene:\n"
    "  - {name: det, shape: {disk: {outer_radius: 2 cm}}, at: [0 m, 0 m, 1 m], facing: [0, 0, -1], body: b, material: "
    "black}\n";
constexpr char beam[] = "beams: {probe: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], radius: 5 mm, power: 2 W}}\n";

World world_of(std::string const& more) { return built(bench + more).world; }
std::string complaint(std::string const& more) {
  return test::message_of([&] { world_of(more); });
}

TEST(ReadReceivers, OnASurface) {
  World const w =
      world_of(std::string(beam) +
               "receivers: {PD: {on: det, side: front, map: {pixels: [8, 4], width: 2 cm, centre: [1 mm, 0 m],"
               " turn: 90 deg}, angles: {bins: 16, half_angle: 30 deg}, quadrants: {gap: 1 mm}}}\n");
  ASSERT_EQ(w.receivers().size(), 1u);
  Receiver const& r = w.receivers()[0];
  EXPECT_EQ(w.receiver_names()[0], "PD");
  EXPECT_TRUE(r.front && !r.back && !r.clear && r.quadrants);
  EXPECT_EQ(r.columns, 8u);
  EXPECT_DOUBLE_EQ(r.half_height, 0.005);  // square pixels unless given
  EXPECT_DOUBLE_EQ(r.half_angle_sine, 0.5);
  EXPECT_DOUBLE_EQ(r.gap, 1e-3);
  EXPECT_NEAR(r.frame.e3.z, -1, 1e-15);
  EXPECT_NEAR(length(r.frame.origin - Vec3{1e-3, 0, 1}), 0, 1e-15);
  // Lower left first, in the turned frame: e1 of the map is e2 of the surface.
  Pose const own = r.quadrant_frame;
  EXPECT_NEAR(length(r.frame.e1 - own.e2), 0, 1e-15);
  EXPECT_EQ(r.pixel(r.frame.point({-0.0099, -0.0049, 0})), 0u);
  EXPECT_EQ(r.pixel(r.frame.point({0.0099, -0.0049, 0})), 7u);
  EXPECT_EQ(r.pixel(r.frame.point({-0.0099, 0.0049, 0})), 24u);
  EXPECT_EQ(r.pixel(r.frame.point({0.0101, 0, 0})), Receiver::outside);
  EXPECT_EQ(r.quadrant(own.point({-0.6e-3, -0.6e-3, 0})), 0u);
  EXPECT_EQ(r.quadrant(own.point({0.6e-3, -0.6e-3, 0})), 1u);
  EXPECT_EQ(r.quadrant(own.point({-0.6e-3, 0.6e-3, 0})), 2u);
  EXPECT_EQ(r.quadrant(own.point({0.4e-3, 0.6e-3, 0})), 4u);  // in the gap
}

TEST(ReadReceivers, SeveralOnOneSurfaceAndPlanes) {
  World const w = world_of(std::string(beam) +
                           "receivers:\n  A: {on: det}\n  B: {on: det, map: {pixels: [2, 2], width: 1 cm}}\n"
                           "  plane: {shape: {disk: {outer_radius: 1 cm}}, at: [0 m, 0 m, 50 cm], facing: [0, 0, -1]}\n"
                           "  stop: {shape: {sphere: {radius: 1 m}}, at: [3 m, 0 m, 0 m], passes: no}\n");
  ASSERT_EQ(w.receivers().size(), 4u);
  EXPECT_EQ(w.receivers()[0].surface, w.receivers()[1].surface);
  EXPECT_EQ(w.view().receiver_of_surface[w.receivers()[1].surface.value], 0u);
  EXPECT_TRUE(w.receivers()[2].clear);
  EXPECT_FALSE(w.receivers()[3].clear);
  EXPECT_TRUE(w.surfaces()[w.receivers()[2].surface.value].clear);
  EXPECT_NE(w.fingerprint(), world_of(std::string(beam) + "receivers: {A: {on: det}}\n").fingerprint());
}

TEST(ReadReceivers, EveryMistakeHasAPlaceAndARemedy) {
  auto const receiver = [](std::string const& keys) { return complaint(beam + ("receivers: {PD: {" + keys + "}}\n")); };
  EXPECT_THAT(receiver("on: dett"), HasSubstr("did you mean 'det'?"));
  EXPECT_THAT(receiver("on: dett"), HasSubstr("a.yaml:7"));
  EXPECT_THAT(receiver("side: front"), HasSubstr("has no place"));
  EXPECT_THAT(receiver("on: det, passes: yes"), HasSubstr("only for a separate plane"));
  EXPECT_THAT(receiver("on: det, map: {pixels: [0, 4], width: 1 cm}"), HasSubstr("whole numbers"));
  EXPECT_THAT(receiver("on: det, map: {centre: [1 mm, 0 m]}"), HasSubstr("'centre' is for a map with a 'width'"));
  EXPECT_EQ(receiver("on: det, map: {width: 1 cm, centre: [1 mm, 0 m]}"), "no error");
  EXPECT_EQ(receiver("on: det, map: {}"), "no error");
  EXPECT_THAT(receiver("on: det, map: {pixels: [4096, 4096], width: 1 cm}"), HasSubstr("more than a million"));
  EXPECT_THAT(receiver("on: det, quadrant: {gap: 1 mm}"), HasSubstr("quadrants"));
  EXPECT_THAT(receiver("on: det, quadrants: {gap: 1}"), HasSubstr("length"));  // explicit units
  EXPECT_THAT(receiver("shape: {sphere: {radius: 1 m}}"), HasSubstr("measuring plane must be flat"));
  EXPECT_THAT(receiver("on: det, shape: {disk: {outer_radius: 1 m}}"), HasSubstr("both given"));
  EXPECT_THAT(complaint(std::string(beam) + "receivers: {'a b': {on: det}}\n"), HasSubstr("cannot name"));
  EXPECT_THAT(complaint(beam), HasSubstr("nor a receiver"));
  EXPECT_EQ(receiver("on: det"), "no error");
}

TEST(ReadFreeBeams, Keys) {
  std::string const end = "receivers: {PD: {on: det}}\n";
  World const w = world_of(
      "beams:\n  one: {from: [0 m, 0 m, 0 m], facing: [0, 0, 2], profile: even, radius: 3 mm, wavefront_curvature: 2 "
      "/m, "
      "power: 4 W}\n"
      "  two: {from: [0 m, 1 m, 0 m], facing: [0, -1, 0], waist: {radius: 0.2 mm, ahead: 30 cm}, power: 1 W, "
      "polarisation: [1, 5, 0]}\n" +
      end);
  ASSERT_EQ(w.footprints().size(), 2u);
  Footprint const &one = w.footprints()[0], &two = w.footprints()[1];
  EXPECT_TRUE(one.free && !one.receives && one.emits);
  EXPECT_EQ(w.beam_power, 4);
  EXPECT_EQ(one.share, 1);
  EXPECT_EQ(two.share, 0.25);
  EXPECT_EQ(one.curvature, 2);
  EXPECT_NE(one.origin.value, two.origin.value);
  // Gaussian beam 30 cm in front of its waist: it converges.
  double const z_r = pi * 0.2e-3 * 0.2e-3 / 1.064e-6;
  EXPECT_NEAR(two.radius, 0.2e-3 * std::hypot(1, 0.3 / z_r), 1e-12);
  EXPECT_NEAR(two.curvature, -0.3 / (0.09 + z_r * z_r), 1e-9);
  EXPECT_TRUE(w.polarised);
  EXPECT_NEAR(two.polarisation.axis.x, 1, 1e-15);
  EXPECT_EQ(two.polarisation.q, 1);
  EXPECT_THAT(complaint("beams: {b: {from: [0 m, 0 m, 0 m], radius: 1 mm}}\n" + end), HasSubstr("has no direction"));
  EXPECT_THAT(complaint("beams: {det: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], radius: 1 mm}}\n" + end),
              HasSubstr("already called 'det'"));
  EXPECT_THAT(
      complaint("beams: {b: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], radius: 1 mm, polarisation: [0, 0, 1]}}\n" +
                end),
      HasSubstr("parallel to the beam"));
}

// R3.10: <rho^2> = R^2/2 for a uniform disc, w^2/2 for a Gaussian spot. Effect to be detected: 2 %.
TEST(ReadFreeBeams, MomentsOfTheProfile) {
  auto const moment = [](char const* profile) {
    World const w = world_of("beams: {b: {from: [1 m, 0 m, 0 m], facing: [1, 2, 3], radius: 5 mm, profile: " +
                             std::string(profile) + "}}\nreceivers: {PD: {on: det}}\n");
    Footprint const& f = w.footprints()[0];
    Sampler sum;
    for (std::uint64_t h = 0; h < 200000; ++h) {
      Rng rng(7, h, 0, Stream::source);
      double const u = rng.uniform(), v = rng.uniform();
      sum.add(length2(f.offset(f.sample(u, v).origin)));
    }
    return sum.mean();
  };
  double const half = 0.5 * 5e-3 * 5e-3;
  expect_mean("even", moment("even"), half, 0.02 * half);
  expect_mean("gaussian", moment("gaussian"), half, 0.03 * half);
  expect_rejected("the radius of the field 1/e taken for w", moment("gaussian"), 2 * half);
  expect_rejected("a square instead of a disc", moment("even"), 2.0 / 3 * 2 * half);
}

}  // namespace
}  // namespace straytrace::testing::world_receivers
