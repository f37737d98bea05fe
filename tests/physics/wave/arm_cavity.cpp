// SPDX-License-Identifier: BSD-3-Clause
// The cavity of a scene as planes of a wave computation (docs/theory/wave.md): its frame, its rims, its grid, and what
// its mirrors scatter beyond the crossover angle (eq. W.2).
#include "wave/arm/arm_cavity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/math/constants.hpp"
#include "physics/wave/kilometre_arm.hpp"
#include "support/message_of.hpp"
#include "support/recorded.hpp"

namespace straytrace::wave_arm_cavity {
namespace {

using ::testing::AllOf;
using testing::deviation;
using ::testing::HasSubstr;
using testing::kilometre_arm;
using testing::KilometreArm;

constexpr char perfect[] = "maps: {I: {spectrum: none}, E: {spectrum: none}}";
constexpr double nd_yag = 1064e-9;  // m
// Of the mode: w^2 = (lambda L/pi)/sqrt(1 - g^2) at mirrors with g = 0.6 both.
double const spot = std::sqrt(nd_yag * 1000 / (pi * 0.8)), slope = 2.5 * spot / 2500;

ArmCavity cavity_of(KilometreArm const& scene) {
  World const world = scene.world();
  return arm_cavity(world, world.wave);
}
ArmCavity cavity_with(std::string const& settings) {
  return cavity_of(kilometre_arm(settings + ", " + std::string(perfect)));
}
// Those of the key `key`.
std::vector<ArmProblem> problems_of(ArmCavity const& arm, std::string const& key) {
  std::vector<ArmProblem> found = arm.problems;
  std::erase_if(found, [&](ArmProblem const& p) { return p.keys.front() != key; });
  return found;
}
std::string problem_with(std::string const& settings) {
  return test::message_of([&] { cavity_with(settings); });
}

TEST(ArmCavity, MirrorsAndRimsInTheirOrder) {
  KilometreArm scene;
  scene.baffles +=
      "  - {name: baffle_three, shape: {disk: {inner_radius: 60 mm, outer_radius: 30 cm}}, at: [3 mm, 4 mm, 500 m],"
      " facing: [0, 0, 1], body: pipe, material: black}\n"
      "  - {name: baffle_behind, shape: {disk: {inner_radius: 60 mm, outer_radius: 30 cm}}, at: [0 m, 0 m, 1500 m],"
      " facing: [0, 0, 1], body: pipe, material: black}\n";
  World const world = scene.world();
  ArmCavity const arm = arm_cavity(world, world.wave);
  EXPECT_LT(deviation(arm.cavity.length, 1000), 1e-12);
  for (ArmMirror const& m : arm.mirrors) {
    EXPECT_LT(deviation(m.radius, 0.075), 1e-12);
    EXPECT_LT(deviation(m.curvature, 1 / 2500.), 1e-12);
    EXPECT_LT(deviation(m.spot, spot), 1e-6);
  }
  ASSERT_EQ(arm.rims.size(), 3u);  // not that behind the end mirror
  ASSERT_EQ(arm.cavity.baffles.size(), 3u);
  char const* const names[] = {"baffle_one", "baffle_three", "baffle_two"};
  double const places[] = {400, 500, 600}, radii[] = {0.045, 0.06, 0.045}, shifts[] = {0, 0.005, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    ArmRim const& rim = arm.rims[i];
    EXPECT_EQ(world.name_of(rim.surface), names[i]);
    EXPECT_LT(deviation(rim.centre.z, places[i]), 1e-12);
    EXPECT_LT(deviation(rim.angle1, std::atan((radii[i] + shifts[i]) / places[i])), 1e-12);
    EXPECT_LT(deviation(rim.angle2, std::atan((radii[i] + shifts[i]) / (1000 - places[i]))), 1e-12);
    EXPECT_LT(deviation(arm.cavity.baffles[i].rim.radius, radii[i]), 1e-12);
    EXPECT_LT(deviation(arm.cavity.baffles[i].place, places[i]), 1e-12);
  }
  EXPECT_NEAR(arm.cavity.baffles[1].rim.x, 3e-3, 1e-15);
  EXPECT_NEAR(arm.cavity.baffles[1].rim.y, 4e-3, 1e-15);
}

// Both mirrors must see a rim below the angle: rims of 112.5 and 75 urad.
TEST(ArmCavity, RimsWithinTheAngle) {
  for (ArmRim const& rim : cavity_with("crossover: 113 urad").rims) EXPECT_TRUE(rim.in_band);
  for (ArmRim const& rim : cavity_with("crossover: 112 urad").rims) EXPECT_FALSE(rim.in_band);
}

// Right-handed, from mirror 1 to mirror 2, along any axis of the scene.
TEST(ArmCavity, FrameAlongTheBeam) {
  KilometreArm scene;
  scene.baffles =
      "  - {name: baffle, shape: {disk: {inner_radius: 45 mm, outer_radius: 30 cm}}, at: [400 m, 1 mm, 2 mm],"
      " facing: [1, 0, 0], body: pipe, material: black}\n";
  scene.input = "facing: [1, 0, 0]";
  scene.end = "at: [1000 m, 0 m, 0 m], facing: [-1, 0, 0]";
  ArmCavity const arm = cavity_of(scene);
  CavityFrame const& frame = arm.frame;
  EXPECT_NEAR(length(frame.z - Vec3{1, 0, 0}), 0, 1e-15);
  EXPECT_NEAR(length(frame.x - Vec3{0, 1, 0}), 0, 1e-15);
  EXPECT_NEAR(length(cross(frame.x, frame.y) - frame.z), 0, 1e-15);
  EXPECT_NEAR(length(arm.rims.at(0).centre - Vec3{1e-3, 2e-3, 400}), 0, 1e-12);
  EXPECT_NEAR(length(frame.to_world(frame.to_local({7, 5, 3})) - Vec3{7, 5, 3}), 0, 1e-12);
}

// kappa theta^-2 beyond an angle: 2 pi kappa times the integral of sin(2 theta)/(2 theta^2) up to pi/2, which is
// 1 + Ci(pi) - Ci(2 theta) with Ci(x) = 0.577216 + ln x for small x.
TEST(ArmCavity, ScatteredBeyondTheAngle) {
  double const ci_pi = 0.0736679120464255, euler = 0.5772156649015329;
  for (double angle : {100e-6, 120e-6}) {
    ArmCavity const arm = cavity_with(angle > 110e-6 ? "crossover: 120 urad" : "crossover: 100 urad");
    double const beyond = 2 * pi * 5e-7 * (1 + ci_pi - euler - std::log(2 * angle));
    for (ArmMirror const& m : arm.mirrors) EXPECT_LT(deviation(m.scattered, beyond), 1e-6);
    EXPECT_LT(deviation(arm.cavity.mirror1.scattered, beyond), 1e-6);
    // Negative control: small angles up to pi/2, as eq. 3.18 integrates.
    EXPECT_GT(deviation(arm.mirrors[0].scattered, 2 * pi * 5e-7 * std::log(pi / 2 / angle)), 1e-3);
  }
}

// Heights below the crossover angle: their variance is the sum of S2/window^2 over the frequencies of the grid, with
// S2 = brdf lambda^4/(16 pi^2) (eq. W.20). The first few of them carry most of it: the rms of one draw varies by 6 %.
TEST(ArmCavity, HeightsOfTheMirrors) {
  EXPECT_TRUE(cavity_with("crossover: 120 urad").cavity.mirror1.height.empty());
  ArmCavity const arm = cavity_of({});
  double variance = 0;
  double const step = nd_yag / 0.5;  // angle of one period in the window
  for (int row = -100; row <= 100; ++row)
    for (int column = -100; column <= 100; ++column)
      if (double const angle = step * std::hypot(row, column); angle > 0 && angle <= 120e-6)
        variance += 5e-7 / (angle * angle) * std::pow(nd_yag, 4) / (16 * pi * pi) / (0.5 * 0.5);
  for (ArmMirror const& m : arm.mirrors) {
    EXPECT_LT(deviation(m.roughness, std::sqrt(variance)), 0.3);
    EXPECT_GT(deviation(m.roughness, std::sqrt(2 * variance)), 0.05);  // negative control: both halves twice
  }
  // Each mirror has heights of its own, also with the same seed.
  std::vector<double> const& heights = arm.cavity.mirror1.height;
  EXPECT_EQ(heights.size(), 256u * 256u);
  EXPECT_NE(heights, arm.cavity.mirror2.height);
  EXPECT_EQ(heights, cavity_of({}).cavity.mirror1.height);
  ArmCavity const other =
      cavity_of(kilometre_arm("crossover: 120 urad, grid: {points: 256, window: 0.5 m}, maps: {I: {seed: 2}}"));
  EXPECT_NE(heights, other.cavity.mirror1.height);
  EXPECT_EQ(arm.cavity.mirror2.height, other.cavity.mirror2.height);
}

std::string disk(std::string const& name, std::string const& at, std::string const& facing = "[0, 0, 1]") {
  return "  - {name: " + name + ", shape: {disk: {inner_radius: 45 mm, outer_radius: 30 cm}}, at: " + at +
         ", facing: " + facing + ", body: pipe, material: black}\n";
}

TEST(ArmCavity, ChoosesTheAngle) {
  EXPECT_LT(deviation(cavity_with("draws: 1, tolerance: {radius: 0 mm}").crossover, 20 * nd_yag / (pi * spot)), 1e-6);
  EXPECT_LT(deviation(cavity_with("crossover: 90 urad").crossover, 90e-6), 1e-12);
}

// 0.6 of Nyquist's frequency holds the angle and the slopes of the mode; half the points would not.
TEST(ArmCavity, ChoosesTheGrid) {
  for (char const* const angle : {"crossover: 90 urad", "crossover: 120 urad", "crossover: 250 urad"}) {
    KilometreArm scene = kilometre_arm(std::string(angle) + ", " + perfect);
    scene.baffles = disk("baffle_a", "[0 m, 0 m, 500 m]");
    ArmCavity const arm = cavity_of(scene);
    Grid const& grid = arm.cavity.grid;
    Grid const coarse{grid.points / 2, grid.window};
    EXPECT_GE(0.6 * grid.largest_angle(nd_yag), arm.crossover + slope) << angle;
    EXPECT_LT(0.6 * coarse.largest_angle(nd_yag), arm.crossover + slope) << angle;
    // eq. W.6 for the mirrors: light within 150 mm at both ends, and 5 widths of Fresnel diffraction.
    EXPECT_LT(deviation(grid.window, 0.3 + 5 * std::sqrt(nd_yag * 1000)), 1e-12);
  }
  EXPECT_EQ(cavity_with("crossover: 120 urad, grid: {points: 300}").cavity.grid.points, 300);
  EXPECT_EQ(cavity_with("crossover: 120 urad, grid: {window: 0.6 m}").cavity.grid.window, 0.6);
}

// Edges that clip the mode and stand next to each other: the angle of eq. W.5 between them decides, 450 + 73 urad for
// 45 mm and 200 m. Controls: edges clear of the mode, and a number of points that suffices.
TEST(ArmCavity, ChoosesTheGridOfEdgesThatLightEachOther) {
  double const angle = 0.09 / 200 + std::sqrt(nd_yag / 200);
  ArmCavity const arm = cavity_with("crossover: 120 urad");
  EXPECT_GE(0.6 * arm.cavity.grid.largest_angle(nd_yag), angle);
  EXPECT_LT(0.3 * arm.cavity.grid.largest_angle(nd_yag), angle);
  EXPECT_TRUE(problems_of(arm, "grid").empty());
  std::vector<ArmProblem> const few =
      problems_of(cavity_with("crossover: 120 urad, grid: {points: 512, window: 0.47 m}"), "grid");
  ASSERT_EQ(few.size(), 1u);
  EXPECT_EQ(few[0].severity, Severity::warning);
  EXPECT_THAT(few[0].what, AllOf(HasSubstr("reaches 523 urad"), HasSubstr("carries 348 urad")));
  EXPECT_THAT(few[0].remedy, HasSubstr("state 'points: 800'"));
  EXPECT_TRUE(problems_of(cavity_with("crossover: 120 urad, grid: {points: 800, window: 0.47 m}"), "grid").empty());
  KilometreArm wide = kilometre_arm("crossover: 250 urad, " + std::string(perfect));
  for (std::size_t at; (at = wide.baffles.find("45 mm")) != std::string::npos;) wide.baffles.replace(at, 5, "74 mm");
  // eq. W.64: from the outline of a mirror of 75 mm to the edge 400 m away; 270 urad are the crossover angle and the
  // slope.
  double const from_outline = (0.075 + 0.074) / 400;
  Grid const grid = cavity_of(wide).cavity.grid;
  EXPECT_GE(0.6 * grid.largest_angle(nd_yag), from_outline);
  EXPECT_LT(0.3 * grid.largest_angle(nd_yag), from_outline);
  EXPECT_GT(0.3 * grid.largest_angle(nd_yag), 0.25e-3 + slope);  // control: half the points would do for these
}

std::string problem_of_baffles(std::string const& baffles, std::string const& crossover = "120 urad") {
  KilometreArm arm = kilometre_arm("crossover: " + crossover + ", " + std::string(perfect));
  arm.baffles = baffles;
  return test::message_of([&] { cavity_of(arm); });
}

// Each with its control: the same edge where the field or W.22 describes it.
TEST(ArmCavity, EdgesThatItDoesNotDescribeAreErrors) {
  EXPECT_THAT(problem_of_baffles(disk("baffle_a", "[0 m, 0 m, 500 m]", "[0.5, 0, 1]")),
              HasSubstr("is tilted by 26.6 deg"));
  EXPECT_EQ(problem_of_baffles(disk("baffle_a", "[0 m, 0 m, 500 m]", "[0.05, 0, 1]")), "no error");
  // Off the axis, beyond the crossover angle: light of the mode itself meets the edge.
  EXPECT_THAT(problem_of_baffles(disk("baffle_a", "[0.03 m, 0 m, 300 m]")),
              HasSubstr("light of the mode itself meets the edge"));
  EXPECT_EQ(problem_of_baffles(disk("baffle_a", "[0.001 m, 0 m, 300 m]"), "60 urad"), "no error");
  EXPECT_EQ(problem_of_baffles(disk("baffle_a", "[0.03 m, 0 m, 500 m]"), "160 urad"), "no error");
  // Two errors at once.
  std::string const two = problem_of_baffles(disk("baffle_a", "[0 m, 0 m, 500 m]", "[0.5, 0, 1]") +
                                             disk("baffle_b", "[0 m, 0 m, 600 m]", "[0.5, 0, 1]"));
  EXPECT_THAT(two, AllOf(HasSubstr("'baffle_a' at 500 m"), HasSubstr("'baffle_b' at 600 m")));
}

TEST(ArmCavity, EdgesOutsideAreAWarning) {
  KilometreArm arm = kilometre_arm("crossover: 120 urad, " + std::string(perfect));
  arm.baffles = disk("baffle_a", "[0 m, 0 m, 500 m]") + disk("baffle_b", "[0 m, 0 m, 1010 m]");
  std::vector<ArmProblem> const problems = problems_of(cavity_of(arm), "baffles");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0].what, HasSubstr("1 of the 2 inner edges"));
  EXPECT_EQ(problems[0].severity, Severity::warning);
  EXPECT_THAT(problems[0].keys, ::testing::ElementsAre("baffles"));
  arm.baffles = disk("baffle_a", "[0 m, 0 m, 500 m]");
  EXPECT_TRUE(problems_of(cavity_of(arm), "baffles").empty());
}

// A perfect mirror in the field and rays that begin at the crossover angle leave its light at small angles out, each
// with its place. Control: heights of the material.
TEST(ArmCavity, PerfectMirrorsThatScatterAreAWarning) {
  std::vector<ArmProblem> const perfect_ones = problems_of(cavity_with("crossover: 120 urad"), "maps");
  ASSERT_EQ(perfect_ones.size(), 2u);
  EXPECT_THAT(perfect_ones[1].keys, ::testing::ElementsAre("maps", "E", "spectrum"));
  EXPECT_THAT(perfect_ones[0].what, HasSubstr("of the light within 120 urad by its BSDF"));
  EXPECT_EQ(perfect_ones[0].severity, Severity::warning);
  EXPECT_TRUE(problems_of(cavity_of(kilometre_arm("crossover: 120 urad")), "maps").empty());
}

TEST(ArmCavity, WindowsAndTolerancesOutOfProportionAreErrors) {
  EXPECT_THAT(problem_with("crossover: 120 urad, grid: {points: 2048, window: 0.2 m}"),
              AllOf(HasSubstr("light would wrap around it"), HasSubstr("state 'window: ")));
  EXPECT_THAT(problem_with("crossover: 120 urad, tolerance: {radius: 1 cm}"),
              HasSubstr("a tolerance of 0.01 m is too large"));
  EXPECT_EQ(problem_with("crossover: 120 urad, tolerance: {radius: 1 mm}"), "no error");
}

TEST(ArmCavity, GridsTooCoarseAreExplained) {
  int const needed = int(std::ceil(2 * 0.5 * (120e-6 + slope) / 0.6 / nd_yag));
  EXPECT_EQ(needed, 221);
  EXPECT_THAT(problem_with("crossover: 120 urad, grid: {points: 216, window: 0.5 m}"),
              AllOf(HasSubstr("a grid of 216 points over 0.5 m does not carry"), HasSubstr("state 'points: 240'")));
  EXPECT_EQ(problem_with("crossover: 120 urad, grid: {points: 240, window: 0.5 m}"), "no error");  // control
  EXPECT_THAT(problem_with("crossover: 10 mrad"),
              AllOf(HasSubstr("choose a 'crossover' of at most"), HasSubstr("8192 points")));
}

// The models of a mirror count one by one: a Lambertian one beside that with `above` does not hide the gap.
TEST(ArmCavity, BsdfModelsThatBeginBeyondTheAngleAreErrors) {
  auto const problem = [](std::string const& above, std::string const& maps = "") {
    std::string const settings = "crossover: 120 urad, grid: {points: 256, window: 0.5 m}" + maps;
    std::string text = kilometre_arm(settings).text();
    std::string const law = "scatter: {model: power-law, kappa: 5e-7 /sr, exponent: 2, above: 1 urad}";
    text.replace(text.find(law), law.size(),
                 "scatter: [{model: lambertian, tis: 1 ppm}, {model: power-law, kappa: 5e-7 /sr, exponent: 2, above: " +
                     above + "}]");
    return test::message_of([&] {
      FileTexts const texts{{"a.yaml", text}};
      Scene const scene = read_scene("a.yaml", {}, &texts);
      World const world = build_world(scene);
      scene.throw_if_problems();
      arm_cavity(world, world.wave);
    });
  };
  EXPECT_THAT(problem("150 urad"), AllOf(HasSubstr("'I' begins at 150 urad"), HasSubstr("'E' begins at 150 urad"),
                                         HasSubstr("choose a 'crossover' of 150 urad or more")));
  EXPECT_EQ(problem("119 urad"), "no error");
  EXPECT_EQ(problem("150 urad", ", " + std::string(perfect)), "no error");  // nothing is missing from a perfect mirror
}

double area_of(RimCurve const& curve) {
  double sum = 0;
  for (RimPoint const& p : curve.points) {
    Vec3 const r = p.place - curve.reference;
    sum += 0.5 * (r.x * p.step.y - r.y * p.step.x);
  }
  return sum;
}

// Counter-clockwise about the beam however the baffle faces; the area within tells radius and teeth.
TEST(ArmCavity, CurvesOfRims) {
  double const a = 0.045, depth = 10e-3;
  KilometreArm scene;
  scene.baffles +=
      "  - {name: baffle_teeth, shape: {serrated_cone: {inner_radius: 45 mm, outer_radius: 30 cm, half_angle: 90 deg,"
      " tooth_depth: 10 mm, teeth: 40}}, at: [0 m, 0 m, 500 m], facing: [0, 0, 1], body: pipe, material: black}\n";
  ArmCavity const arm = cavity_of(scene);
  for (std::size_t round : {0, 2}) {  // they face each other
    EXPECT_LT(deviation(area_of(curve_of(arm, arm.rims[round])), pi * a * a), 1e-3);
    EXPECT_LT(deviation(area_of(curve_of(arm, arm.rims[round], {}, 1e-3)), pi * 0.046 * 0.046), 1e-3);
    EXPECT_GT(deviation(area_of(curve_of(arm, arm.rims[round])), pi * 0.046 * 0.046), 1e-2);  // control
  }
  Vec3 const moved = curve_of(arm, arm.rims[0], {1e-3, 2e-3, 3}).reference;
  EXPECT_NEAR(length(moved - Vec3{1e-3, 2e-3, 403}), 0, 1e-12);
  double const teeth = area_of(curve_of(arm, arm.rims[1]));
  EXPECT_LT(deviation(teeth, pi * (a * a + a * depth + depth * depth / 3)), 1e-3);
  EXPECT_GT(deviation(teeth, pi * std::pow(a + depth / 2, 2)), 2e-3);  // control: a round rim half way up the teeth
  EXPECT_LT(deviation(arm.cavity.baffles[1].rim.radius, a + depth / 2), 1e-12);  // which limits the field
}

}  // namespace
}  // namespace straytrace::wave_arm_cavity
