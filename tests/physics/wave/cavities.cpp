// SPDX-License-Identifier: BSD-3-Clause
// Fields of cavities by Fourier propagation (docs/theory/wave.md, eq. W.1 to W.11, W.18, W.23, W.24): validation cases
// V2, V3, V8 to V13 and V15. The reference is the Hankel transform (eq. W.10).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "beams/cavity_mode.hpp"
#include "support/recorded.hpp"
#include "wave/cavity.hpp"

namespace straytrace::wave_cavities {
namespace {

using wave::Complex;

using testing::deviation;

constexpr double nd_yag = 1.064e-6;  // m

WaveMirror mirror(double roc, double radius) { return {1 / roc, {radius}, 0, 0, {}, 0}; }
WaveCavity kilometre(double radius, Grid grid = {384, 0.4}) {
  return {nd_yag, 1000, mirror(2500, radius), mirror(2500, radius), {}, grid};
}
WaveCavity virgo(Grid grid) { return {nd_yag, 3000, mirror(1420, 0.165), mirror(1683, 0.165), {}, grid}; }
WaveCavity with_baffle(Grid grid, RoundHole rim = {0.04}) {
  WaveCavity cavity = kilometre(0.05, grid);
  cavity.baffles.push_back({400, rim});
  return cavity;
}

// LG10 is (HG20 + HG02)/sqrt 2.
Field laguerre10(CavityWaves const& waves) {
  Field sum = waves.hermite_gauss(2, 0);
  Field const other = waves.hermite_gauss(0, 2);
  for (std::size_t i = 0; i < sum.values.size(); ++i)
    sum.values[i] = (sum.values[i] + other.values[i]) / std::sqrt(2.0);
  return sum;
}

double loss(WaveCavity const& cavity, int n = 0, int m = 0) {
  CavityWaves const waves(cavity);
  return waves.mode(waves.hermite_gauss(n, m)).loss();
}

TEST(CavityWaves, LossesOfKilometreCavitiesV2) {
  EXPECT_LT(deviation(loss(kilometre(0.05)), 38.3338e-6), 1e-5);
  EXPECT_LT(deviation(loss(kilometre(0.05), 1, 0), 493.301e-6), 2e-5);
  EXPECT_LT(deviation(loss(kilometre(0.05), 1, 1), 2173.78e-6), 2e-5);
  CavityWaves const waves(kilometre(0.05));
  EXPECT_LT(deviation(waves.mode(laguerre10(waves)).loss(), 3627.40e-6), 2e-5);
  EXPECT_LT(deviation(loss(virgo({512, 1.2})), 0.22828e-6), 5e-3);
  // A coarse grid folds light back into the mode.
  EXPECT_GT(deviation(loss(virgo({256, 1.2})), 0.22828e-6), 1);
}

TEST(CavityWaves, GouyPhaseOfTheFirstRadialModeV3) {
  CavityWaves const waves(kilometre(0.075, {384, 0.5}));
  Complex const ratio = waves.mode(laguerre10(waves)).eigenvalue / waves.mode(waves.hermite_gauss()).eigenvalue;
  EXPECT_LT(std::abs(std::arg(ratio) - (2 * pi - 4 * std::acos(0.6))), 1e-6);
  EXPECT_GT(std::abs(std::arg(ratio) - 2 * std::acos(0.6)), 0.1);  // the phase of one way
}

// A sinusoidal surface sends J_1(2 k h)^2 of the power into each first order (eq. W.18).
TEST(CavityWaves, RippleScattersIntoItsOrdersV8) {
  Grid const grid{1024, 1.2};
  Transform const transform(grid.points);
  double const period = 8e-3, height = 2e-9, distance = 2000, w = 0.03, k = 2 * pi / nd_yag;
  WaveMirror mirror{0, {0.5}, 0, 0, {}, 0};
  mirror.height.resize(grid.size());
  Field field(grid);
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      mirror.height[std::size_t(row) * 1024 + std::size_t(column)] =
          height * std::cos(2 * pi * grid.at(column) / period);
      double const r = std::hypot(grid.at(row), grid.at(column));
      field(row, column) = std::sqrt(2 / pi) / w * std::exp(-r * r / (w * w));
    }
  Field const factor = reflection(mirror, Mask(mirror.outline, grid, transform), nd_yag, grid);
  for (std::size_t i = 0; i < field.values.size(); ++i) field.values[i] *= factor.values[i];
  Leg const leg(distance, 0.3, nd_yag, grid);
  transform.forward(field, grid.points, leg.columns());
  leg.apply(field);
  transform.inverse(field, leg.columns(), grid.points);
  double power = 0, moment = 0;
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column)
      if (double const x = grid.at(column); x > 0.133) {
        power += std::norm(field(row, column)) * grid.pitch() * grid.pitch();
        moment += x * std::norm(field(row, column)) * grid.pitch() * grid.pitch();
      }
  double const share = std::pow(std::cyl_bessel_j(1, 2 * k * height), 2);
  EXPECT_LT(deviation(share, 1.394684e-4), 1e-6);
  EXPECT_LT(deviation(power, share), 1e-6);
  EXPECT_LT(deviation(moment / power, nd_yag * distance / period), 1e-6);
  EXPECT_GT(deviation(power, std::pow(std::cyl_bessel_j(1, k * height), 2)), 1);  // the phase of one way
}

// Centroids of the light that arrives at the mirrors (eq. W.23).
TEST(CavityWaves, SpotsOfATiltedMirrorV9) {
  WaveCavity cavity = kilometre(0.075, {384, 0.5});
  cavity.mirror2.tilt_x = 0.3e-6;
  CavityWaves const waves(cavity);
  WaveMode const mode = waves.mode(waves.hermite_gauss());
  double spot[2] = {};
  Field spectrum = mode.spectrum;
  waves.round_trip(spectrum, [&](Arrival const& arrival) {
    double power = 0, moment = 0;
    for (int row = 0; row < 384; ++row)
      for (int column = 0; column < 384; ++column) {
        power += std::norm(arrival.field(row, column));
        moment += cavity.grid.at(column) * std::norm(arrival.field(row, column));
      }
    spot[arrival.plane] = moment / power;
  });
  EXPECT_LT(deviation(spot[0], 0.46875e-3), 1e-5);
  EXPECT_LT(deviation(spot[1], 0.28125e-3), 1e-5);
}

TEST(CavityWaves, LedgerClosesV10) {
  WaveCavity cavity = with_baffle({384, 0.4}, {0.04, 3e-3, -1.5e-3});
  CavityWaves const waves(cavity);
  SolveOptions exact;
  exact.loss_error = 1e-9;
  WaveMode const mode = waves.mode(waves.hermite_gauss(), exact);
  PowerLedger const ledger = waves.ledger(mode);
  EXPECT_LT(deviation(ledger.total(), mode.loss()), 1e-9);
  EXPECT_GT(ledger.towards_mirror1[0], 1e-5);
  EXPECT_GT(deviation(ledger.total() - ledger.towards_mirror1[0], mode.loss()), 1e-2);  // one direction
  EXPECT_GT(ledger.mirror1, 0);
  EXPECT_GT(ledger.mirror2, 0);
  EXPECT_GT(ledger.beyond_band, 0);
}

TEST(CavityWaves, ResidualFallsWithRoundTripsV11) {
  CavityWaves const waves(virgo({512, 1.2}));
  // After each round trip, up to the rounding of the eigenvalue.
  auto const residuals = [&](Field const& start) {
    std::vector<double> all;
    SolveOptions exact;
    exact.loss_error = 0;
    exact.progress = [&](int, double residual) { all.push_back(residual); };
    waves.mode(start, exact);
    return all;
  };
  std::vector<double> const found = residuals(waves.hermite_gauss());
  ASSERT_GE(found.size(), 12u);
  EXPECT_LT(found[5], 1e-4);
  EXPECT_LT(found[11], 2e-8);
  EXPECT_LT(found.back(), 1e-8);
  // A start that is 20 % too wide holds higher modes.
  WaveCavity wide = virgo({512, 1.2});
  double const w = cavity_mode(3000, 1420, 1683, nd_yag).w1;
  Field other(wide.grid);
  for (int row = 0; row < 512; ++row)
    for (int column = 0; column < 512; ++column) {
      double const r = std::hypot(wide.grid.at(row), wide.grid.at(column));
      other(row, column) = std::exp(-r * r / (1.44 * w * w)) * turned(-r * r / 1420 / (2 * nd_yag));
    }
  waves.transform().forward(other, 512, 512);
  EXPECT_GT(residuals(other)[5], 5e-4);
}

TEST(CavityWaves, GaussianBeamThroughItsWaistV12) {
  Grid const grid{1024, 1.2};
  Transform const transform(grid.points);
  double const waist = 29.5e-3, z = 5000, rayleigh = pi * waist * waist / nd_yag,
               w = waist * std::hypot(1, z / rayleigh);
  double const roc = z + rayleigh * rayleigh / z;
  Field field(grid), expected(grid);
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const r = std::hypot(grid.at(row), grid.at(column));
      double const size = std::sqrt(2 / pi) / w * std::exp(-r * r / (w * w));
      field(row, column) = size * turned(-r * r / (2 * roc) / nd_yag);
      expected(row, column) = size * turned(r * r / (2 * roc) / nd_yag);
    }
  Leg const leg(2 * z, 0.5, nd_yag, grid);
  transform.forward(field, grid.points, leg.columns());
  leg.apply(field);
  transform.inverse(field, leg.columns(), grid.points);
  Complex overlap = 0;
  for (std::size_t i = 0; i < field.values.size(); ++i)
    overlap += std::conj(expected.values[i]) * field.values[i] * grid.pitch() * grid.pitch();
  EXPECT_LT(std::abs(std::abs(overlap) - 1), 1e-10);
  EXPECT_LT(std::abs(std::arg(overlap) + 2 * std::atan(z / rayleigh)), 1e-10);
}

// On the axis behind a hole of radius a, the field of a Gaussian beam with a flat wavefront is 1 - exp(-gamma a^2) of
// that without the hole, gamma = 1/w^2 - ik/2z.
TEST(CavityWaves, LightOnTheAxisBehindAHoleV13) {
  double const w = 0.15, a = 0.2, z = 8000, k = 2 * pi / nd_yag;
  Complex const gamma{1 / (w * w), -k / (2 * z)}, exact = 1.0 - std::exp(-gamma * a * a);
  auto const ratio = [&](int points, bool binary) {
    Grid const grid{points, 1};
    Transform const transform(points);
    Mask const mask({a}, grid, transform);
    Leg const leg(z, 0.25, nd_yag, grid);
    auto const on_axis = [&](bool hole) {
      Field field(grid);
      for (int row = 0; row < points; ++row)
        for (int column = 0; column < points; ++column) {
          double const r = std::hypot(grid.at(row), grid.at(column));
          field(row, column) = std::exp(-r * r / (w * w)) * (hole && binary && r > a ? 0.0 : 1.0);
        }
      if (hole && !binary)
        for (std::size_t i = 0; i < field.values.size(); ++i) field.values[i] *= mask.values()[i];
      transform.forward(field, points, leg.columns());
      leg.apply(field);
      transform.inverse(field, leg.columns(), points);
      return field(points / 2, points / 2);
    };
    return on_axis(true) / on_axis(false);
  };
  EXPECT_LT(std::abs(ratio(192, false) - exact), 1e-4);
  EXPECT_LT(std::abs(ratio(384, false) - exact), 1e-4);
  EXPECT_GT(std::abs(ratio(192, true) - exact), 1e-3);  // pixels that are either in or out
}

TEST(CavityWaves, BaffleInTheCavityV15) {
  EXPECT_LT(deviation(loss(with_baffle({384, 0.4})), 417.4251e-6), 1e-5);
  EXPECT_LT(deviation(loss(with_baffle({384, 0.4}), 1, 0), 3959.470e-6), 1e-5);
  EXPECT_GT(deviation(loss(kilometre(0.05)), 417.4251e-6), 0.5);  // without it
}

TEST(CavityWaves, NarrowWindowIsRefused) {
  EXPECT_THROW(CavityWaves({nd_yag, 3000, mirror(1420, 0.165), mirror(1683, 0.165), {}, {512, 0.5}}), InputError);
}

}  // namespace
}  // namespace straytrace::wave_cavities
