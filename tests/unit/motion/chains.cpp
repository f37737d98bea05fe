// SPDX-License-Identifier: BSD-3-Clause
// Bodies that hang on others, that drift, and that move together as measured.
#include <fmt/format.h>

#include <cmath>

#include "motion/axis_motion.hpp"
#include "motion/motion.hpp"
#include "support/recorded.hpp"
#include "support/scene_tables.hpp"

namespace straytrace::testing::noise_motion_chains {
namespace {

using ::testing::HasSubstr;

struct Read {
  MotionSet motion;
  std::string problems;
};

Read read(std::string const& bodies, std::vector<std::string> const& names, FileTexts files = {}) {
  Scene const scene = scene_of("bodies:\n" + bodies, std::move(files));
  Read r;
  r.motion = read_motion(scene.root()["bodies"], names);
  r.problems = problems_of(scene);
  return r;
}

PhaseSensitivity phase_sensitivity(std::uint32_t body, int axis, double value) {
  PhaseSensitivity l{BodyId{body}, {}};
  l.d[axis] = value;
  return l;
}

// PSD of the phase of these phase sensitivities.
double psd(MotionSet const& m, std::vector<PhaseSensitivity> const& phase_sensitivities, double hz) {
  double sum = 0;
  for (std::size_t i = 0; i < m.inputs.size(); ++i)
    if (double const s = m.inputs[i].spectrum.at(hz); s > 0) sum += m.sensitivity(i, phase_sensitivities, hz) * s;
  return sum;
}

std::string const ground =
    "  ground: {motion: {z: {power-law: {asd: 1e-6 m/sqrt(Hz), at: 1 Hz, exponent: -2, from: 0.1 Hz, to: 100 Hz}}, x: "
    "{like: z}, y: {like: z}}}\n";

TEST(MotionChains, GroundStructureScatterer) {  // R2.16, eq. 11.2
  Read const r =
      read(ground +
               "  bench: {motion: {x: {from: ground, axis: z, through: [{file: table.txt, columns: [Hz, re, im]}, "
               "{resonance: {frequency: 8 Hz, quality: 50}}], scale: 0.5}, others: still}}\n",
           {"ground", "bench"}, {{"table.txt", "0.1 2 0\n10 2 0\n100 2 0\n"}});
  ASSERT_EQ(r.problems, "");
  for (double f : {0.5, 7.9, 30.0}) {
    double const x = f / 8, y = x / 50, t2 = (1 + y * y) / (std::pow(1 - x * x, 2) + y * y);
    EXPECT_NEAR(psd(r.motion, {phase_sensitivity(1, 0, 1)}, f) / (t2 * psd(r.motion, {phase_sensitivity(0, 2, 1)}, f)),
                1, 1e-9)
        << f;
    EXPECT_EQ(psd(r.motion, {phase_sensitivity(1, 2, 1)}, f), 0);
  }
  // Coherent with the ground: far below the resonance it moves with it (times 0.5 times 2).
  EXPECT_LT(psd(r.motion, {phase_sensitivity(1, 0, 1), phase_sensitivity(0, 2, -1)}, 0.11),
            1e-6 * psd(r.motion, {phase_sensitivity(0, 2, 1)}, 0.11));
}

// R2.16: 1e-6 m at 1 Hz falling as f^-2: 1e-8 at 10 Hz; behind two pendulums another (f_1 f_2 / f^2)^2.
TEST(MotionChains, SuspendedBody) {
  std::string const stages = "[{frequency: 0.6 Hz, quality: 10}, {frequency: 1.2 Hz, quality: 10}]";
  Read const r =
      read(ground + "  mirror: {motion: {suspended: {from: ground, vertical: y, stages: " + stages + "}, y: still}}\n",
           {"ground", "mirror"});
  ASSERT_EQ(r.problems, "");
  EXPECT_NEAR(std::sqrt(psd(r.motion, {phase_sensitivity(0, 2, 1)}, 10)), 1e-8, 1e-14);
  EXPECT_NEAR(
      std::sqrt(psd(r.motion, {phase_sensitivity(1, 2, 1)}, 50)) / (1e-6 / 2500 * 0.36 * 1.44 / std::pow(50, 4)), 1,
      2e-3);
  EXPECT_EQ(psd(r.motion, {phase_sensitivity(1, 1, 1)}, 10), 0);
  EXPECT_GT(psd(r.motion, {phase_sensitivity(1, 0, 1)}, 10), 0);
  EXPECT_NEAR(psd(r.motion, {phase_sensitivity(1, 2, 1)}, 0.1) / psd(r.motion, {phase_sensitivity(0, 2, 1)}, 0.1), 1.07,
              0.02);
  EXPECT_THAT(read(ground + "  m: {motion: {suspended: {from: ground, vertical: y, stages: " + stages + "}}}\n", {"m"})
                  .problems,
              HasSubstr("has no motion along y"));
  EXPECT_THAT(
      read(ground + "  m: {motion: {suspended: {from: grund, vertical: y, stages: " + stages + "}, y: still}}\n", {"m"})
          .problems,
      HasSubstr("did you mean 'ground'?"));
  EXPECT_THAT(
      read(ground + "  m: {motion: {suspended: {from: ground, stages: " + stages + "}, y: still}}\n", {"m"}).problems,
      HasSubstr("vertical"));
}

// Two equal masses on equal threads: w^2 = (2 -+ sqrt 2) g/l. One mass: g/l.
TEST(MotionChains, NormalModesOfPendulums) {
  double const w2 = 9.80665 / 0.8;
  std::vector<double> const one = pendulum_modes({40}, {0.8}), two = pendulum_modes({3, 3}, {0.8, 0.8});
  EXPECT_NEAR(one.at(0), std::sqrt(w2) / (2 * pi), 1e-12);
  EXPECT_NEAR(two.at(0), std::sqrt((2 - std::sqrt(2)) * w2) / (2 * pi), 1e-12);
  EXPECT_NEAR(two.at(1), std::sqrt((2 + std::sqrt(2)) * w2) / (2 * pi), 1e-12);
  Read const r =
      read(ground +
               "  m: {motion: {x: {from: ground, through: {pendulum: {masses: [3 kg, 3 kg], lengths: [0.8 m, "
               "0.8 m], quality: 1e6}}}, others: still}}\n",
           {"ground", "m"});
  ASSERT_EQ(r.problems, "");
  // The chain solved directly: k_2 (x_1 - x_2) = -w^2 m x_2, ..., at 2 Hz.
  double const m = 3, k1 = 2 * m * w2, k2 = m * w2, w = std::pow(4 * pi, 2),
               direct = k1 * k2 / ((k1 + k2 - w * m) * (k2 - w * m) - k2 * k2);
  EXPECT_NEAR(psd(r.motion, {phase_sensitivity(1, 0, 1)}, 2) /
                  (direct * direct * psd(r.motion, {phase_sensitivity(0, 0, 1)}, 2)),
              1, 1e-6);
  EXPECT_THAT(read(ground + "  m: {motion: {x: {from: ground, through: {pendulum: {masses: [3 kg], lengths: [], "
                            "quality: 5}}}, others: still}}\n",
                   {"m"})
                  .problems,
              HasSubstr("as many lengths as masses"));
}

TEST(MotionChains, FollowsThroughAChain) {
  Read const r =
      read(ground +
               "  tower: {motion: {follows: ground, through: {resonance: {frequency: 12 Hz, quality: 20}}}}\n"
               "  bench: {motion: {follows: tower, through: {pendulum: {frequency: 0.5 Hz, quality: 5}}}}\n"
               "  control: {motion: {follows: tower, through: {pendulum: {frequency: 0.5 Hz, quality: 5}}}}\n",
           {"ground", "tower", "bench", "control"});
  ASSERT_EQ(r.problems, "");
  EXPECT_EQ(psd(r.motion, {phase_sensitivity(2, 0, 1), phase_sensitivity(3, 0, -1)}, 3), 0);
  double const x = 12 / 0.5, drop = std::pow(1 - x * x, 2) + std::pow(x / 5, 2);
  EXPECT_NEAR(psd(r.motion, {phase_sensitivity(2, 1, 1)}, 12) / psd(r.motion, {phase_sensitivity(1, 1, 1)}, 12) * drop,
              1, 1e-9);
  // Equal chains are one object: one class of motion, not two.
  Gain const *bench = nullptr, *control = nullptr;
  for (Gain const& g : r.motion.inputs.at(0).gains) (g.body.value == 2 ? bench : control) = &g;
  EXPECT_EQ(bench->transfer, control->transfer);
  EXPECT_THAT(
      read(ground + "  a: {motion: {through: {pendulum: {frequency: 1 Hz, quality: 5}}, others: still}}\n", {"a"})
          .problems,
      HasSubstr("the one it follows"));
}

TEST(MotionChains, TonesAndDriftsPassToo) {
  Read const r = read(
      "  a: {motion: {z: [{sine: {amplitude: 1 um peak, frequency: 2 Hz}}, {drift: 2 um/h}], others: still}}\n"
      "  b: {motion: {follows: a, through: {pendulum: {frequency: 1 Hz, quality: 10}}}}\n"
      "  c: {motion: {z: {drift: -1 um/h}, rx: {drift: 1 urad/s}, others: still}}\n",
      {"a", "b", "c"});
  ASSERT_EQ(r.problems, "");
  ASSERT_EQ(r.motion.inputs.size(), 2u);
  MotionInput const& tone = r.motion.inputs[0];
  // For exp(+2 pi i f t) the pendulum is 1/(1 - x^2 + i x/Q): behind its resonance the mass moves against the support.
  std::complex<double> const expected = 1e-6 / std::complex<double>(1 - 4, 2.0 / 10);
  EXPECT_LT(std::abs(tone.gains.at(1).value - expected), 1e-18);
  EXPECT_GT(std::abs(tone.gains.at(1).value - std::conj(expected)), 1e-9);  // control: the other sign of time
  MotionInput const& drift = r.motion.inputs[1];
  EXPECT_TRUE(drift.drift);
  double const v = 1e-6 / 3600;
  EXPECT_NEAR(
      std::sqrt(r.motion.sensitivity(1, std::vector{phase_sensitivity(0, 2, 1), phase_sensitivity(2, 2, -1)}, 0)) /
          (3 * v),
      1, 1e-12);
  EXPECT_EQ(r.motion.sensitivity(1, std::vector{phase_sensitivity(0, 2, 1), phase_sensitivity(1, 2, -1)}, 0),
            0);  // a pendulum follows slowly
  EXPECT_THAT(read("  a: {motion: {z: {drift: 2 um}, others: still}}\n", {"a"}).problems, HasSubstr("is a speed"));
  EXPECT_THAT(read("  a: {motion: {z: {drift: 2 um/h}, x: {like: z}, y: still}}\n", {"a"}).problems,
              HasSubstr("no independent copy"));
}

TEST(MotionChains, Impossible) {
  auto const problem = [](std::string const& a, FileTexts files = {}) {
    return read(ground + "  a: {motion: {z: " + a + ", others: still}}\n", {"a"}, std::move(files)).problems;
  };
  EXPECT_THAT(problem("{from: grund}"), HasSubstr("did you mean 'ground'?"));
  EXPECT_THAT(problem("{from: ground, axis: rx}"), HasSubstr("one is a translation, one a rotation"));
  EXPECT_THAT(problem("{from: a}"), HasSubstr("refers to itself"));
  EXPECT_THAT(problem("{from: ground, through: {spring: 3}}"),
              HasSubstr("the kind of this link of a chain is missing"));
  EXPECT_THAT(problem("{from: ground, through: {resonance: {frequency: 3 Hz}}}"), HasSubstr("quality"));
  EXPECT_THAT(problem("{from: ground, through: {file: t.txt, columns: [Hz, re, im]}}", {{"t.txt", "1 1 0\n50 1 0\n"}}),
              HasSubstr("covers 1 Hz to 50 Hz, but the motion 0.1 Hz to 100 Hz"));
  EXPECT_EQ(problem("{from: ground, through: {file: t.txt, columns: [Hz, re, im], beyond: hold}}",
                    {{"t.txt", "1 1 0\n50 1 0\n"}}),
            "");
  EXPECT_THAT(
      read("  a: {motion: {z: {from: b}, others: still}}\n  b: {motion: {x: {from: a}, others: still}}\n", {"a", "b"})
          .problems,
      HasSubstr("refers to itself through"));
}

// --- cross spectra -------------------------------------------------------------------------------------------------

TEST(CrossSpectra, FactorGivesTheMatrixBack) {
  using C = std::complex<double>;
  ComplexMatrix const c = {{4.0, C(1, 1), C(0, -2)}, {C(1, -1), 3.0, C(0.5, 0)}, {C(0, 2), C(0.5, 0), 2.0}};
  ComplexMatrix const l = cholesky(c).value();
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      C sum = 0;
      for (std::size_t k = 0; k < 3; ++k) sum += l[i][k] * std::conj(l[j][k]);
      EXPECT_LT(std::abs(sum - c[i][j]), 1e-14);
    }
  EXPECT_TRUE(cholesky({{1.0, 1.0}, {1.0, 1.0}}));                                // fully coherent
  EXPECT_FALSE(cholesky({{1.0, 1.1}, {1.1, 1.0}}));                               // more than that
  EXPECT_FALSE(cholesky({{1.0, 0.9, 0.9}, {0.9, 1.0, -0.9}, {0.9, -0.9, 1.0}}));  // pairs are possible, all are not
}

// Two bodies at coherence 0.64 and phase 60 degrees: relative motion S_1 + S_2 - 2 Re S_12.
TEST(CrossSpectra, RelativeMotion) {
  double const s1 = 4e-12, s2 = 9e-12, cross = 0.8 * std::sqrt(s1 * s2);
  std::string rows, coherent, full;
  for (double f : {0.1, 1.0, 100.0}) {
    double const re = cross * 0.5, im = cross * std::sqrt(0.75);
    rows += fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g}\n", f, s1, re, im, s2);
    coherent += fmt::format("{} {:.17g} {:.17g} 0.64 60\n", f, s1, s2);
    full += fmt::format("{0} {1:.17g} 0 {2:.17g} {3:.17g} {2:.17g} {4:.17g} {5:.17g} 0\n", f, s1, re, im, -im, s2);
  }
  FileTexts const files = {{"cross.txt", rows}, {"coherence.txt", coherent}, {"matrix.txt", full}};
  for (std::string const form : {"cross", "coherence", "matrix"}) {
    std::string const spec = "{csd: " + form + ".txt, form: " + form + ", units: [m, m], member: ";
    Read const r = read("  a: {motion: {z: " + spec + "1}, others: still}}\n  b: {motion: {x: " + spec +
                            "2, scale: 2}, others: still}}\n",
                        {"a", "b"}, files);
    ASSERT_EQ(r.problems, "") << form;
    EXPECT_NEAR(psd(r.motion, {phase_sensitivity(0, 2, 1)}, 5) / s1, 1, 1e-9);
    EXPECT_NEAR(psd(r.motion, {phase_sensitivity(1, 0, 1)}, 5) / (4 * s2), 1, 1e-9);
    EXPECT_NEAR(psd(r.motion, {phase_sensitivity(0, 2, 1), phase_sensitivity(1, 0, -0.5)}, 5) / (s1 + s2 - cross), 1,
                1e-9)
        << form;
    EXPECT_GT(std::fabs(psd(r.motion, {phase_sensitivity(0, 2, 1), phase_sensitivity(1, 0, -0.5)}, 5) / (s1 + s2) - 1),
              0.1);  // negative control
  }
}

// A velocity and a displacement: S_12 of x and v = dx/dt of the same motion is i w S_x (scipy.signal.csd(x, v)).
TEST(CrossSpectra, UnitsOfTheMembers) {
  std::string rows;
  for (double f : {0.5, 1.0, 2.0, 4.0}) {
    double const w = 2 * pi * f;
    rows += fmt::format("{} {:.17g} 0 {:.17g} {:.17g}\n", f, 1e-12, 1e-12 * w, 1e-12 * w * w);
  }
  std::string const spec = "{csd: x.txt, form: cross, units: [m, m/s], member: ";
  Read const r =
      read("  a: {motion: {z: " + spec + "1}, others: still}}\n  b: {motion: {z: " + spec + "2}, others: still}}\n",
           {"a", "b"}, {{"x.txt", rows}});
  ASSERT_EQ(r.problems, "");
  for (double f : {0.7, 1.0, 3.0}) {
    EXPECT_NEAR(psd(r.motion, {phase_sensitivity(1, 2, 1)}, f) / 1e-12, 1, 1e-6);
    EXPECT_LT(psd(r.motion, {phase_sensitivity(0, 2, 1), phase_sensitivity(1, 2, -1)}, f), 1e-20);  // one motion
  }
}

TEST(CrossSpectra, InvalidMatricesAreErrors) {
  auto const problem = [](std::string const& rows, std::string const& rest) {
    return read("  a: {motion: {z: {csd: x.txt, " + rest + "}, others: still}}\n", {"a"}, {{"x.txt", rows}}).problems;
  };
  std::string const good = "form: cross, units: [m, m], member: 1";
  EXPECT_THAT(problem("1 1 0 0 1\n3 1 1.2 0 1\n", good), HasSubstr("at 3 Hz: the matrix is not positive semidefinite"));
  EXPECT_THAT(problem("1 1 0 0\n3 1 1 0\n", good), HasSubstr("has 5 columns"));
  EXPECT_THAT(problem("1 1 0 0 1\n1 1 0 0 1\n", good), HasSubstr("at 1 Hz: frequencies must be positive and rise"));
  EXPECT_THAT(problem("1 1 0 0 1\n3 1 0 0 1\n", "form: cross, units: [m, m], member: 3"), HasSubstr("no member 3"));
  EXPECT_THAT(problem("1 1\n3 1\n", "form: cross, units: [m], member: 1"), HasSubstr("units of all"));
  EXPECT_THAT(problem("1 1 0 0 1\n3 1 0 0 1\n", "form: cross, units: [rad, m], member: 1"),
              HasSubstr("not a unit of a motion"));
  EXPECT_THAT(problem("1 1 0 2 0 1 0 1 0\n2 1 0 2 0 1 0 1 0\n", "form: matrix, units: [m, m], member: 1"),
              HasSubstr("not Hermitian"));
}

// --- elastic modes -------------------------------------------------------------------------------------------------

TEST(ModeMotion, AModeIsASeparateCoordinate) {
  std::string const bench =
      "  bench:\n    motion: {follows: ground}\n    modes:\n      bend: {motion: {from: ground, axis: y, through: "
      "{mode: "
      "{frequency: 30 Hz, quality: 200}}, scale: 1.3}}\n";
  std::vector<std::string> const names = {"ground", "bench", "bench/bend"};
  Read const r = read(ground + bench, names);
  ASSERT_EQ(r.problems, "");
  EXPECT_NEAR(psd(r.motion, {phase_sensitivity(2, 0, 1)}, 30) /
                  (std::pow(1.3 * 200, 2) * psd(r.motion, {phase_sensitivity(0, 1, 1)}, 30)),
              1, 1e-9);
  EXPECT_NEAR(psd(r.motion, {phase_sensitivity(2, 0, 1)}, 3) /
                  (std::pow(1.3 / 99, 2) * psd(r.motion, {phase_sensitivity(0, 1, 1)}, 3)),
              1, 1e-5);
  EXPECT_THAT(read(ground + "  bench: {motion: {follows: ground}, modes: {bend: {shape: {}}}}\n", names).problems,
              HasSubstr("mode 'bench/bend' has no 'motion'"));
  EXPECT_THAT(read(ground + "  bench: {motion: {follows: ground}}\n", names).problems,
              HasSubstr("mode 'bench/bend' has no motion"));
  EXPECT_THAT(
      read(ground + "  bench: {motion: {follows: ground}, modes: {bend: {motion: {from: grount}}}}\n", names).problems,
      HasSubstr("did you mean 'ground'?"));
}

}  // namespace
}  // namespace straytrace::testing::noise_motion_chains
