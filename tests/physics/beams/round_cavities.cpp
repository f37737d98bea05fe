// SPDX-License-Identifier: BSD-3-Clause
// Modes and losses of cavities of round mirrors by the Hankel transform (docs/theory/beams.md, eq. W.8 and W.10):
// validation cases V1, V2, V3 and V15. The negative controls are eq. 5.5, radii read as diameters, another RoC, the
// one-way Gouy phase and a cavity without its baffle.
#include <gtest/gtest.h>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "beams/cavity_mode.hpp"
#include "beams/overlap.hpp"
#include "support/recorded.hpp"

namespace straytrace::beams_round_cavities {
namespace {

using testing::deviation;

constexpr double nd_yag = 1.064e-6;  // m

// Equal mirrors at a distance.
RoundCavity symmetric(double length, double roc, double radius) {
  return {nd_yag, 1 / roc, 1 / roc, {{0, radius}, {length, radius}}};
}

RoundCavity virgo(double roc1 = 1420) { return {nd_yag, 1 / roc1, 1 / 1683., {{0, 0.165}, {3000, 0.165}}}; }

double loss(RoundCavity const& cavity, int azimuthal = 0, int radial = 0) {
  return round_modes(cavity, azimuthal, radial + 1).back().loss();
}

// V1: the confocal cavity of Fox and Li (1961), power loss per transit, which is half of the round trip.
double confocal_loss(double fresnel, int azimuthal) {
  double const eigenvalue =
      std::abs(round_modes(symmetric(1000, 1000, std::sqrt(fresnel * nd_yag * 1000)), azimuthal, 1).front().eigenvalue);
  return 1 - eigenvalue;
}

TEST(RoundCavity, ConfocalLossesOfFoxAndLiV1) {
  EXPECT_LT(deviation(confocal_loss(0.8, 0), 4.447765e-3), 1e-6);
  EXPECT_LT(deviation(confocal_loss(0.8, 1), 6.102829e-2), 1e-6);
  EXPECT_LT(deviation(confocal_loss(1, 0), 4.759499e-4), 1e-6);
  EXPECT_LT(deviation(confocal_loss(1, 1), 9.417409e-3), 1e-6);
  // The asymptote 16 pi^2 N exp(-4 pi N) is reached slowly from below.
  EXPECT_LT(deviation(confocal_loss(0.8, 0) / (16 * pi * pi * 0.8 * std::exp(-4 * pi * 0.8)), 0.818), 1e-3);
  EXPECT_LT(deviation(confocal_loss(1, 0) / (16 * pi * pi * std::exp(-4 * pi)), 0.864), 1e-3);
  EXPECT_GT(deviation(confocal_loss(0.2, 0), 4.447765e-3), 1);  // the radius taken for a diameter
}

TEST(RoundCavity, LossesOfKilometreCavitiesV2) {
  RoundCavity const cavity = symmetric(1000, 2500, 0.05);
  EXPECT_LT(deviation(loss(cavity), 38.3338e-6), 2e-6);
  EXPECT_LT(deviation(loss(cavity, 1), 493.301e-6), 2e-6);
  EXPECT_LT(deviation(loss(cavity, 2), 2173.78e-6), 3e-6);
  EXPECT_LT(deviation(loss(cavity, 0, 1), 3627.40e-6), 2e-6);
  EXPECT_LT(deviation(loss(virgo()), 0.22828e-6), 2e-5);
  EXPECT_LT(deviation(loss(virgo(), 0, 1), 35.322e-6), 2e-5);
  double const gaussian = 2 * clipped_share(0.05, cavity_mode(1000, 2500, 2500, nd_yag).w1);
  EXPECT_LT(deviation(gaussian, 14.85e-6), 1e-3);
  EXPECT_GT(deviation(loss(cavity), gaussian), 1);            // eq. 5.5 is 2.6 times too small
  EXPECT_GT(deviation(loss(virgo(1419)), 0.22828e-6), 1e-3);  // 1 m less RoC
}

// V3: the first radial mode leads by -4 psi, psi the one-way Gouy phase.
TEST(RoundCavity, GouyPhaseOfTheFirstRadialModeV3) {
  auto const modes = round_modes(symmetric(1000, 2500, 0.075), 0, 2);
  double const between = std::arg(modes[1].eigenvalue / modes[0].eigenvalue);
  EXPECT_NEAR(between, 2 * pi - 4 * std::acos(0.6), 1e-6);
  EXPECT_GT(std::fabs(between - (2 * pi - 2 * std::acos(0.6))), 1);
}

// V15: a centred baffle; and an opening that is wider than the light changes nothing.
TEST(RoundCavity, BaffleInTheCavityV15) {
  RoundCavity cavity = symmetric(1000, 2500, 0.05);
  cavity.openings.insert(cavity.openings.begin() + 1, {400, 0.04});
  EXPECT_LT(deviation(loss(cavity), 417.4251e-6), 1e-6);
  EXPECT_LT(deviation(loss(cavity, 1), 3959.470e-6), 1e-6);
  EXPECT_GT(deviation(loss(cavity), loss(symmetric(1000, 2500, 0.05))), 0.5);
  cavity.openings[1].radius = 0.1;
  EXPECT_LT(deviation(loss(cavity), loss(symmetric(1000, 2500, 0.05))), 2e-3);
}

TEST(RoundCavity, ALargeFresnelNumberIsAnError) {
  EXPECT_EQ(fresnel_number(symmetric(1, 2.5, 0.0025)), 0.0025 * 0.0025 / nd_yag);
  EXPECT_THROW(round_modes(symmetric(1, 2.5, 0.01), 0, 1), NumericalError);
  EXPECT_NO_THROW(round_modes(symmetric(1, 2.5, 0.005), 0, 1));
}

}  // namespace
}  // namespace straytrace::beams_round_cavities
