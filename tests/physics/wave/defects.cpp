// SPDX-License-Identifier: BSD-3-Clause
// Point absorbers and ripples on mirrors (docs/theory/wave.md, eq. W.18, W.31 to W.33).
#include "wave/heights/defects.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/math/constants.hpp"
#include "base/math/gauss_points.hpp"
#include "physics/wave/kilometre_arm.hpp"
#include "support/message_of.hpp"
#include "support/recorded.hpp"
#include "wave/arm/arm_cavity.hpp"
#include "wave/transform.hpp"

namespace straytrace::wave_defects {
namespace {

using testing::deviation;
using ::testing::HasSubstr;
using testing::kilometre_arm;
using wave::Complex;

constexpr double nd_yag = 1064e-9;             // m
constexpr double rise = 4.7e-9, waist = 2e-3;  // m: 10 mW on fused silica

WaveSettings::Absorber absorber(double radius, double x = 0, double y = 0) { return {x, y, radius, rise}; }

// The curvature of a half-space that heat flows into is the flux times the distortion (Barber): the height solves
// -(h'' + h'/r) = rise 2/(pi w^2) exp(-2 r^2/w^2), and falls off as rise/(2 pi) ln(1/r).
TEST(Absorber, SolvesTheEquationOfTheHeatedSurface) {
  auto const height = [](double r) { return height_of_absorber(absorber(waist), r, 0.1); };
  EXPECT_NEAR(height(0.1), 0, 1e-20);
  for (double r : {0.3e-3, 1e-3, 2.5e-3}) {
    double const d = 2e-5, second = (height(r + d) - 2 * height(r) + height(r - d)) / (d * d);
    double const first = (height(r + d) - height(r - d)) / (2 * d);
    double const flux = 2 / (pi * waist * waist) * std::exp(-2 * r * r / (waist * waist));
    EXPECT_LT(deviation(-(second + first / r), rise * flux), 1e-3) << r;
  }
  EXPECT_LT(deviation(height(0.02) - height(0.04), rise / (2 * pi) * std::log(2.0)), 1e-9);
  EXPECT_GT(height(0), height(1e-3));  // it bulges towards the light
}

// The part of the spectrum rise exp(-q^2 w^2/8)/q^2 below a frequency, from its Hankel transform.
double part_below(double frequency, double radius, double r, double r0) {
  GaussPoints const gauss(8);
  double sum = 0;
  double const most = 2 * pi * frequency, step = most / 400;
  for (int i = 0; i < 400; ++i)
    for (std::size_t k = 0; k < gauss.at.size(); ++k) {
      double const q = (i + gauss.at[k]) * step;
      sum += step * gauss.weight[k] * std::exp(-q * q * radius * radius / 8) *
             (std::cyl_bessel_j(0, q * r) - std::cyl_bessel_j(0, q * r0)) / q;
    }
  return rise / (2 * pi) * sum;
}

// Also beside the axis, where copies of the window would show: in a window of 0.5 m the nearest is 0.47 m away.
TEST(Absorber, IsCutAtAFrequencyOnTheGrid) {
  Grid const grid{256, 0.5};
  double const frequency = 110, x = 15 * grid.pitch(), y = -8 * grid.pitch();
  std::vector<double> const heights = heights_of_absorber(absorber(50e-6, x, y), grid, 0.075, frequency);
  auto const at = [&](int column, int row) { return heights[std::size_t((128 + row) * 256 + 128 + column)]; };
  double const reference = at(15 + 20, -8);
  for (auto const& [column, row] : {std::pair{15, -8}, {17, -8}, {15, -3}, {15 - 30, -8 + 20}}) {
    double const r = std::hypot(column - 15, row + 8) * grid.pitch();
    double const expected = part_below(frequency, 50e-6, r, 20 * grid.pitch());
    EXPECT_NEAR((at(column, row) - reference) / rise, expected / rise, 1e-3) << column << " " << row;
  }
  // Control: the whole height at the centre.
  double const whole = height_of_absorber(absorber(50e-6), 0, 20 * grid.pitch());
  EXPECT_GT(std::fabs(at(15, -8) - reference - whole) / rise, 0.2);
}

// Light that a mode of 20 mm radius loses to angles between two, from the field itself, to first order in the height.
TEST(Absorber, ScattersItsShareW33) {
  Grid const grid{512, 0.5};
  double const w = 0.02, k = 2 * pi / nd_yag, from = 150e-6, to = 350e-6, x = 5e-3;
  std::vector<double> const heights = heights_of_absorber(absorber(50e-6, x), grid, 0.075, 380e-6 / nd_yag);
  Field field(grid);
  for (int row = 0; row < 512; ++row)
    for (int column = 0; column < 512; ++column) {
      double const r = std::hypot(grid.at(row), grid.at(column)), h = heights[std::size_t(row * 512 + column)];
      field(row, column) = std::sqrt(2 / pi) / w * std::exp(-r * r / (w * w)) * std::exp(Complex(0, -2 * k * h));
    }
  Transform(512, 0).forward(field, 512, 512);
  double power = 0;
  for (int row = 0; row < 512; ++row)
    for (int column = 0; column < 512; ++column) {
      double const angle = nd_yag * std::hypot(grid.frequency(row), grid.frequency(column));
      if (angle > from && angle < to)
        power += std::norm(field(row, column)) * grid.pitch() * grid.pitch() / double(grid.size());
    }
  auto const beyond = [&](double angle) { return scattered_by_absorber(absorber(50e-6, x), w, nd_yag, angle); };
  double const expected = beyond(from) - beyond(to);
  EXPECT_LT(deviation(power, expected), 0.03);
  EXPECT_GT(deviation(power, expected / 4), 1);  // control: the phase of one way
  // A spot as wide as the light that it scatters at small angles scatters nothing at large ones.
  EXPECT_LT(scattered_by_absorber(absorber(5e-3), w, nd_yag, from), 0.1 * beyond(from));
}

ArmCavity arm_with(std::string const& defects) {
  World const world =
      kilometre_arm("crossover: 120 urad, grid: {points: 256, window: 0.5 m}, maps: {I: {spectrum: none, defects: " +
                    defects + "}, E: {spectrum: none}}")
          .world();
  return arm_cavity(world, world.wave);
}

// The share of a ripple of 10 mm, 50 periods in the window, that goes into one of its first orders (eq. W.18).
double first_order(ArmCavity const& arm, bool along_y) {
  Complex sum = 0;
  std::vector<double> const& heights = arm.cavity.mirror1.height;
  for (int row = 0; row < 256; ++row)
    for (int column = 0; column < 256; ++column) {
      double const turns = 50.0 * (along_y ? row : column) / 256, h = heights[std::size_t(row * 256 + column)];
      sum += std::exp(Complex(0, 2 * pi * turns - 4 * pi / nd_yag * h)) / (256.0 * 256.0);
    }
  return std::norm(sum);
}

TEST(Ripple, OfASceneScattersIntoItsOrdersW18) {
  double const k = 2 * pi / nd_yag, order = std::pow(std::cyl_bessel_j(1, 2 * k * 2e-9), 2);
  for (char const* const amplitude : {"2 nm peak", "4 nm pp"}) {
    ArmCavity const arm =
        arm_with("[{ripple: {period: 10 mm, direction: 90 deg, amplitude: " + std::string(amplitude) + "}}]");
    EXPECT_LT(deviation(first_order(arm, true), order), 1e-6) << amplitude;
    EXPECT_LT(first_order(arm, false), 1e-20);  // control: along the other axis
    EXPECT_TRUE(arm.cavity.mirror2.height.empty());
    EXPECT_LT(deviation(arm.mirrors[0].roughness, 2e-9 / std::sqrt(2.0)), 1e-3);
  }
}

TEST(Defects, OfASceneAddAndAreChecked) {
  ArmCavity const arm =
      arm_with("[{absorber: {at: [10 mm, 0 m], radius: 1 mm, power: 20 mW, distortivity: 1e-6 m/W}}]");
  ArmCavity const none = arm_with("[]");
  EXPECT_TRUE(none.cavity.mirror1.height.empty());
  WaveSettings::Absorber const same{0.01, 0, 1e-3, 20e-9};
  std::vector<double> const heights = heights_of_absorber(same, arm.cavity.grid, 0.075, 120e-6 / nd_yag);
  for (std::size_t i : {0u, 32000u, 33000u}) EXPECT_NEAR(arm.cavity.mirror1.height[i], heights[i], 1e-20);
  double const lost = scattered_by_absorber(same, arm.mirrors[0].spot, nd_yag, 120e-6);
  EXPECT_LT(deviation(arm.mirrors[0].scattered - none.mirrors[0].scattered, lost), 1e-9);
  auto const problem = [](std::string const& defects) { return test::message_of([&] { arm_with(defects); }); };
  EXPECT_THAT(problem("[{absorber: {at: [80 mm, 0 m], radius: 1 mm, power: 1 mW}}]"),
              HasSubstr("is not on the mirror"));
  EXPECT_THAT(problem("[{ripple: {amplitude: 1 nm peak, period: 8 mm}}]"),
              HasSubstr("scatters to 133 urad, beyond the crossover angle of 120 urad"));
  EXPECT_THAT(problem("[{dust: {}}, {ripple: {amplitude: 1 nm, period: 9 mm}}]"),
              ::testing::AllOf(HasSubstr("a defect is one of 'absorber' and 'ripple'"),
                               HasSubstr("does not say which amplitude")));
}

}  // namespace
}  // namespace straytrace::wave_defects
