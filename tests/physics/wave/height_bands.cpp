// SPDX-License-Identifier: BSD-3-Clause
// The loss of an arm by the spatial frequency of the heights of its mirrors (docs/theory/wave.md, eq. W.34).
#include <gtest/gtest.h>

#include <cmath>

#include "base/math/constants.hpp"
#include "physics/wave/kilometre_arm.hpp"
#include "support/recorded.hpp"
#include "wave/arm/arm_solver.hpp"

namespace straytrace::wave_height_bands {
namespace {

using testing::deviation;

constexpr double ripple = 1e-9;  // m

// One mirror with a ripple of so many periods over the window of 0.5 m.
HeightBands bands_of_ripple(int periods) {
  testing::KilometreArm scene;
  scene.wave =
      "wave: {beam: arm, crossover: 250 urad, grid: {points: 480, window: 0.5 m},"
      " maps: {I: {spectrum: none}, E: {spectrum: none}}}\n";
  World const world = scene.world();
  ArmCavity arm = arm_cavity(world, world.wave);
  Grid const& grid = arm.cavity.grid;
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column)
      arm.cavity.mirror1.height.push_back(ripple * std::cos(2 * pi * periods * grid.at(column) / grid.window));
  ArmSolver solver(arm, 1, [](std::string const&) {});
  return frequency_bands(arm, solver);
}

// Both first orders of a ripple of 5.3 mm, J1(2 k h0)^2 of the power each (eq. W.18), miss the other mirror by 125 mm.
TEST(HeightBands, LossByARipple) {
  HeightBands const found = bands_of_ripple(94);
  double const k = 2 * pi / 1064e-9, orders = 1 - std::pow(std::cyl_bessel_j(0, 2 * k * ripple), 2);
  ASSERT_EQ(found.bands.size(), 4u);  // octaves down from 250 urad/lambda = 235/m to 1/(2 w) = 24.3/m
  EXPECT_NEAR(found.bands.back().to, 235, 0.1);
  EXPECT_NEAR(found.bands.back().from, 117.5, 0.1);
  EXPECT_EQ(found.bands.front().from, 0);
  HeightBand const& band = found.bands.back();
  EXPECT_LT(deviation(band.loss, orders), 2e-3);
  EXPECT_LT(deviation(band.scattered[0], 2 * std::pow(k * ripple, 2)), 2e-3);
  EXPECT_EQ(band.scattered[1], 0);
  EXPECT_GT(deviation(band.loss, 1 - std::pow(std::cyl_bessel_j(0, k * ripple), 2)), 0.5);  // control: h for 2 h
  for (std::size_t i : {0, 1, 2}) {
    EXPECT_LT(std::fabs(found.bands[i].loss), 1e-3 * orders);
    EXPECT_LT(found.bands[i].scattered[0], 1e-12);
  }
}

// Of a ripple of 100 mm, the orders stand 11 mm off the axis of the other mirror: that light stays in the cavity.
TEST(HeightBands, SlowHeightsScatterLightThatStays) {
  HeightBands const found = bands_of_ripple(5);
  EXPECT_GT(found.bands.front().scattered[0], 1e-6);
  EXPECT_LT(std::fabs(found.bands.front().loss), 0.05 * found.bands.front().scattered[0]);
  EXPECT_LT(found.bands.back().scattered[0], 1e-12);
}

}  // namespace
}  // namespace straytrace::wave_height_bands
