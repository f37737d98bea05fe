// SPDX-License-Identifier: BSD-3-Clause
// Higher modes of a cavity (docs/theory/wave.md, Higher modes): validation cases V2 and V3, and modes of high order
// with tilted and rough mirrors, against losses of the Hankel transform (eq. W.10) and the Gouy phase
// (eq. W.8).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "beams/cavity_mode.hpp"
#include "support/recorded.hpp"
#include "wave/modes/driven.hpp"

namespace straytrace::wave_mode_table {
namespace {

using testing::deviation;

WaveCavity kilometre_cavity(double radius, Grid grid) {
  WaveMirror const mirror{1 / 2500., {radius}, 0, 0, {}, 0};
  return {1.064e-6, 1000, mirror, mirror, {}, grid};
}
// Those of LG with these |l| and p.
std::vector<ModeLine> radial(std::vector<ModeLine> const& all, int p, int l) {
  std::vector<ModeLine> found;
  std::ranges::copy_if(all, std::back_inserter(found),
                       [&](ModeLine const& m) { return m.laguerre.one == p && std::abs(m.laguerre.two) == l; });
  return found;
}

TEST(ModeTable, LossesAndFamiliesV2) {
  std::vector<ModeLine> const modes = mode_table(CavityWaves(kilometre_cavity(0.05, {384, 0.4})), 2);
  ASSERT_EQ(modes.size(), 6u);
  struct Expected {
    int p, l;
    double loss;
  };
  for (auto const& [p, l, loss] :
       {Expected{0, 0, 38.3338e-6}, {0, 1, 493.301e-6}, {0, 2, 2173.78e-6}, {1, 0, 3627.40e-6}}) {
    std::vector<ModeLine> const found = radial(modes, p, l);
    ASSERT_EQ(found.size(), l == 0 ? 1u : 2u) << p << l;
    for (ModeLine const& m : found) {
      EXPECT_LT(deviation(m.loss, loss), 3e-5) << p << l;
      EXPECT_EQ(m.alike, l == 0 ? 1 : 2);
      EXPECT_GT(m.laguerre.shared, 0.99);
      EXPECT_GT(m.in_order, 0.99);
    }
  }
  // LG10 is (HG20 + HG02)/sqrt 2: half of either, while the span of l = +-2 holds all of HG11.
  EXPECT_NEAR(radial(modes, 1, 0)[0].hermite.shared, 0.5, 0.01);
  double most = 0;
  for (ModeLine const& m : radial(modes, 0, 2))
    if (m.hermite.one == 1) most = m.hermite.shared;
  EXPECT_GT(most, 0.99);
}

// Loss and phase of each of the 45 modes, against the Hankel transform of the same mirrors (eq. W.10). The search ends
// as that of `straytrace wave`, at 1e-3 of a loss; to its end, this grid is right to 1.3e-4.
TEST(ModeTable, LossesAndPhasesOfAllOrdersUpTo8V3) {
  auto const hankel = [](double radius, int l) {
    beams::RoundCavity const cavity{1.064e-6, 1 / 2500., 1 / 2500., {{0, radius}, {1000, radius}}};
    return beams::round_modes(cavity, l, 5);
  };
  std::vector<std::vector<beams::RoundMode>> exact;
  for (int l = 0; l <= 8; ++l) exact.push_back(hankel(0.075, l));
  SolveOptions options;
  options.loss_error = 1e-2;
  std::vector<ModeLine> const modes = mode_table(CavityWaves(kilometre_cavity(0.075, {270, 0.45})), 8, options);
  ASSERT_EQ(modes.size(), 45u);
  for (ModeLine const& m : modes) {
    beams::RoundMode const& right = exact[std::size_t(std::abs(m.laguerre.two))][std::size_t(m.laguerre.one)];
    double const turns = std::arg(right.eigenvalue / exact[0][0].eigenvalue) / (2 * pi);
    EXPECT_LT(std::abs(std::remainder(m.phase - turns, 1)), 1e-6) << m.order;
    if (m.order > 0) {
      EXPECT_GT(std::abs(std::remainder(m.phase + turns, 1)), 1e-3) << m.order;  // the other sign
    }
    if (right.loss() > 1e-9) {
      EXPECT_LT(deviation(m.loss, right.loss()), 1e-3) << m.order;
    }
    EXPECT_GT(m.in_order, 0.99) << m.order;
  }
  EXPECT_GT(deviation(modes.back().loss, hankel(0.0755, 0)[4].loss()), 0.05);  // negative control: half a mm wider
  double const of_lg10 = radial(modes, 1, 0)[0].phase;
  EXPECT_LT(std::abs(std::remainder(of_lg10 + 4 * std::acos(0.6) / (2 * pi), 1)), 1e-6);
}

// Tilts move the axis, which the named modes follow; heights of 2 nm rms break the symmetry: no two modes are alike.
TEST(ModeTable, TiltedAndRoughMirrors) {
  WaveCavity cavity = kilometre_cavity(0.1, {192, 0.6});
  cavity.mirror2.tilt_x = 2e-6;
  cavity.mirror1.tilt_y = -1e-6;
  auto const rough = [&](double height) {
    WaveCavity other = cavity;
    other.mirror1.height.resize(other.grid.size());
    for (int row = 0; row < 192; ++row)
      for (int column = 0; column < 192; ++column) {
        double const x = other.grid.at(column), y = other.grid.at(row);
        other.mirror1.height[std::size_t(row) * 192 + std::size_t(column)] =
            height * (std::cos(90 * x + 40 * y + 1) + std::cos(150 * y - 60 * x));
      }
    SolveOptions coarse;
    coarse.loss_error = 1;
    return mode_table(CavityWaves(other), 3, coarse);
  };
  std::vector<ModeLine> const smooth = rough(0), modes = rough(2e-9);
  ASSERT_EQ(modes.size(), 10u);
  for (ModeLine const& m : smooth) EXPECT_GT(m.in_order, 0.999) << m.order;
  for (ModeLine const& m : modes) EXPECT_GT(m.in_order, 0.98) << m.order;
  auto const alike = [](std::vector<ModeLine> const& all) {
    return std::ranges::count_if(all, [](ModeLine const& m) { return m.alike > 1; });
  };
  EXPECT_EQ(alike(modes), 0);
  EXPECT_GT(alike(smooth), 0);  // negative control
}

}  // namespace
}  // namespace straytrace::wave_mode_table
