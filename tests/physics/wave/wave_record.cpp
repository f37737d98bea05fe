// SPDX-License-Identifier: BSD-3-Clause
// What a run file keeps of a cavity gives its levers and its light again, bit by bit, and the fields at its mirrors.
#include "wave/arm/wave_record.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "physics/wave/kilometre_arm.hpp"

namespace straytrace::wave_record_test {
namespace {

using testing::kilometre_arm;
using testing::KilometreArm;

struct Solved {
  World const world;
  ArmWaves const waves;

  explicit Solved(std::string const& settings)
      : world(kilometre_arm("crossover: 120 urad, grid: {points: 256, window: 0.5 m}" + settings).world()),
        waves(solve_arm(world, world.wave, options())) {}
  static ArmOptions options() {
    ArmOptions options;
    options.threads = 1;
    options.highest_order = 0;
    options.fields = true;
    return options;
  }
};

TEST(WaveRecord, GivesLeversAndLightAgain) {
  Solved const solved(", tolerance: {radius: 1 mm}, draws: 2, map_draws: 2");
  WaveRecord const record = record_of(solved.world, solved.waves, "key", 1e4);
  ArmWaves const back = waves_of(solved.world, solved.world.wave, planned_arm(solved.world, solved.world.wave), record);
  EXPECT_EQ(record.power, 1e4);
  EXPECT_EQ(record.rims[0].name, "baffle_one");
  ASSERT_EQ(back.rims.size(), 2u);
  for (std::size_t i = 0; i < back.rims.size(); ++i) {
    RimResult const &now = back.rims[i], &was = solved.waves.rims[i];
    ASSERT_EQ(now.draws.size(), 2u);
    ASSERT_EQ(now.draws[0].responses.size(), 3u);
    EXPECT_EQ(now.ensemble().size(), 4u);
    for (std::size_t draw = 0; draw < 3; ++draw)
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(now.draws[0].responses[draw].levers.displacement[axis],
                  was.draws[0].responses[draw].levers.displacement[axis]);
        EXPECT_EQ(now.draws[0].responses[draw].levers.rotation[axis],
                  was.draws[0].responses[draw].levers.rotation[axis]);
      }
    EXPECT_NE(now.draws[0].responses[1].levers.displacement[0],
              was.draws[0].responses[2].levers.displacement[0]);  // control
    EXPECT_EQ(now.draws[0].clipped, was.draws[0].clipped);
    EXPECT_EQ(now.speckle.transverse, was.speckle.transverse);
    EXPECT_EQ(back.irradiance.towards_mirror1[i + 1].mean, solved.waves.irradiance.towards_mirror1[i + 1].mean);
  }
  EXPECT_EQ(back.ledger.total(), solved.waves.ledger.total());
  EXPECT_EQ(back.draws[1].loss, solved.waves.draws[1].loss);
  EXPECT_EQ(back.draws[1].mirrors[1].figure, solved.waves.draws[1].mirrors[1].figure);
  EXPECT_NE(back.draws[1].mirrors[1].figure, back.draws[0].mirrors[1].figure);  // control
  EXPECT_NE(back.draws[1].loss, back.draws[0].loss);                            // control
  HeightsRecord const& first = record.heights[0];
  EXPECT_NEAR(first.at_mirrors[0] + first.at_mirrors[1] + first.on_baffles[0] + first.on_baffles[1] + first.beyond_band,
              solved.waves.draws[0].ledger.total(), 1e-15);
  EXPECT_EQ(back.mode.eigenvalue, solved.waves.mode.eigenvalue);
  EXPECT_EQ(back.arm.mirrors[1].scattered, solved.waves.arm.mirrors[1].scattered);
  EXPECT_EQ(back.arm.warnings, solved.waves.arm.warnings);
  KilometreArm one;
  one.wave = "wave: {beam: arm, baffles: baffle_one, crossover: 120 urad, grid: {points: 256, window: 0.5 m}}\n";
  World const other = one.world();
  EXPECT_ANY_THROW(waves_of(other, other.wave, planned_arm(other, other.wave), record));
}

// The kept field has the power of the mode less what was lost on the way, and the irradiance on the mirror.
TEST(WaveRecord, KeepsTheFieldsAtTheMirrors) {
  Solved const solved("");
  WaveRecord const record = record_of(solved.world, solved.waves, "key", 0);
  ASSERT_EQ(record.fields.size(), 2u);
  double const pitch = record.grid.pitch();
  for (FieldRecord const& field : record.fields) {
    ASSERT_EQ(field.points, 256u);
    double power = 0;
    for (float const x : field.values) power += double(x) * double(x) * pitch * pitch;
    EXPECT_NEAR(power, 1, 1e-2);
    EXPECT_GT(std::fabs(power - 1), 1e-6);  // both baffles clip the mode
  }
  PolarIrradiance const& light = record.irradiance.towards_mirror2.back();
  // Rings as wide as the pitch have their points nearer to the axis than their middle: some 4 % at 10 rings per radius
  // of the mode.
  EXPECT_NEAR(light.power(0, light.rings * light.step), 1, 5e-2);
  FieldRecord const& at_mirror2 = record.fields[1];
  std::size_t const centre = 2 * (128 * 256 + 128);
  double const peak =
      std::pow(double(at_mirror2.values[centre]), 2) + std::pow(double(at_mirror2.values[centre + 1]), 2);
  EXPECT_NEAR(peak / double(light.mean[0]), 1, 0.02);
}

}  // namespace
}  // namespace straytrace::wave_record_test
