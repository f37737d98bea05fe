// SPDX-License-Identifier: BSD-3-Clause
// The list `photodiodes` of the table `wave`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/math/constants.hpp"
#include "support/message_of.hpp"
#include "unit/world/built_scene.hpp"

namespace straytrace::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

World diode_world(std::string const& diodes, std::string const& csv = "", std::string const& beam = "beam: arm, ") {
  std::string const scene =
      "straytrace: 1\nmaterials: {m: {scatter: {model: lambertian, tis: 1 ppm}}, black: {}}\n"
      "bodies: {b: {motion: still}}\nscene:\n"
      "  - {name: I, use: mirror, radius: 17 cm, radius_of_curvature: 1420 m, at: [0 m, 0 m, 0 m], facing: [0, 0, 1],"
      " body: b, material: m}\n"
      "  - {name: E, use: mirror, radius: 17 cm, radius_of_curvature: 1683 m, at: [0 m, 0 m, 3000 m], facing: [0, 0, "
      "-1],"
      " body: b, material: m}\n"
      "  - {name: ring, shape: {disk: {inner_radius: 20 cm, outer_radius: 50 cm}}, at: [0 m, 0 m, 2990 m],"
      " facing: [0, 0, -1], body: b, material: black}\n"
      "  - {name: other, shape: {disk: {inner_radius: 20 cm, outer_radius: 50 cm}}, at: [0 m, 0 m, 100 m],"
      " facing: [0, 0, -1], body: b, material: black}\n"
      "beams: {arm: {cavity: [I, E]}}\nports: {I: {beam: arm, at: I}, E: {beam: arm, at: E}}\n"
      "wave: {" +
      beam + "baffles: ring, photodiodes: " + diodes + "}\n";
  return testing::built({{"a.yaml", scene}, {"d.csv", csv}}).world;
}
std::string diode_problem(std::string const& diodes, std::string const& csv = "") {
  return test::message_of([&] { diode_world(diodes, csv); });
}

TEST(ReadPhotodiodes, RingsAndFiles) {
  World const w = diode_world(
      "[{name: a, on: ring, towards: E, radius: 30 cm, count: 4, azimuth: 90 deg, size: 1 cm},"
      " {name: b, on: I, towards: I, file: d.csv, size: 5 mm, shape: round}]",
      "x [mm], y [cm]\n0, 25\n-300, 0\n");
  ASSERT_EQ(w.wave.photodiodes.size(), 2u);
  auto const &a = w.wave.photodiodes[0], &b = w.wave.photodiodes[1];
  EXPECT_EQ(w.name_of(a.on), "ring");
  EXPECT_EQ(a.towards, 1u);
  EXPECT_EQ(a.shape, WaveSettings::Photodiodes::Shape::square);
  ASSERT_EQ(a.places.size(), 4u);
  EXPECT_DOUBLE_EQ(a.places[1].radius, 0.3);
  EXPECT_DOUBLE_EQ(a.places[1].azimuth, pi);
  EXPECT_EQ(b.towards, 0u);
  EXPECT_EQ(b.shape, WaveSettings::Photodiodes::Shape::round);
  ASSERT_EQ(b.places.size(), 2u);
  EXPECT_DOUBLE_EQ(b.places[0].radius, 0.25);
  EXPECT_DOUBLE_EQ(b.places[0].azimuth, pi / 2);
  EXPECT_DOUBLE_EQ(b.places[1].radius, 0.3);
}

TEST(ReadPhotodiodes, PlacesAreExplained) {
  auto const ring = [](std::string const& more) {
    return diode_problem("{name: a, towards: E, size: 1 cm, " + more + "}");
  };
  std::string const four = ", radius: 30 cm, count: 4";
  EXPECT_EQ(ring("on: ring" + four), "no error");  // control
  EXPECT_THAT(ring("on: other" + four), HasSubstr("'other' is not a screen of the field"));
  EXPECT_THAT(ring("on: rong" + four), HasSubstr("did you mean 'ring'?"));
  EXPECT_THAT(ring(four.substr(2)), HasSubstr("'on' is missing"));
  EXPECT_THAT(ring("on: I" + four),
              AllOf(HasSubstr("light around a mirror travels towards it"), HasSubstr("towards: I")));
  EXPECT_THAT(ring("on: ring, radius: 20 cm, count: 4"),
              AllOf(HasSubstr("reaches from 0.195 m"), HasSubstr("'ring' lies from 0.2 m to 0.5 m")));
  EXPECT_THAT(ring("on: ring, radius: 49.6 cm, count: 4"), HasSubstr("'ring' lies from 0.2 m to 0.5 m"));
  EXPECT_THAT(ring("on: ring, radius: 30 cm, count: 1000"), HasSubstr("1000 photodiodes of 0.01 m overlap"));
  EXPECT_EQ(ring("on: ring, radius: 30 cm, count: 1000, shape: sector"), "no error");  // they share the ring
  EXPECT_THAT(diode_problem("{name: a, towards: I, on: E, size: 1 cm" + four + "}"), HasSubstr("'towards: E'"));
  EXPECT_THAT(diode_problem("{name: a, towards: I, on: I, size: 1 cm, radius: 17.2 cm, count: 4}"),
              HasSubstr("'I' lies beyond 0.17 m"));
  EXPECT_THAT(diode_problem("{name: a, on: ring, size: 1 cm" + four + "}"), HasSubstr("'towards' is missing"));
  EXPECT_THAT(diode_problem("{name: a, towards: ring, on: ring, size: 1 cm" + four + "}"),
              AllOf(HasSubstr("'ring' is not a mirror of the cavity"), HasSubstr("I, E")));
}

TEST(ReadPhotodiodes, FilesAndNamesAreExplained) {
  auto const file = [](std::string const& csv, std::string const& more = "") {
    return diode_problem("{name: a, on: ring, towards: E, size: 1 cm, file: d.csv" + more + "}", csv);
  };
  EXPECT_EQ(file("x [mm], y [mm]\n250, 0\n"), "no error");  // control
  EXPECT_THAT(file("x [mm], z [mm]\n250, 0\n"), HasSubstr("no column 'y'"));
  EXPECT_THAT(file("x [mm], y [s]\n250, 0\n"), HasSubstr("column 'y' is a length"));
  EXPECT_THAT(file("x [mm], y [mm]\n250, 0\n100, 0\n"), HasSubstr("photodiode 2 of 'a' reaches from 0.095 m"));
  EXPECT_THAT(file("x [mm], y [mm]\n250, 0\n", ", count: 3"), HasSubstr("'count' is for a ring"));
  EXPECT_THAT(file("x [mm], y [mm]\n250, 0\n", ", shape: sector"), HasSubstr("sectors make a ring"));
  std::string const one = "{name: a, on: ring, towards: E, size: 1 cm, radius: 30 cm, count: 4}";
  EXPECT_THAT(diode_problem("[" + one + ", " + one + "]"), HasSubstr("two sets of photodiodes are called 'a'"));
  EXPECT_THAT(test::message_of([&] { diode_world(one, "", ""); }), HasSubstr("'beam'"));  // and nothing of mirrors
  EXPECT_THAT(diode_problem("{name: a, on: ring, towards: E, sise: 1 cm, radius: 30 cm, count: 4}"),
              AllOf(HasSubstr("did you mean 'size'?"), Not(HasSubstr("overlap"))));
}

}  // namespace
}  // namespace straytrace::testing
