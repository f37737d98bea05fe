// SPDX-License-Identifier: BSD-3-Clause
// Beams that light nothing are told, and so is a trace without light: a zero is never the silent answer.
#include "scenes/program.hpp"

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

TEST(SilentBeams, ASideThatOnlyAbsorbsIsRefused) {
  Said const s = said_of(lamp(dark, "on: lamp"));
  EXPECT_EQ(s.check.code, 2);
  EXPECT_EQ(s.trace.code, 2);
  EXPECT_THAT(s.check.err, HasSubstr("a.yaml:11:10: error: beam 'light' lights the side of 'lamp' that only absorbs"));
  EXPECT_THAT(s.check.err, HasSubstr("its light travels along [0, 0, -1]: write 'travel: [0, 0, 1]'"));
  Said const black = said_of(lamp(dark, "on: lamp", "black"));
  EXPECT_THAT(black.check.err, HasSubstr("give the material of 'lamp' a 'scatter'"));
}

TEST(SilentBeams, TheRemediesAreAccepted) {  // the broken twins of the refusal
  for (std::string const& scene :
       {lamp(dark, "on: lamp, travel: [0, 0, 1]"), lamp("facing: [0, 0, -1], side: back", "on: lamp"),
        lamp("facing: [0, 0, 1], side: front", "on: lamp"), lamp("facing: [0, 0, -1]", "on: lamp")}) {
    Said const s = said_of(scene);
    EXPECT_EQ(s.check.code, 0) << s.check.err;
    EXPECT_EQ(s.trace.code, 0) << s.trace.err;
    EXPECT_THAT(s.trace.err, Not(HasSubstr("no light was emitted")));
  }
}

// A mirror keeps the light of a mode in the mode: allowed, but a trace of nothing else says that it was of nothing.
TEST(SilentBeams, NothingEmittedIsAWarning) {
  Said const s = said_of(lamp("facing: [0, 0, 1]", "on: lamp", "shiny"));
  EXPECT_EQ(s.check.code, 0) << s.check.err;
  EXPECT_EQ(s.trace.code, 0) << s.trace.err;
  EXPECT_THAT(s.trace.err, HasSubstr("warning: no light was emitted"));
}

TEST(SilentBeams, AFreeBeamThatMeetsNothingIsAWarning) {
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

// The lamp shines straight on the chip: nothing can be aimed at, and that is what is said.
TEST(SilentBeams, NothingToAimAt) {
  Folder const folder;
  write_text(folder / "a.yaml", lamp(dark, "on: lamp, travel: [0, 0, 1]"));
  Finished const r = straytrace({"importance", folder / "a.yaml"});
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(r.out, "Nothing to aim at: no light that is scattered a second time is received.\n");
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
