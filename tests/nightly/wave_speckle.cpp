// SPDX-License-Identifier: BSD-3-Clause
// Levers of the inner edges of baffles in the field of an arm, on average over random mirrors, against their
// expectation (docs/theory/wave.md, eq. W.22): validation case V14.
#include <fmt/format.h>

#include <complex>
#include <iterator>
#include <string>
#include <vector>

#include "base/every_module.hpp"
#include "scene/scene.hpp"
#include "support/statistics.hpp"
#include "wave/arm/arm_cavity.hpp"
#include "wave/arm/speckled_rim.hpp"

namespace straytrace::testing::nightly_wave {
namespace {

// Mirrors of ET-HF. The baffles are so near the middle that a spot of 120 mm on the mirrors spreads the angles of
// scatter towards their edges, 79 to 89 urad, over nothing but the band from `above` to the crossover angle.
World arm_world(int seed) {
  std::string text =
      "straytrace: 1\nmaterials:\n"
      "  coat: {specular: {reflect: 0.9999}, scatter: {model: power-law, kappa: 3.2145e-9 /sr, exponent: 2.3986, above:"
      " 50 urad}}\n"
      "  black: {}\n"
      "bodies: {optics: {motion: still}, pipe: {motion: still}}\nscene:\n"
      "  - {name: I, use: mirror, radius: 31 cm, radius_of_curvature: 5070 m, at: [0 m, 0 m, 0 m], facing: [0, 0, 1],"
      " body: optics, material: coat}\n"
      "  - {name: E, use: mirror, radius: 31 cm, radius_of_curvature: 5070 m, at: [0 m, 0 m, 10 km], facing: [0, 0, "
      "-1],"
      " body: optics, material: coat}\n";
  for (int place : {4700, 5000, 5300})
    text += fmt::format(
        "  - {{name: baffle_{}, shape: {{disk: {{inner_radius: 42 cm, outer_radius: 50 cm}}}}, at: [0 m, 0 m, {} m],"
        " facing: [0, 0, 1], body: pipe, material: black}}\n",
        place, place);
  text += fmt::format(
      "beams: {{arm: {{cavity: [I, E]}}}}\nports: {{I: {{beam: arm, at: I}}}}\n"
      "wave: {{beam: arm, baffles: \"baffle*\", crossover: 118 urad, grid: {{points: 1024}},"
      " maps: {{I: {{seed: {}}}, E: {{seed: {}}}}}}}\n",
      seed, seed);
  FileTexts const texts{{"a.yaml", text}};
  Scene const scene = read_scene("a.yaml", {}, &texts);
  World world = build_world(scene);
  scene.throw_if_problems();
  return world;
}

constexpr double radii[] = {0.35, 0.38, 0.41, 0.44, 0.47, 0.50};  // m, farther apart than a patch of speckle, 15 mm

SpeckleMeans expected(World const& world, ArmCavity const& arm, double place, double radius) {
  double const far = arm.cavity.length - place;
  return speckle_means({world.wavelength, radius, place, far, arm.mirrors[0].spot, arm.mirrors[1].spot,
                        MirrorBrdf(world, arm.mirrors[0], {0, 0, -1})(radius / place),
                        MirrorBrdf(world, arm.mirrors[1], {0, 0, 1})(radius / far)});
}

// Of one draw of both mirrors: mean over edges and the two transverse axes of |A|^2 over its expectation. Openings wide
// enough to clip nothing leave out what the equation does: the waves of the edges of mirrors, and the shadows that
// baffles cast on each other.
double relative_square(int seed) {
  World const world = arm_world(seed);
  ArmCavity arm = arm_cavity(world, world.wave);
  arm.cavity.mirror1.outline.radius = arm.cavity.mirror2.outline.radius = 0.36;
  std::vector<std::vector<RimCurve>> curves(arm.rims.size());
  for (std::size_t i = 0; i < arm.rims.size(); ++i) {
    arm.cavity.baffles[i].rim.radius = 0.55;
    for (double radius : radii) curves[i].push_back(curve_of(arm, arm.rims[i], {}, radius - arm.rims[i].rim.radius));
  }
  CavityWaves const waves(arm.cavity, 0);
  CavityRims const found = rim_responses(waves, waves.mode(waves.hermite_gauss()), curves);
  testing::Sampler mean;
  for (std::size_t i = 0; i < arm.rims.size(); ++i)
    for (std::size_t j = 0; j < std::size(radii); ++j)
      for (int axis : {0, 1})
        mean.add(std::norm(found.responses[i][j].levers.displacement[axis]) /
                 expected(world, arm, arm.rims[i].centre.z, radii[j]).transverse);
  return mean.mean().mean;
}

// 5 standard errors over the draws are less than 40 %.
TEST(NightlyWave, SquaredLeversAgreeWithTheirExpectationV14) {
  testing::Sampler mean;
  for (int seed = 1; seed <= 24; ++seed) mean.add(relative_square(seed));
  expect_mean("|A_x|^2 over eq. W.22", mean.mean(), 1, 0.64);
  expect_rejected("one direction of the light", mean.mean(), 4);
  expect_rejected("both directions as independent fields", mean.mean(), 2);
  expect_rejected("two axes in place of one", mean.mean(), 0.5);
}

}  // namespace
}  // namespace straytrace::testing::nightly_wave
