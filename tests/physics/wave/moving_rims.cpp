// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of the eigenvalue of a cavity by the motion of a rim in it, as an integral along the rim, against
// eigenvalues with the rim moved (docs/theory/wave.md, eq. W.11 to W.16): validation cases V4 and V15.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "support/recorded.hpp"
#include "wave/cavity_rims.hpp"

namespace straytrace::wave_moving_rims {
namespace {

using wave::Complex;

constexpr double nd_yag = 1.064e-6;  // m

WaveCavity kilometre(RoundHole rim, double place = 400) {
  WaveMirror const mirror{1 / 2500., {0.05}, 0, 0, {}, 0};
  return {nd_yag, 1000, mirror, mirror, {{place, rim}}, {384, 0.4}};
}

// A surface of waves along all directions, longer than 10 mm, of about 0.5 nm.
void roughen(WaveMirror& mirror, Grid const& grid, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  mirror.height.assign(grid.size(), 0);
  for (int wave = 0; wave < 30; ++wave) {
    // Whole periods on the window, so that the series has no step at its border.
    int const m = int(std::floor(60 * uniform(random))) - 30, n = int(std::floor(60 * uniform(random))) - 30;
    double const phase = uniform(random);
    for (int row = 0; row < grid.points; ++row)
      for (int column = 0; column < grid.points; ++column)
        mirror.height[std::size_t(row) * std::size_t(grid.points) + std::size_t(column)] +=
            0.15e-9 * turned((m * grid.at(column) + n * grid.at(row)) / grid.window + phase).real();
  }
}

SolveOptions exact() {
  SolveOptions options;
  options.loss_error = 1e-10;
  return options;
}

Complex eigenvalue(WaveCavity const& cavity) {
  CavityWaves const waves(cavity);
  return waves.mode(waves.hermite_gauss(), exact()).eigenvalue;
}

struct Levers {
  RimLevers rim;
  Complex widening;
  CavityRims all;
};
Levers levers(WaveCavity const& cavity) {
  CavityWaves const waves(cavity);
  WaveMode const mode = waves.mode(waves.hermite_gauss(), exact());
  CavityRims rims = rim_responses(waves, mode, {{round_curve(cavity.baffles[0], cavity)}});
  return {rims.responses[0][0].levers, rims.responses[0][0].widening, rims};
}

double relative(Complex value, Complex expected) { return std::abs(value - expected) / std::abs(expected); }

// d ln(gamma)/dx of a change of the cavity, from both sides.
template <class Change>
Complex difference(WaveCavity const& cavity, double step, Change const& change) {
  WaveCavity plus = cavity, minus = cavity;
  change(plus, step);
  change(minus, -step);
  return (std::log(eigenvalue(plus)) - std::log(eigenvalue(minus))) / (2 * step);
}

WaveCavity rough() {
  WaveCavity cavity = kilometre({0.04, 3e-3, -1.5e-3});
  roughen(cavity.mirror1, cavity.grid, 1);
  roughen(cavity.mirror2, cavity.grid, 2);
  return cavity;
}

TEST(MovingRims, RimIntegralAgainstTheMovedBaffleV4) {
  WaveCavity const cavity = rough();
  RimLevers const found = levers(cavity).rim;
  Complex const x = difference(cavity, 2e-5, [](WaveCavity& c, double d) { c.baffles[0].rim.x += d; });
  Complex const y = difference(cavity, 2e-5, [](WaveCavity& c, double d) { c.baffles[0].rim.y += d; });
  Complex const z = difference(cavity, 0.02, [](WaveCavity& c, double d) { c.baffles[0].place += d; });
  EXPECT_LT(relative(found.displacement[0], x), 1e-3);
  EXPECT_LT(relative(found.displacement[1], y), 1e-3);
  EXPECT_LT(relative(found.displacement[2], z), 1e-2);
  EXPECT_GT(relative(0.5 * found.displacement[0], x), 0.4);  // one direction of the two
}

// eq. W.16: nothing changes when baffle and mirrors move together.
TEST(MovingRims, CommonMotionChangesNothingV4) {
  Levers const found = levers(rough());
  for (std::size_t axis : {0, 1}) {
    Complex const sum = found.rim.displacement[axis] + found.all.mirror1[axis] + found.all.mirror2[axis];
    EXPECT_LT(std::abs(sum), 1e-5 * std::abs(found.rim.displacement[axis]));
    EXPECT_GT(std::abs(sum - found.all.mirror1[axis]), 1e-2 * std::abs(found.rim.displacement[axis]));
  }
}

// A wider rim clips less: d(gamma)/gamma per radius is the integral of the product of the fields, and the longitudinal
// lever is that of the radial flux.
TEST(MovingRims, CentredRimV15) {
  WaveCavity const cavity = kilometre({0.04});
  Levers const found = levers(cavity);
  EXPECT_LT(relative(found.widening, {0.067468, -0.030853}), 1e-3);
  EXPECT_LT(relative(found.rim.displacement[2], {4.2434e-7, 1.4835e-7}), 1e-2);
  EXPECT_LT(std::abs(found.rim.displacement[0]), 1e-6 * std::abs(found.widening));
}

}  // namespace
}  // namespace straytrace::wave_moving_rims
