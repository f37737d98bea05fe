// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of the eigenvalue of a cavity by the motion of a rim in it or of a mirror, as integrals along the rim and
// over the mirror, against eigenvalues with either moved (docs/theory/wave.md, eq. W.11 to W.16, W.25, W.26):
// validation cases V4 and V15.
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

// A surface of waves along all directions, longer than 10 mm, of about 0.5 nm, displaced along x.
void roughen(WaveMirror& mirror, Grid const& grid, unsigned seed, double displacement = 0) {
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
            0.15e-9 * turned((m * (grid.at(column) - displacement) + n * grid.at(row)) / grid.window + phase).real();
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

// The mirror moved: its outline, its heights and, by a tilt, its curvature.
TEST(MovingRims, LeversOfAMirrorAgainstTheMovedMirror) {
  WaveCavity const cavity = rough();
  CavityRims const all = levers(cavity).all;
  Complex const x = difference(cavity, 1e-5, [](WaveCavity& c, double d) {
    c.mirror2.outline.x += d;
    c.mirror2.tilt_x += c.mirror2.curvature * d;
    roughen(c.mirror2, c.grid, 2, d);
  });
  Complex const tilt = difference(cavity, 3e-9, [](WaveCavity& c, double d) { c.mirror1.tilt_y -= d; });
  Complex const z = difference(cavity, 0.02, [](WaveCavity& c, double d) { c.length += d; });
  EXPECT_LT(relative(all.mirrors[1].whole.displacement[0], x), 1e-3);
  EXPECT_LT(relative(all.mirrors[0].whole.rotation[0], tilt), 1e-3);
  EXPECT_LT(relative(all.mirrors[1].whole.displacement[2], z), 1e-3);
  EXPECT_GT(relative(all.mirrors[1].figure[0], x), 0.1);  // negative control: the curvature rests
}

// Heights that scatter light by 120 to 160 urad, onto the inner edge of 70 mm in the middle.
WaveMirror speckled(Grid const& grid, unsigned seed) {
  WaveMirror mirror{1 / 2500., {0.075}, 0, 0, std::vector<double>(grid.size()), 0};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int waves = 0; waves < 40;) {
    int const m = int(std::floor(130 * uniform(random))) - 65, n = int(std::floor(130 * uniform(random))) - 65;
    double const phase = uniform(random), angle = nd_yag / grid.window * std::hypot(m, n);
    if (angle < 120e-6 || angle > 160e-6) continue;
    ++waves;
    for (int row = 0; row < grid.points; ++row)
      for (int column = 0; column < grid.points; ++column)
        mirror.height[std::size_t(row * grid.points + column)] +=
            0.1e-9 * turned((m * grid.at(column) + n * grid.at(row)) / grid.window + phase).real();
  }
  return mirror;
}

// Turning the light of a mirror about the axis is, to first order in its heights, what turning the mirror does.
TEST(MovingRims, RollOfTheLightIsThatOfTheMirror) {
  Grid const grid{384, 0.4};
  WaveCavity const cavity{nd_yag, 1000, speckled(grid, 1), speckled(grid, 2), {{500, {0.07}}}, grid};
  CavityWaves const waves(cavity);
  WaveMode const mode = waves.mode(waves.hermite_gauss(), exact());
  RimCurve const still = round_curve(cavity.baffles[0], cavity);
  RimCurve rolled = still;
  rolled.roll[1] = pi / 2;
  CavityRims const found = rim_responses(waves, mode, {{still, rolled}});
  WaveCavity other = cavity;
  int const n = cavity.grid.points;
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column) {  // at (x, y) the height that was at (y, -x)
      int const from_row = (n - column) % n, from_column = row;
      other.mirror2.height[std::size_t(row * n + column)] =
          cavity.mirror2.height[std::size_t(from_row * n + from_column)];
    }
  RimLevers const expected = levers(other).rim;
  for (int axis : {0, 1}) {
    EXPECT_LT(relative(found.responses[0][1].levers.displacement[axis], expected.displacement[axis]), 0.15) << axis;
    EXPECT_GT(relative(found.responses[0][0].levers.displacement[axis], expected.displacement[axis]), 0.5) << axis;
  }
}

// eq. W.16: nothing changes when baffle and mirrors move or turn together.
TEST(MovingRims, CommonMotionChangesNothingV4) {
  WaveCavity const cavity = rough();
  Levers const found = levers(cavity);
  RimLevers const bodies[] = {found.rim, found.all.mirrors[0].whole, found.all.mirrors[1].whole};
  Vec3 const places[] = {{3e-3, -1.5e-3, cavity.baffles[0].place}, {}, {0, 0, cavity.length}};
  auto const sum = [&](int moving, int axis) {  // of the first bodies
    Complex total = 0;
    for (int i = 0; i < moving; ++i) total += bodies[i].displacement[axis];
    return total;
  };
  auto const turned_sum = [&](int moving, int axis) {  // about mirror 1
    Complex total = 0;
    int const next = (axis + 1) % 3, last = (axis + 2) % 3;
    for (int i = 0; i < moving; ++i) {
      double const arm[] = {places[i].x, places[i].y, places[i].z};
      auto const& t = bodies[i].displacement;
      total += bodies[i].rotation[axis] + arm[next] * t[last] - arm[last] * t[next];
    }
    return total;
  };
  // To the residual of the mode, which the tilt of a mirror alone turns into 97/m of lever.
  for (int axis : {0, 1, 2}) {
    double const size = std::abs(found.rim.displacement[axis]);
    EXPECT_LT(std::abs(sum(3, axis)), (axis < 2 ? 1e-5 : 1e-4) * size) << axis;
    EXPECT_GT(std::abs(sum(2, axis)), 1e-2 * size) << axis;
    double const across = std::abs(found.rim.displacement[axis == 0 ? 1 : 0]);
    double const turned_size = (axis < 2 ? cavity.baffles[0].place : cavity.baffles[0].rim.y) * across;
    EXPECT_LT(std::abs(turned_sum(3, axis)), 1e-4 * std::fabs(turned_size)) << axis;
    EXPECT_GT(std::abs(turned_sum(2, axis)), 1e-2 * std::fabs(turned_size)) << axis;
  }
}

// Eq. W.26: what a mirror couples is the motion of the axis past the rim and past the outlines and heights of both
// mirrors. By a rotation of mirror 1 about y.
Complex by_the_axis(WaveCavity const& cavity, Levers const& found) {
  AxisShift const axis = axis_shifts(cavity.mirror1.curvature, cavity.mirror2.curvature, cavity.length)[0];
  return -(found.rim.displacement[0] * axis.at(cavity.baffles[0].place) + found.rim.rotation[1] * axis.slope +
           found.all.mirrors[0].figure[0] * axis.at(0) + found.all.mirrors[1].figure[0] * axis.at(cavity.length));
}

TEST(MovingRims, AMirrorThatTiltsMovesTheAxis) {
  WaveCavity const cavity = rough();
  Levers const found = levers(cavity);
  Complex const exact = found.all.mirrors[0].whole.rotation[1];
  EXPECT_LT(relative(by_the_axis(cavity, found), exact), 1e-4);
  Levers bare = found;  // negative control: without the heights and outlines of the mirrors
  for (MirrorLevers& m : bare.all.mirrors) m.figure = {};
  EXPECT_GT(relative(by_the_axis(cavity, bare), exact), 0.1);
}

// The loss changes at first order with the tilt of a mirror where the other is misaligned, and not where it is not.
TEST(MovingRims, LossByTheTiltOfAMisalignedCavity) {
  WaveCavity cavity = kilometre({0.04});
  double const centred = by_the_axis(cavity, levers(cavity)).real();
  cavity.mirror2.tilt_x = 0.3e-6;
  double const step = 1e-8;
  auto const loss = [&](double tilt) {
    WaveCavity tilted = cavity;
    tilted.mirror1.tilt_x = tilt;
    return 1 - std::norm(eigenvalue(tilted));
  };
  Levers const found = levers(cavity);
  double const expected = (loss(step) - loss(-step)) / (2 * step), kept = 1 - loss(0);
  EXPECT_LT(relative(-2 * kept * by_the_axis(cavity, found).real(), expected), 1e-3);
  EXPECT_LT(relative(-2 * kept * found.all.mirrors[0].whole.rotation[1].real(), expected), 1e-3);
  EXPECT_LT(std::abs(2 * centred), 1e-4 * std::abs(expected));
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
