// SPDX-License-Identifier: BSD-3-Clause
// The key `modulation` of beams (docs/theory/phase.md, eq. N.25).
#include <cmath>

#include "motion/motion.hpp"
#include "support/scene_tables.hpp"

namespace straytrace::testing::light_of_beams {
namespace {

using ::testing::HasSubstr;

struct Read {
  LightModulation light;
  std::string problems;
};

Read read(std::string const& modulation) {
  Scene const scene = scene_of("beams:\n  other: {radius: 1 mm}\n  probe: {modulation: " + modulation +
                                   "}\nports: {A: {beam: probe}, B: {beam: other}}\n",
                               {});
  Read r{read_modulation(scene.root()["beams"], scene.root()["ports"], {"B", "A"}), {}};
  r.problems = problems_of(scene);
  return r;
}

TEST(ReadLight, AmplitudePhaseAndFrequency) {
  Read const r = read(
      "[{amplitude: 1 %, frequency: 40 Hz}, {phase: 0.1 rad, frequency: 50 Hz, start: 90 deg}, "
      "{deviation: 10 kHz, frequency: 40 Hz}]");
  EXPECT_EQ(r.problems, "");
  ASSERT_EQ(r.light.tones.size(), 3u);
  EXPECT_EQ(r.light.tones[0].amplitude, 0.01);
  EXPECT_EQ(r.light.tones[0].phase, 0);
  EXPECT_EQ(r.light.tones[1].phase, 0.1);
  EXPECT_DOUBLE_EQ(r.light.tones[1].start, M_PI / 2);
  EXPECT_DOUBLE_EQ(r.light.tones[2].phase, 250) << "deviation over frequency";
  for (LightTone const& t : r.light.tones) EXPECT_EQ(t.beam, 1u);
  EXPECT_EQ(r.light.port_beam, (std::vector<std::uint32_t>{0, 1})) << "in the order of the ports of the model";
  EXPECT_EQ(read("{phase: 1 deg, frequency: 1 kHz}").light.tones.size(), 1u) << "one table";
}

TEST(ReadLight, MistakesAreNamed) {
  EXPECT_THAT(read("{frequency: 40 Hz}").problems, HasSubstr("the size of the modulation is missing"));
  EXPECT_THAT(read("{phase: 1 rad, amplitude: 1 %, frequency: 40 Hz}").problems,
              HasSubstr("a modulation is of amplitude, phase or frequency"));
  EXPECT_THAT(read("{phase: 1 rad}").problems, HasSubstr("frequency"));
  EXPECT_THAT(read("{phase: 1 rad, frequency: 40 Hz, begin: 1}").problems, HasSubstr("begin"));
  EXPECT_THAT(read("{amplitude: 2, frequency: 40 Hz}").problems, HasSubstr("amplitude"));
  EXPECT_THAT(read("40 Hz").problems, HasSubstr("a modulation is a table"));
  EXPECT_THAT(read("{phase: 1 Hz, frequency: 40 Hz}").problems, HasSubstr("angle"));
}

}  // namespace
}  // namespace straytrace::testing::light_of_beams
