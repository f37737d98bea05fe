// SPDX-License-Identifier: BSD-3-Clause
// The table `bodies`.
#include "motion/motion.hpp"

#include <cmath>
#include <map>

#include "support/scene_tables.hpp"

namespace straytrace::testing::noise_motion {
namespace {

using ::testing::HasSubstr;

struct Read {
  Scene scene;
  MotionSet motion;
  std::string problems;
};

Read read(std::string const& bodies, std::vector<std::string> const& names, FileTexts files = {}) {
  Read r{scene_of("bodies:\n" + bodies, std::move(files)), {}, {}};
  r.motion = read_motion(r.scene.root()["bodies"], names);
  r.problems = problems_of(r.scene);
  return r;
}

// Mean-square phase of a unit phase sensitivity on one coordinate.
double variance(MotionSet const& m, std::uint32_t body, int axis) {
  PhaseSensitivity l{BodyId{body}, {}};
  l.d[axis] = 1;
  double sum = 0;
  for (std::size_t i = 0; i < m.inputs.size(); ++i) {
    MotionInput const& input = m.inputs[i];
    sum += m.sensitivity(i, {&l, 1}, 1) * (input.tone_frequency > 0 ? 0.5 : input.spectrum.total());
  }
  return sum;
}

TEST(ReadMotion, StillIsAStatement) {
  Read const r = read("  a: {motion: still}\n", {"a"});
  EXPECT_EQ(r.problems, "");
  EXPECT_TRUE(r.motion.inputs.empty());
  EXPECT_THAT(read("  a: {motion: still}\n", {"a", "b"}).problems, HasSubstr("body 'b' has no motion"));
  EXPECT_THAT(read("  a: {motion: still}\n", {"a", "b", "c"}).problems,
              ::testing::AllOf(HasSubstr("bodies 'b', 'c' have no motion"), HasSubstr("1 error.")));
  EXPECT_THAT(read("  a: {pivot: [0 m, 0 m, 0 m]}\n", {"a"}).problems, HasSubstr("body 'a' has no 'motion'"));
}

// A ground that only the new motion has may carry bodies of a run; what has no phase sensitivities there is not dropped
// in silence.
TEST(ReadMotion, OfATracedRun) {
  auto const problems = [](std::string const& bodies, bool traced) {
    Scene const scene = scene_of("bodies:\n" + bodies, {});
    read_motion(scene.root()["bodies"], {"tower"}, traced);
    return problems_of(scene);
  };
  std::string const ground = "  ground: {motion: {z: {peterson: low}, others: still}}\n",
                    mode = "  tower: {motion: still, modes: {bend: {motion: {peterson: low}}}}\n";
  EXPECT_EQ(problems(ground + "  tower: {motion: {follows: ground}}\n", true), "");
  EXPECT_THAT(problems(ground + "  tower: {motion: still}\n", true), HasSubstr("the run has no body 'ground'"));
  EXPECT_THAT(problems("  towr: {motion: still}\n", true), HasSubstr("did you mean 'tower'?"));
  EXPECT_THAT(problems(mode, true), HasSubstr("the run has no mode 'tower/bend'"));
  EXPECT_EQ(problems(mode, false), "");  // a scene is warned, not stopped
}

TEST(ReadMotion, MeasuredSpectrum) {
  FileTexts const files = {{"tube.txt", "# Hz nm/s x\n1 5 2e3\n10 5 2e3\n"}};
  Read const r =
      read("  a: {motion: {z: {asd: tube.txt, columns: [Hz, um/s/sqrt(Hz)], use: [1, 2], scale: 2}, others: still}}\n",
           {"a"}, files);
  ASSERT_EQ(r.problems, "");
  ASSERT_EQ(r.motion.inputs.size(), 1u);
  EXPECT_EQ(r.motion.inputs[0].name, "a z");
  EXPECT_NEAR(std::sqrt(r.motion.inputs[0].spectrum.at(1)) / (2 * 5e-6 / (2 * 3.14159265358979)), 1, 1e-9);
  Read const power =
      read("  a: {motion: {z: {asd: tube.txt, columns: [Hz, m, m^2/Hz], use: [1, 3]}, others: still}}\n", {"a"}, files);
  ASSERT_EQ(power.problems, "");
  EXPECT_NEAR(power.motion.inputs[0].spectrum.at(3), 2000, 1e-6);
}

TEST(ReadMotion, UnitsOfAFileAreMandatory) {
  FileTexts const files = {{"tube.txt", "1 5\n10 5\n"}, {"bad.txt", "1 5\n1 five\n"}, {"empty.txt", ""}};
  auto const problem = [&](std::string const& spec) {
    return read("  a: {motion: {z: {" + spec + "}, others: still}}\n", {"a"}, files).problems;
  };
  EXPECT_THAT(problem("asd: tube.txt"), HasSubstr("columns: [Hz, m/sqrt(Hz)]"));
  EXPECT_THAT(problem("asd: tube.txt, columns: [Hz, V]"), HasSubstr("\"V\" is not a unit of a motion spectrum"));
  EXPECT_THAT(problem("asd: tube.txt, columns: [m, m/sqrt(Hz)]"), HasSubstr("not a unit of frequency"));
  EXPECT_THAT(problem("asd: bad.txt, columns: [Hz, m/sqrt(Hz)]"),
              HasSubstr("bad.txt:2:3: error: 'five' is not a number"));
  EXPECT_THAT(problem("asd: empty.txt, columns: [Hz, m/sqrt(Hz)]"), HasSubstr("no numbers in it"));  // not no motion
  EXPECT_THAT(problem("asd: none.txt, columns: [Hz, m/sqrt(Hz)]"), HasSubstr("1 error"));
}

TEST(ReadMotion, FormulasAddUp) {
  Read const r = read(
      "  a:\n"
      "    motion:\n"
      "      x: {line: {at: 0.35 Hz, width: 0.05 Hz, rms: 0.4 um rms}}\n"
      "      y: [{line: {at: 1 Hz, width: 0.1 Hz, rms: 3 um rms}}, {sine: {amplitude: 10 um pp, frequency: 1.14 Hz}}]\n"
      "      z: {power-law: {asd: 1e-6 m/sqrt(Hz), at: 1 Hz, exponent: -2, from: 0.05 Hz, to: 1 kHz}}\n"
      "      rx: {line: {at: 1 Hz, width: 0.1 Hz, rms: 2 urad rms}}\n",
      {"a"});
  ASSERT_EQ(r.problems, "");
  EXPECT_NEAR(variance(r.motion, 0, 0) / 0.16e-12, 1, 1e-9);
  EXPECT_NEAR(variance(r.motion, 0, 1) / (9e-12 + 12.5e-12), 1, 1e-9);
  EXPECT_NEAR(variance(r.motion, 0, 2) / (1e-12 / 3 * (8000 - 1e-9)), 1, 1e-9);
  EXPECT_NEAR(variance(r.motion, 0, 3) / 4e-12, 1, 1e-9);
  EXPECT_EQ(variance(r.motion, 0, 4), 0);
}

TEST(ReadMotion, AmplitudesMustStateTheirKind) {
  EXPECT_THAT(read("  a: {motion: {z: {sine: {amplitude: 10 um, frequency: 1 Hz}}, others: still}}\n", {"a"}).problems,
              HasSubstr("10 um peak"));
  EXPECT_THAT(
      read("  a: {motion: {z: {line: {at: 1 Hz, width: 0.1 Hz, rms: 1 um peak}}, others: still}}\n", {"a"}).problems,
      HasSubstr("no peak value"));
}

TEST(ReadMotion, UnnamedTranslationIsAnError) {
  EXPECT_THAT(read("  a: {motion: {x: still, z: {peterson: low}}}\n", {"a"}).problems,
              HasSubstr("has no motion along y"));
  EXPECT_EQ(read("  a: {motion: {x: still, y: still, z: {peterson: low}}}\n", {"a"}).problems, "");
  EXPECT_EQ(read("  a: {motion: {z: {peterson: low}, others: still}}\n", {"a"}).problems, "");
}

TEST(ReadMotion, LikeIsIndependentAndSameAsIsCoherent) {
  std::string const z = "  a: {motion: {z: {peterson: high}, y: still, x: ";
  PhaseSensitivity l{BodyId{0}, {1, 0, 1, 0, 0, 0}};  // x and z in phase
  auto const both = [&](MotionSet const& m) {
    double sum = 0;
    for (std::size_t i = 0; i < m.inputs.size(); ++i)
      sum += m.sensitivity(i, {&l, 1}, 1) * m.inputs[i].spectrum.total();
    return sum;
  };
  Read const like = read(z + "{like: z, scale: 0.5}}}\n", {"a"}),
             same = read(z + "{same_as: z, scale: 0.5}}}\n", {"a"});
  ASSERT_EQ(like.problems + same.problems, "");
  double const one = variance(like.motion, 0, 2);
  EXPECT_NEAR(variance(like.motion, 0, 0) / one, 0.25, 1e-12);
  EXPECT_NEAR(both(like.motion) / one, 1.25, 1e-12);
  EXPECT_NEAR(both(same.motion) / one, 2.25, 1e-12);
  EXPECT_THAT(read(z + "{like: x}}}\n", {"a"}).problems, HasSubstr("refers to itself"));
  EXPECT_THAT(
      read("  a: {motion: {z: {sine: {amplitude: 1 um peak, frequency: 1 Hz}}, x: {like: z}, y: still}}\n", {"a"})
          .problems,
      HasSubstr("same_as: z"));
  EXPECT_THAT(read("  a: {motion: {z: {peterson: low}, rx: {like: z}, others: still}}\n", {"a"}).problems,
              HasSubstr("one is a translation, one a rotation"));
}

TEST(ReadMotion, BodiesShareMotion) {
  std::string const ground = "  ground: {motion: {z: {peterson: high}, others: still}}\n";
  Read const r = read(
      ground +
          "  a: {motion: {follows: ground}}\n"
          "  b: {motion: {relative_to: ground, z: {line: {at: 1 Hz, width: 0.1 Hz, rms: 1 um rms}}, others: still}}\n",
      {"a", "b"});
  ASSERT_EQ(r.problems, "");
  EXPECT_EQ(r.scene.warnings(), "");  // a body may be there only to be followed
  double const shared = variance(r.motion, 0, 2);
  EXPECT_NEAR(variance(r.motion, 1, 2) - shared, 1e-12, 1e-20);
  double relative = 0;
  std::vector<PhaseSensitivity> const phase_sensitivities = {{BodyId{0}, {0, 0, 1}}, {BodyId{1}, {0, 0, -1}}};
  for (std::size_t i = 0; i < r.motion.inputs.size(); ++i)
    relative += r.motion.sensitivity(i, phase_sensitivities, 1) * r.motion.inputs[i].spectrum.total();
  EXPECT_NEAR(relative / 1e-12, 1, 1e-9);
  EXPECT_THAT(read(ground + "  a: {motion: {follows: grund}}\n", {"a"}).problems, HasSubstr("did you mean 'ground'?"));
  EXPECT_THAT(read("  a: {motion: {follows: b}}\n  b: {motion: {follows: a}}\n", {"a"}).problems,
              HasSubstr("refers to itself"));
}

TEST(ReadMotion, TonesOfOneFrequencyAreOneInput) {
  Read const r = read(
      "  a: {motion: {x: {sine: {amplitude: 3 um peak, frequency: 1 Hz}}, y: {sine: {amplitude: 4 um peak, frequency: "
      "1 Hz, phase: 90 deg}}, z: still}}\n",
      {"a"});
  ASSERT_EQ(r.problems, "");
  ASSERT_EQ(r.motion.inputs.size(), 1u);
  PhaseSensitivity const l{BodyId{0}, {1, 1, 0, 0, 0, 0}};
  EXPECT_NEAR(std::sqrt(r.motion.sensitivity(0, {&l, 1}, 1)) / 5e-6, 1, 1e-12);
}

TEST(ReadMotion, ResonanceAmplifies) {
  std::string const law = "power-law: {asd: 1e-9 m/sqrt(Hz), at: 1 Hz, exponent: 0, from: 0.01 Hz, to: 100 Hz}";
  Read const r =
      read("  a: {motion: {z: {" + law + ", resonance: {frequency: 1.14 Hz, quality: 1000}}, others: still}}\n", {"a"});
  ASSERT_EQ(r.problems, "");
  EXPECT_NEAR(std::sqrt(r.motion.inputs[0].spectrum.at(1.14)) / 1e-6, 1, 1e-5);
}

TEST(ReadMotion, UnusedBodyIsAWarning) {
  Read const r = read("  a: {motion: still}\n  b: {motion: still}\n", {"a"});
  EXPECT_EQ(r.problems, "");
  EXPECT_THAT(r.scene.warnings(), HasSubstr("body 'b'"));
}

TEST(ReadMotion, UnknownKeysAndKinds) {
  EXPECT_THAT(read("  a: {motion: {z: {petersen: low}, others: still}}\n", {"a"}).problems,
              HasSubstr("the kind of motion is missing"));
  EXPECT_THAT(read("  a: {motion: {z: stil, others: still}}\n", {"a"}).problems, HasSubstr("'stil' is not a motion"));
  EXPECT_THAT(read("  a: {motion: {z: {peterson: low, skale: 2}, others: still}}\n", {"a"}).problems,
              HasSubstr("did you mean 'scale'?"));
  EXPECT_THAT(read("  a: {motion: {z: {peterson: low, like: x}, others: still}}\n", {"a"}).problems,
              HasSubstr("cannot be both"));
}

TEST(ReadMotion, UncertaintyIsAFactorOnTheAsd) {
  Read const r = read(
      "  a:\n    motion:\n      uncertainty: 30 %\n      others: still\n      z: {peterson: low}\n"
      "      x: [{peterson: low, uncertainty: factor 2}, {line: {at: 1 Hz, width: 0.1 Hz, rms: 1 um rms}}]\n"
      "      y: {sine: {amplitude: 1 um peak, frequency: 3 Hz}}\n"
      "  b: {motion: {z: {like: x}, x: {peterson: high}, y: still}}\n"
      "  c: {motion: {follows: a}}\n",
      {"a", "b", "c"});
  ASSERT_EQ(r.problems, "");
  std::map<std::string, std::vector<double>> of;
  for (MotionInput const& i : r.motion.inputs) of[i.name].push_back(i.uncertainty);
  EXPECT_EQ(of["a z"], (std::vector{1.3}));
  EXPECT_EQ(of["a x"], (std::vector{2, 1.3}));  // known unequally: two inputs
  EXPECT_EQ(of["tone 3 Hz"], (std::vector{1.3}));
  EXPECT_EQ(of["b x"], (std::vector{1.0}));
  auto const rejected = [](std::string const& value) {
    return read("  a: {motion: {z: {peterson: low, uncertainty: " + value + "}, others: still}}\n", {"a"}).problems;
  };
  EXPECT_THAT(rejected("factor 0.5"), HasSubstr("at least 1"));
  EXPECT_THAT(rejected("3 m"), HasSubstr("'uncertainty' is a plain number"));
  EXPECT_THAT(rejected("-10 %"), HasSubstr("at least 0"));
  EXPECT_THAT(rejected("30"), HasSubstr("did you mean '30 %' or 'factor 30'?"));
  EXPECT_THAT(rejected("150 %"), HasSubstr("write 'factor 2.5'"));
  EXPECT_THAT(rejected("factor two"), HasSubstr("'factor' needs a plain number, got \"two\""));
  EXPECT_THAT(rejected("factor 1e9"), HasSubstr("at most 1e+06"));
  for (char const* accepted : {"0", "1", "100 %", "factor 1", "factor 3e1"})
    EXPECT_EQ(rejected(accepted), "") << accepted;
}

}  // namespace
}  // namespace straytrace::testing::noise_motion
