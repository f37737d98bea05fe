// SPDX-License-Identifier: BSD-3-Clause
// Files of motion that end inside the band of the noise, and bodies that light does not meet.
#include <cmath>

#include "motion/motion.hpp"
#include "spectra/files/series_file.hpp"
#include "support/recorded.hpp"
#include "support/scene_tables.hpp"

namespace straytrace::testing::noise_motion_gaps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr Band band{3, 1000};
constexpr double wavelength = 1064e-9;

std::vector<std::string> warnings(std::string const& bodies, std::vector<std::string> const& names, FileTexts files) {
  Scene const scene = scene_of("bodies:\n" + bodies, std::move(files));
  MotionSet const motion = read_motion(scene.root()["bodies"], names);
  EXPECT_EQ(problems_of(scene), "");
  std::vector<std::string> all;
  for (Problem const& p : warnings_of_gaps(motion.files, band, wavelength)) {
    EXPECT_EQ(p.severity, Severity::warning);
    EXPECT_GT(p.place.line, 0u);
    EXPECT_THAT(p.suggestion, AllOf(HasSubstr("power-law"), HasSubstr("'beyond: zero'"), HasSubstr("'band'")));
    all.push_back(p.what);
  }
  return all;
}
std::vector<std::string> along_z(std::string const& z, FileTexts files) {
  return warnings("  a: {motion: {z: " + z + ", others: still}}\n", {"a"}, std::move(files));
}

std::string const columns = ", columns: [Hz, m/sqrt(Hz)]";
FileTexts const texts = {{"whole.txt", "0.1 1e-12\n1000 1e-12\n"},
                         {"high.txt", "10 1e-12\n1000 1e-12\n"},
                         {"low.txt", "0.1 1e-9\n100 1e-12\n"},
                         {"middle.txt", "5 1e-12\n100 1e-12\n"}};

TEST(MotionGaps, EachFileOnceWithItsBand) {
  EXPECT_THAT(along_z("{asd: whole.txt" + columns + "}", texts), IsEmpty());
  auto const low = along_z("{asd: low.txt" + columns + "}", texts);
  ASSERT_EQ(low.size(), 1u);
  EXPECT_EQ(low[0],
            "'low.txt' gives the motion of 'a z' from 0.1 Hz to 100 Hz, and the noise covers 3 Hz to 1000 Hz: "
            "above 100 Hz the body counts as still");
  auto const middle = along_z("{asd: middle.txt" + columns + "}", texts);
  ASSERT_EQ(middle.size(), 1u);
  EXPECT_THAT(middle[0], AllOf(HasSubstr(": below 5 Hz and above 100 Hz the body counts as still"),
                               HasSubstr("; slow motion that is missing also changes how fringes wrap")));
  EXPECT_EQ(warnings("  a: {motion: {z: {asd: low.txt" + columns + "}, x: {asd: low.txt" + columns +
                         "}, y: {like: z}}}\n  b: {motion: {z: {asd: high.txt" + columns + "}, others: still}}\n",
                     {"a", "b"}, texts)
                .size(),
            2u);  // files
}

TEST(MotionGaps, OtherInputsOfTheCoordinateContinue) {
  std::string const low = "{asd: low.txt" + columns + "}",
                    model = "{power-law: {asd: 1e-12 m/sqrt(Hz), at: 1 Hz, exponent: 0, from: ";
  EXPECT_THAT(along_z("[" + low + ", " + model + "100 Hz, to: 2 kHz}}]", texts), IsEmpty());
  EXPECT_THAT(along_z("[" + low + ", {asd: high.txt" + columns + "}]", texts), IsEmpty());
  EXPECT_EQ(along_z("[" + low + ", " + model + "300 Hz, to: 2 kHz}}]", texts).size(), 1u);  // control: a hole between
  EXPECT_THAT(along_z("{asd: low.txt" + columns + ", beyond: zero}", texts), IsEmpty());
  EXPECT_THAT(warnings("  g: {motion: {z: {peterson: low}, others: still}}\n  a: {motion: {z: " + low +
                           ", others: still, relative_to: g}}\n",
                       {"g", "a"}, texts),
              IsEmpty());
}

// 2 v/lambda times 4 with v^2 = (2 pi)^2 a^2 f^4 (1/0.1 Hz - 1/f), by quadrature of the density that is assumed.
TEST(MotionGaps, SlowMotionThatWouldWrap) {  // docs/theory/spectra.md, eq. 7.8
  double const f0 = 8, a0 = 2e-9, steps = 200000, ratio = std::log(f0 / 0.1);
  double square = 0;
  for (double i = 0.5; i < steps; ++i) {
    double const f = 0.1 * std::exp(ratio * i / steps);
    square += std::pow(2 * pi * f * a0 * std::pow(f0 / f, 2), 2) * f * ratio / steps;
  }
  MotionFile file{"f", "a z", {f0, 2000}, {f0, 2000}, a0};
  EXPECT_NEAR(reach_of_missing(file, wavelength) / (4 * 2 * std::sqrt(square) / wavelength), 1, 1e-6);
  file.covered.low = 0.05;
  EXPECT_EQ(reach_of_missing(file, wavelength), 0);
  FileTexts const loud = {{"loud.txt", "2 1e-8\n1000 1e-12\n"}, {"quiet.txt", "2 1e-10\n1000 1e-12\n"}};
  auto const told = along_z("{asd: loud.txt" + columns + "}", loud);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_THAT(told[0], AllOf(HasSubstr("missing motion below 2 Hz changes how fringes wrap"), Not(HasSubstr("still"))));
  EXPECT_THAT(along_z("{asd: quiet.txt" + columns + "}", loud), IsEmpty());
  EXPECT_THAT(along_z("{asd: loud.txt" + columns + ", scale: 0.01}", loud), IsEmpty());
}

TEST(MotionGaps, RecordsAndMatrices) {
  TimeSeries const record{"A", "um", 0, 64, std::vector<double>(6400, 1.0)};
  FileTexts const files = {{"r.hdf5", series_hdf5({&record, 1})},
                           {"c.txt", "0.1 1e-24 0 0 1e-24\n50 1e-24 0 0 1e-24\n"}};
  auto const of_record = along_z("{series: r.hdf5}", files);
  ASSERT_EQ(of_record.size(), 1u);
  EXPECT_THAT(of_record[0], HasSubstr("above 32.04 Hz the body counts as still"));
  EXPECT_THAT(along_z("{series: r.hdf5, beyond: zero}", files), IsEmpty());
  auto const of_matrix = along_z("{csd: c.txt, form: cross, units: [m, m], member: 2}", files);
  ASSERT_EQ(of_matrix.size(), 1u);
  EXPECT_THAT(of_matrix[0], HasSubstr("above 50 Hz"));
}

TEST(MotionOfARun, MayOmitBodiesThatNoLightMeets) {
  auto const told = [](std::string const& bodies, bool traced, std::vector<bool> const& placed) {
    Scene const scene = scene_of("bodies:\n" + bodies, {});
    read_motion(scene.root()["bodies"], {"ground", "tower"}, traced, placed);
    return problems_of(scene) + scene.warnings();
  };
  std::string const tower = "  tower: {motion: {z: {peterson: low}, others: still}}\n",
                    ground = "  ground: {motion: still}\n";
  EXPECT_EQ(told(tower, true, {false, true}), "");
  EXPECT_THAT(told(tower, true, {true, true}), HasSubstr("body 'ground' has no motion"));
  EXPECT_THAT(told(ground, true, {false, true}), HasSubstr("body 'tower' has no motion"));
  EXPECT_THAT(told(tower + ground, true, {false, true}),
              HasSubstr("warning: body 'ground' moves, but no part belongs"));
  EXPECT_EQ(told(tower + ground, true, {true, true}), "");
  EXPECT_EQ(told(ground + "  tower: {motion: {follows: ground}}\n", true, {false, true}), "");
}

TEST(MotionOfARun, UncertaintyOfAMatrixCounts) {
  Scene const scene = scene_of(
      "bodies:\n  a: {motion: {uncertainty: 20 %, others: still, z: {csd: c.txt, form: cross, units: [m, m], member: "
      "1}}}\n",
      {{"c.txt", "1 1 0.5 0 1\n9 1 0.5 0 1\n"}});
  MotionSet const motion = read_motion(scene.root()["bodies"], {"a"});
  ASSERT_EQ(problems_of(scene), "");
  ASSERT_FALSE(motion.inputs.empty());
  for (MotionInput const& input : motion.inputs) EXPECT_EQ(input.uncertainty, 1.2);
}

}  // namespace
}  // namespace straytrace::testing::noise_motion_gaps
