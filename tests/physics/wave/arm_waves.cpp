// SPDX-License-Identifier: BSD-3-Clause
// The solved cavity of a scene: its loss against the Hankel transform (docs/theory/wave.md, eq. W.10), where its power
// goes (eq. W.24), the levers of its rims (eq. W.14), and that threads change no bit.
#include "wave/arm/arm_waves.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "beams/round_cavity.hpp"
#include "physics/wave/kilometre_arm.hpp"
#include "support/recorded.hpp"

namespace straytrace::wave_arm_waves {
namespace {

using testing::deviation;
using testing::kilometre_arm;
using testing::KilometreArm;

constexpr char grid[] = "crossover: 120 urad, grid: {points: 256, window: 0.5 m}";
std::string const perfect = std::string(grid) + ", maps: {I: {spectrum: none}, E: {spectrum: none}}";

ArmWaves solved(KilometreArm const& scene, int threads = 1, int highest_order = -1) {
  World const world = scene.world();
  ArmOptions options;
  options.threads = threads;
  options.highest_order = highest_order;
  return solve_arm(world, world.wave, options);
}
ArmWaves solved(std::string const& settings) { return solved(kilometre_arm(settings)); }

double hankel_loss(std::vector<RoundOpening> openings) {
  return round_modes({1064e-9, 1 / 2500., 1 / 2500., std::move(openings)}, 0, 1).front().loss();
}

// Without scatter; smooth mirrors that scatter beyond the crossover angle have a factor 1 - scattered in power.
double diffracted(ArmWaves const& waves) {
  double const kept = (1 - waves.arm.mirrors[0].scattered) * (1 - waves.arm.mirrors[1].scattered);
  return 1 - std::norm(waves.mode.eigenvalue) / kept;
}

// Two baffles that clip the beam send light beyond 400 urad from one to the other, so that the grid is finer than the
// crossover angle needs.
TEST(ArmWaves, LossOfSmoothMirrors) {
  std::string const fine = "crossover: 120 urad, grid: {points: 1024, window: 0.5 m}, ";
  ArmWaves const waves = solved(fine + "maps: {I: {spectrum: none}, E: {spectrum: none}}");
  double const expected = hankel_loss({{0, 0.075}, {400, 0.045}, {600, 0.045}, {1000, 0.075}});
  EXPECT_LT(deviation(diffracted(waves), expected), 1e-4);
  EXPECT_GT(deviation(diffracted(waves), hankel_loss({{0, 0.075}, {400, 0.045}, {1000, 0.075}})), 0.1);  // control
  EXPECT_GT(waves.mode.loss(), 2 * waves.arm.mirrors[0].scattered);
  EXPECT_LT(deviation(waves.perfect_loss, hankel_loss({{0, 0.075}, {1000, 0.075}})), 1e-6);
  EXPECT_LT(deviation(waves.ledger.total(), waves.mode.loss()), 1e-6);
  EXPECT_GT(waves.ledger.towards_mirror1[0], 0);
  EXPECT_GT(deviation(waves.ledger.total() - waves.ledger.towards_mirror1[0], waves.mode.loss()), 1e-3);  // control
}

// A rim about the axis of a round mode has no transverse lever, but one off the axis does.
TEST(ArmWaves, CentredRimsHaveLongitudinalLeversOnly) {
  KilometreArm scene = kilometre_arm(perfect);
  ArmWaves const centred = solved(scene);
  ASSERT_EQ(centred.rims.size(), 2u);
  std::size_t const at = scene.baffles.find("[0 m, 0 m, 400 m]");
  scene.baffles.replace(at, 17, "[1 mm, 0 m, 400 m]");
  ArmWaves const moved = solved(scene);
  double const lever = std::abs(moved.rims[0].responses.at(0).levers.displacement[0]);
  for (RimResult const& rim : centred.rims) {
    ASSERT_EQ(rim.responses.size(), 1u);
    for (int axis : {0, 1}) EXPECT_LT(std::abs(rim.responses[0].levers.displacement[axis]), 1e-5 * lever);
    EXPECT_LT(std::abs(rim.responses[0].levers.rotation[2]), 1e-5 * lever * 0.045);
    EXPECT_GT(std::abs(rim.responses[0].levers.displacement[2]), 0);
  }
  EXPECT_LT(std::abs(moved.rims[0].responses[0].levers.displacement[1]), 1e-5 * lever);  // across its offset
  EXPECT_GT(std::abs(centred.rims[0].clipped), 0);
}

// The displacements of mirrors and rims together change nothing (eq. W.16). The mode is known to 1e-5 of its amplitude,
// and a mirror moved alone turns the beam by 2 k w/RoC = 97/m.
TEST(ArmWaves, CommonMotionChangesNothing) {
  ArmWaves const waves = solved(KilometreArm{});
  for (std::size_t axis : {0, 1}) {
    std::complex<double> sum = waves.mirror1[axis] + waves.mirror2[axis];
    for (RimResult const& rim : waves.rims) sum += rim.responses.at(0).levers.displacement[axis];
    double const size = std::abs(waves.mirror1[axis]);
    EXPECT_LT(std::abs(sum), 0.05 * size);
    EXPECT_GT(std::abs(sum - waves.mirror2[axis]), 0.5 * size);  // negative control: one mirror stays
  }
}

TEST(ArmWaves, RimsBeyondTheAngleHaveTheirExpectation) {
  ArmWaves const waves = solved("crossover: 100 urad, grid: {points: 256, window: 0.5 m}");
  for (std::size_t i : {0, 1}) {
    RimResult const& rim = waves.rims[i];
    EXPECT_TRUE(rim.responses.empty());
    SpeckledRim const expected{1064e-9,
                               0.045,
                               i == 0 ? 400. : 600.,
                               i == 0 ? 600. : 400.,
                               waves.arm.mirrors[0].spot,
                               waves.arm.mirrors[1].spot,
                               5e-7 * std::pow(waves.arm.rims[i].angle1, -2),
                               5e-7 * std::pow(waves.arm.rims[i].angle2, -2)};
    SpeckleMeans const means = speckle_means(expected);
    EXPECT_LT(deviation(rim.speckle.transverse, means.transverse), 1e-6);
    EXPECT_LT(deviation(rim.speckle.longitudinal, means.longitudinal), 1e-6);
    EXPECT_LT(deviation(rim.speckle.field, means.field), 1e-6);
  }
}

bool same(RimLevers const& a, RimLevers const& b) {
  for (int i = 0; i < 3; ++i)
    if (a.displacement[i] != b.displacement[i] || a.rotation[i] != b.rotation[i]) return false;
  return true;
}

// The first levers are those of the rim as drawn; each draw of the tolerances has its own, and each rim.
TEST(ArmWaves, TolerancesAreDrawnReproducibly) {
  std::string const settings = std::string(grid) + ", tolerance: {rim: 0.2 mm, centre: 0.5 mm, place: 1 m}, draws: 3";
  ArmWaves const drawn = solved(settings), again = solved(settings), nominal = solved(grid);
  for (std::size_t rim : {0, 1}) {
    ASSERT_EQ(drawn.rims[rim].responses.size(), 4u);
    ASSERT_EQ(nominal.rims[rim].responses.size(), 1u);
    EXPECT_TRUE(same(drawn.rims[rim].responses[0].levers, nominal.rims[rim].responses[0].levers));
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_TRUE(same(drawn.rims[rim].responses[i].levers, again.rims[rim].responses[i].levers));
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_FALSE(same(drawn.rims[rim].responses[i].levers, drawn.rims[rim].responses[j].levers));
    }
  }
}

// Mirrors with heights, tolerances and higher modes.
TEST(ArmWaves, SameBitsWithAnyThreads) {
  std::string const settings = std::string(grid) + ", tolerance: {centre: 0.5 mm}, draws: 2";
  ArmWaves const one = solved(kilometre_arm(settings), 1, 1);
  auto const differs = [&](ArmWaves const& other) {
    if (one.mode.eigenvalue != other.mode.eigenvalue || one.ledger.total() != other.ledger.total()) return true;
    if (one.mirror1 != other.mirror1 || one.mirror2 != other.mirror2) return true;
    if (one.modes.size() != other.modes.size()) return true;
    for (std::size_t i = 0; i < one.modes.size(); ++i)
      if (one.modes[i].loss != other.modes[i].loss || one.modes[i].phase != other.modes[i].phase) return true;
    for (std::size_t rim : {0, 1}) {
      if (one.rims[rim].clipped != other.rims[rim].clipped) return true;
      for (std::size_t i = 0; i < 3; ++i)
        if (!same(one.rims[rim].responses[i].levers, other.rims[rim].responses[i].levers)) return true;
    }
    return false;
  };
  EXPECT_FALSE(one.modes.empty());
  for (int threads : {2, 5}) EXPECT_FALSE(differs(solved(kilometre_arm(settings), threads, 1))) << threads;
  EXPECT_TRUE(differs(solved(kilometre_arm(settings + ", maps: {E: {seed: 2}}"), 1, 1)));  // negative control
}

}  // namespace
}  // namespace straytrace::wave_arm_waves
