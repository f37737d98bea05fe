// SPDX-License-Identifier: BSD-3-Clause
// Beams that illuminate no surface are reported, and so is a trace without light: a zero is never silent.
#include <cstdio>

#include "scenes/program.hpp"
#include "support/statistics.hpp"

namespace straytrace::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string lamp(std::string const& lit, std::string const& beam, std::string const& material = "lamp") {
  return "straytrace: 1\nmaterials:\n  lamp: {scatter: {model: lambertian, tis: 100 %}}\n"
         "  shiny: {specular: {reflect: 90 %}}\n  black: {}\nbodies: {room: {motion: still}}\nscene:\n"
         "  - {name: lamp, shape: {disk: {outer_radius: 2 cm}}, " +
         lit + ", body: room, material: " + material +
         "}\n  - {name: chip, shape: {disk: {outer_radius: 2 cm}}, at: [0 m, 0 m, -30 cm], facing: [0, 0, 1], body: "
         "room, material: black}\nbeams:\n  light: {" +
         beam + ", profile: even, radius: 2 cm, power: 10 W}\nreceivers: {chip: {on: chip, side: front}}\n";
}

struct Said {
  Finished check, trace;
};
Said said_of(std::string const& scene) {
  Folder const folder;
  write_text(folder / "a.yaml", scene);
  return {straytrace({"check", folder / "a.yaml"}),
          straytrace({"trace", folder / "a.yaml", "-o", folder / "a.h5", "--histories", "4096"})};
}

constexpr char dark[] = "facing: [0, 0, -1], side: front";

TEST(SilentBeams, ASideThatOnlyAbsorbsIsAnError) {
  Said const s = said_of(lamp(dark, "on: lamp"));
  EXPECT_EQ(s.check.code, 2);
  EXPECT_EQ(s.trace.code, 2);
  EXPECT_THAT(s.check.err, HasSubstr("a.yaml:11:10: error: beam 'light' lights the side of 'lamp' that only absorbs"));
  EXPECT_THAT(s.check.err, HasSubstr("its light travels along [0, 0, -1]: write 'travel: [0, 0, 1]'"));
  Said const black = said_of(lamp(dark, "on: lamp", "black"));
  EXPECT_THAT(black.check.err, HasSubstr("give the material of 'lamp' a 'scatter'"));
}

TEST(SilentBeams, TheRemediesAreAccepted) {  // the negative controls of the error
  for (std::string const& scene :
       {lamp(dark, "on: lamp, travel: [0, 0, 1]"), lamp("facing: [0, 0, -1], side: back", "on: lamp"),
        lamp("facing: [0, 0, 1], side: front", "on: lamp"), lamp("facing: [0, 0, -1]", "on: lamp")}) {
    Said const s = said_of(scene);
    EXPECT_EQ(s.check.code, 0) << s.check.err;
    EXPECT_EQ(s.trace.code, 0) << s.trace.err;
    EXPECT_THAT(s.trace.err, Not(HasSubstr("no light was emitted")));
  }
}

// A wall of albedo 1/2 that is lit in a point and shines on a chip of radius a at the distance d, face to face.
struct Walled {
  std::string shape, chip, beam;
};
std::string scene_of(Walled const& w) {
  return "straytrace: 1\nmaterials:\n  wall: {scatter: {model: lambertian, tis: 50 %}}\n  black: {}\n"
         "bodies: {room: {motion: still}}\nscene:\n  - {name: wall, shape: {" +
         w.shape +
         "}, side: inner, body: room, material: wall}\n  - {name: chip, shape: {disk: {outer_radius: " + w.chip +
         ", body: room, material: black}\nbeams:\n  lamp: {on: wall, profile: point, power: 10 W, " + w.beam +
         "}\nreceivers: {chip: {on: chip, side: front}}\ntrace: {order_limit: 1}\n";
}
Walled const walled[] = {
    {"cylinder: {radius: 50 cm, from: 0 m, to: 3 m}", "5 cm}}, at: [0 m, 0 m, 1 m], facing: [0, 1, 0]",
     "centre: [0 m, 50 cm, 1 m], travel: [0, 1, 0]"},
    {"cone: {inner_radius: 30 cm, outer_radius: 60 cm, half_angle: 30 deg}",
     "3 cm}}, at: [0 m, 19.019238 cm, 40.980762 cm], facing: [0, 0.8660254, -0.5]",
     "centre: [0 m, 45 cm, 259.80762 mm], travel: [0, 1, 0]"},
    {"sphere: {radius: 1 m}", "10 cm}}, facing: [0, 0, -1]", "travel: [0, 0, -1]"},
    {"torus: {major_radius: 1 m, minor_radius: 30 cm}", "3 cm}}, at: [0 m, 1 m, 0 m], facing: [0, 1, 0]",
     "centre: [0 m, 1.3 m, 0 m], travel: [0, 1, 0]"},
    {"box: {width: 1 m, height: 1 m, depth: 1 m}", "5 cm}}, facing: [0, 1, 0]",
     "centre: [0 m, 50 cm, 0 m], travel: [0, 1, 0]"}};

// Power on the chip over that of the lamp.
SampleMean on_chip(std::string const& scene) {
  Folder const folder;
  write_text(folder / "a.yaml", scene);
  Finished const trace = straytrace({"trace", folder / "a.yaml", "-o", folder / "a.h5", "--histories", "131072"});
  EXPECT_EQ(trace.code, 0) << trace.err;
  std::string const rows = straytrace({"paths", folder / "a.h5", "--by", "receiver", "--csv"}).out;
  std::size_t const at = rows.find("\nchip,0,,all,");
  double power = 0, sigma = 0;
  EXPECT_TRUE(at != std::string::npos && std::sscanf(&rows[at], "\nchip,0,,all,%lf,%lf", &power, &sigma) == 2) << rows;
  return {power, sigma, 131072};
}

// albedo a^2/(a^2 + d^2), with d/a = 10 in all of them; a spot on the wall across lights the back of the chip.
TEST(SilentBeams, InnerWallsAreLitFromTheirCentre) {
  double const expected = 0.5 / 101;
  for (Walled const& w : walled) expect_mean(w.shape.c_str(), on_chip(scene_of(w)), expected, 0.01 * expected);
  std::string turned = scene_of(walled[0]);
  turned.replace(turned.find("facing: [0, 1, 0]"), 17, "facing: [0, 1, 1]");
  expect_rejected("chip turned by 45 deg", on_chip(turned), expected);
}

// The remedy of the error is the scene that is accepted above.
TEST(SilentBeams, AnInnerWallLitFromBehindNamesARemedy) {
  for (Walled const& w : walled) {
    if (w.beam.find("centre") == std::string::npos) continue;
    std::string wrong = scene_of(w);
    wrong.replace(wrong.find("travel: [0, 1, 0]"), 17, "travel: [0, -1, 0]");
    Said const s = said_of(wrong);
    EXPECT_EQ(s.check.code, 2);
    EXPECT_THAT(s.check.err, HasSubstr("beam 'lamp' lights the side of 'wall' that only absorbs"));
    EXPECT_THAT(s.check.err, HasSubstr("its light travels along [0, -1, 0]: write 'travel: [0, 1, 0]'"));
  }
}

// A parameter that is not defined is the only error, at any position in a list (a zero vector is another error).
TEST(SilentBeams, AVectorWithAnUnknownParameterIsNotOfLengthZero) {
  std::string const on = "on: lamp", free = "from: [0 m, 0 m, -10 cm]";
  auto const complaint = [&](std::string const& y) {
    std::string all;
    for (auto const& scene :
         {lamp("facing: [0, " + y + ", 1]", on), lamp("rotate: {axis: [0, " + y + ", 0], angle: 3 deg}", on),
          lamp("facing: [0, 0, 1]", on + ", travel: [0, " + y + ", 0]"),
          lamp("facing: [0, 0, 1]", on + ", polarisation: [0, " + y + ", 0]"),
          lamp("facing: [0, 0, 1]", free + ", facing: [0, " + y + ", 0]")})
      all += said_of(scene).check.err;
    return all;
  };
  auto const count = [](std::string const& text, std::string const& what) {
    int n = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
    return n;
  };
  std::string const undefined = complaint("nowhere"), zero = complaint("0");
  EXPECT_EQ(count(undefined, "error: parameter 'nowhere' is not defined"), 5) << undefined;
  EXPECT_EQ(count(undefined, "error: "), 5) << undefined;
  EXPECT_EQ(count(zero, "error: a direction of length zero"), 4) << zero;  // [0, 0, 1] is not zero
}

// A mirror keeps the light of a mode in the mode: allowed, but a trace of nothing else reports that nothing was
// emitted.
TEST(SilentBeams, NothingEmittedIsAWarning) {
  Said const s = said_of(lamp("facing: [0, 0, 1]", "on: lamp", "shiny"));
  EXPECT_EQ(s.check.code, 0) << s.check.err;
  EXPECT_EQ(s.trace.code, 0) << s.trace.err;
  EXPECT_THAT(s.trace.err, HasSubstr("warning: no light was emitted"));
}

TEST(SilentBeams, AFreeBeamThatMeetsNoSurfaceIsAWarning) {
  std::string const missed = "beam 'light' meets no surface";
  auto const free = [](std::string const& direction) {
    return said_of(lamp("facing: [0, 0, 1]", "from: [0 m, 0 m, -10 cm], facing: " + direction)).check;
  };
  Finished const past = free("[0, 1, 0]");
  EXPECT_EQ(past.code, 0);
  EXPECT_THAT(past.err, HasSubstr("a.yaml:11:10: warning: " + missed));
  EXPECT_THAT(free("[0, 0, 1]").err, Not(HasSubstr(missed)));
  Finished const beside = said_of(lamp("facing: [0, 0, 1]", "on: lamp, travel: [1, 0, 0]")).check;
  EXPECT_THAT(beside.err, HasSubstr("beam 'light' does not meet 'lamp'"));
}

// Only the edge of the beam meets the disk.
TEST(SilentBeams, AGrazedSurfaceIsMet) {
  Finished const r = said_of(lamp("facing: [0, 0, 1]", "from: [3.9 cm, 0 m, -10 cm], facing: [0, 0, 1]")).check;
  EXPECT_THAT(r.err, Not(HasSubstr("meets no surface")));
}

// The lamp shines straight on the chip: no target can be aimed at, and the message states this.
TEST(SilentBeams, NothingToAimAt) {
  Folder const folder;
  write_text(folder / "a.yaml", lamp(dark, "on: lamp, travel: [0, 0, 1]"));
  Finished const r = straytrace({"importance", folder / "a.yaml"});
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(r.out, "No targets: no light of a second scatter is received.\n");
}

TEST(SilentBeams, SubPathsBehindGlassDoNotFollowPolarisation) {
  auto const check = [](std::string const& beam) {
    std::string scene = lamp("facing: [0, 0, 1]", "from: [0 m, 0 m, -10 cm], facing: [0, 0, 1]" + beam);
    std::size_t const at = scene.find("side: front}}");
    scene.replace(at, 13, "side: front, behind_glass: yes}}");
    return said_of(scene).check.err;
  };
  std::string const told = "'behind_glass' does nothing where a beam states its polarisation";
  EXPECT_THAT(check(", polarisation: [1, 0, 0]"), HasSubstr("warning: " + told));
  EXPECT_THAT(check(""), Not(HasSubstr(told)));
}

}  // namespace
}  // namespace straytrace::testing
