// SPDX-License-Identifier: BSD-3-Clause
// Heights of mirrors and the light that they scatter (docs/theory/wave.md, eq. W.17 and W.20): validation case V6.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "base/math/gauss_points.hpp"
#include "base/math/rng.hpp"
#include "support/message_of.hpp"
#include "support/recorded.hpp"
#include "support/statistics.hpp"
#include "wave/heights/height_map.hpp"
#include "wave/transform.hpp"

namespace straytrace::height_maps {
namespace {

using test::message_of;
using testing::deviation;

constexpr double nd_yag = 1.064e-6;  // m

// Heights of a function on a disc, the axis in a point of the map; NaN outside.
template <class Function>
HeightMap disc_map(int points, double pitch, double radius, Function const& height) {
  HeightMap map;
  for (int i = 0; i < points; ++i) map.x.push_back((i - points / 2) * pitch);
  map.y = map.x;
  for (double y : map.y)
    for (double x : map.x) map.height.push_back(std::hypot(x, y) <= radius ? height(x, y) : not_a_number);
  return map;
}

double mean_square(std::vector<double> const& heights) {
  double sum = 0;
  for (double h : heights) sum += h * h;
  return sum / double(heights.size());
}

double steep(double f) { return 1e-24 * std::pow(f, -2.4); }  // m^4

// 2 pi int S2 f df over the frequencies of the grid.
double band_variance(Grid const& grid, double low, double high, double sides) {
  double sum = 0;
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const f = std::hypot(grid.frequency(row), grid.frequency(column));
      if (f > low && f <= high) sum += sides * steep(f) / (grid.window * grid.window);
    }
  return sum;
}

TEST(SynthesisedHeights, HaveTheVarianceOfTheSpectrumEq36) {
  Grid const grid{64, 0.4};
  double const low = 8, high = 60;
  testing::Sampler variance;
  for (std::uint64_t seed = 0; seed < 200; ++seed)
    variance.add(mean_square(synthesise(steep, grid, low, high, seed, 0)));
  double const expected = band_variance(grid, low, high, 1);
  testing::expect_mean("variance of synthesised heights", variance.mean(), expected, 0.2 * expected);
  testing::expect_rejected("one-sided spectrum", variance.mean(), band_variance(grid, low, high, 2));
  // The sum over frequencies is the integral 2 pi int S2 f df = 2 pi 1e-24 (low^-0.4 - high^-0.4)/0.4.
  double const integral = 2 * pi * 1e-24 * (std::pow(low, -0.4) - std::pow(high, -0.4)) / 0.4;
  EXPECT_LT(deviation(expected, integral), 0.1);
}

// Power of each ring of frequencies over S2/W^2.
TEST(SynthesisedHeights, HaveTheSpectrumRingByRing) {
  Grid const grid{64, 0.4};
  testing::Sampler rings[4];
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Field field(grid);
    std::ranges::copy(synthesise(steep, grid, 5.1, 74.9, seed, 1), field.values.begin());
    Transform(grid.points).forward(field, grid.points, grid.points);
    for (int row = 0; row < grid.points; ++row)
      for (int column = 0; column < grid.points / 2; ++column) {  // the other half are conjugates
        if (column == 0 && row >= grid.points / 2) continue;
        double const f = std::hypot(grid.frequency(row), grid.frequency(column));
        double const power = std::norm(field(row, column)) / (double(grid.size()) * double(grid.size()));
        if (f > 5 && f < 75)
          rings[int(f) / 20].add(power * grid.window * grid.window / steep(f));
        else
          EXPECT_LT(power, 1e-36);
      }
  }
  for (testing::Sampler const& ring : rings) {
    testing::expect_mean("spectrum of synthesised heights over S2", ring.mean(), 1, 0.4);
    testing::expect_rejected("one-sided spectrum", ring.mean(), 2);
  }
}

TEST(SynthesisedHeights, FinerGridsKeepTheCoarseMap) {
  Grid const coarse{32, 0.4}, fine{64, 0.4};
  std::vector<double> const a = synthesise(steep, coarse, 0, 38, 5, 0), b = synthesise(steep, fine, 0, 38, 5, 0);
  std::vector<double> const above = synthesise(steep, fine, 38, 75, 5, 0), all = synthesise(steep, fine, 0, 75, 5, 0);
  std::vector<double> const other = synthesise(steep, fine, 0, 38, 5, 1);
  double const size = std::sqrt(mean_square(a));
  double worst = 0, sum = 0, control = 0;
  for (int row = 0; row < 32; ++row)
    for (int column = 0; column < 32; ++column) {
      std::size_t const in_fine = std::size_t(2 * row * 64 + 2 * column);
      double const h = a[std::size_t(row * 32 + column)];
      worst = std::fmax(worst, std::fabs(h - b[in_fine]));
      sum = std::fmax(sum, std::fabs(h + above[in_fine] - all[in_fine]));
      control = std::fmax(control, std::fabs(h - other[in_fine]));
    }
  EXPECT_LT(worst / size, 1e-12);
  EXPECT_LT(sum / size, 1e-12);
  EXPECT_GT(control / size, 1);  // the other mirror has heights of its own
}

double low_orders_at(LowOrders const& o, double x, double y) {
  return o.piston + o.tilt_x * x + o.tilt_y * y + o.curvature * (x * x + y * y) / 2 +
         o.astigmatism0 * (x * x - y * y) / 2 + o.astigmatism45 * x * y;
}

TEST(LowOrders, AreThoseOfTheMap) {
  LowOrders const made{3e-8, 2e-7, -1e-7, 4e-6, -3e-7, 5e-7};
  HeightMap map = disc_map(81, 4e-3, 0.155, [&](double x, double y) { return low_orders_at(made, x, y); });
  map.height[40 * 81 + 30] = not_a_number;
  LowOrders const found = fit_low_orders(map, 0.06);
  EXPECT_LT(deviation(found.piston, made.piston), 1e-9);
  EXPECT_LT(deviation(found.tilt_x, made.tilt_x), 1e-9);
  EXPECT_LT(deviation(found.tilt_y, made.tilt_y), 1e-9);
  EXPECT_LT(deviation(found.curvature, made.curvature), 1e-9);
  EXPECT_LT(deviation(found.astigmatism0, made.astigmatism0), 1e-9);
  EXPECT_LT(deviation(found.astigmatism45, made.astigmatism45), 1e-9);
  HeightMap rest = map;
  remove(rest, found, {});
  EXPECT_NEAR(rest.height[40 * 81 + 50],
              low_orders_at({0, 0, 0, made.curvature, made.astigmatism0, made.astigmatism45}, map.x[50], map.y[40]),
              1e-17);
  remove(map, found, {true, true, true, true});
  EXPECT_LT(std::fabs(map.height[30 * 81 + 55]), 1e-17);
}

// A height that is orthogonal to all six in the measure of the beam leaves them alone: 1 - 4 u + 2 u^2, u = r^2/w^2, is
// Laguerre's polynomial L_2 of 2 u. With equal weights it has a piston and a curvature.
TEST(LowOrders, AreFittedInTheMeasureOfTheBeam) {
  double const w = 0.04;
  auto const laguerre = [&](double x, double y) {
    double const u = (x * x + y * y) / (w * w);
    return 1e-9 * (1 - 4 * u + 2 * u * u);
  };
  HeightMap const map = disc_map(161, 2e-3, 0.16, laguerre);
  LowOrders const found = fit_low_orders(map, w);
  EXPECT_LT(std::fabs(found.piston), 1e-9 * 1e-6);
  EXPECT_LT(std::fabs(found.curvature) * w * w, 1e-9 * 1e-6);
  EXPECT_GT(std::fabs(fit_low_orders(map, 10 * w).piston), 1e-9);
}

TEST(LowOrders, NeedPointsWithinTheBeam) {
  HeightMap map = disc_map(31, 1e-2, 0.15, [](double, double) { return 1e-9; });
  EXPECT_THAT(message_of([&] { fit_low_orders(map, 1e-3); }),
              ::testing::HasSubstr("too few points within the beam of 0.001 m"));
}

double largest_error(std::vector<double> const& heights, Grid const& grid, double radius,
                     std::function<double(double, double)> const& expected) {
  double worst = 0;
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column)
      if (std::hypot(grid.at(row), grid.at(column)) < radius)
        worst = std::fmax(worst, std::fabs(heights[std::size_t(row * grid.points + column)] -
                                           expected(grid.at(column), grid.at(row))));
  return worst;
}

// The pitches of map and grid have no common multiple. Near the axis the edge of the disc is far enough away.
TEST(ResampledHeights, KeepWhatIsBelowTheFrequencyAndNothingAbove) {
  auto const slow = [](double x, double y) {
    return 1e-9 * (std::cos(2 * pi * (21.3 * x + 3 * y)) + 0.5 * std::sin(2 * pi * (-7 * x + 33.7 * y)));
  };
  auto const fast = [](double x, double y) { return 3e-9 * std::cos(2 * pi * (210 * x - 130 * y)); };
  HeightMap const below = disc_map(401, 1.03e-3, 0.2, slow);
  HeightMap const both = disc_map(401, 1.03e-3, 0.2, [&](double x, double y) { return slow(x, y) + fast(x, y); });
  Grid const grid{192, 0.5};
  EXPECT_LT(largest_error(resample(below, grid, 150), grid, 0.1, slow) / 1e-9, 2e-3);
  EXPECT_LT(largest_error(resample(both, grid, 150), grid, 0.1, slow) / 1e-9, 2e-2);
  // Controls: a frequency that leaves out the second sine; one that holds the fast one.
  EXPECT_GT(largest_error(resample(below, grid, 30), grid, 0.1, slow) / 1e-9, 0.4);
  Grid const fine{384, 0.5};
  EXPECT_GT(largest_error(resample(both, fine, 300), fine, 0.1, slow) / 1e-9, 2.5);
  // Outside of the disc there is nothing.
  std::vector<double> const heights = resample(below, grid, 150);
  EXPECT_LT(std::fabs(heights[96 * 192 + 6]), 1e-12);
}

TEST(Holes, AreFilledFromWhatIsAroundThem) {
  auto const smooth = [](double x, double y) {
    return 1e-9 * (std::cos(2 * pi * (6 * x + 3 * y)) + std::sin(2 * pi * (-4 * x + 7 * y)) + 20 * x);
  };
  HeightMap map = disc_map(129, 2.5e-3, 0.15, smooth), whole = map;
  EXPECT_LT(fill_holes(whole), 0.002);
  for (std::size_t i = 0; i < map.height.size(); ++i) {
    double const x = map.x[i % 129], y = map.y[i / 129];
    if (std::hypot(x - 0.05, y) < 0.015 || std::hypot(x + 0.06, y + 0.04) < 0.01) map.height[i] = not_a_number;
  }
  HeightMap filled = map;
  double const share = fill_holes(filled);
  EXPECT_NEAR(share, (0.015 * 0.015 + 0.01 * 0.01) / (0.15 * 0.15), 2e-3);
  double worst = 0;
  for (std::size_t i = 0; i < map.height.size(); ++i) {
    double const x = map.x[i % 129], y = map.y[i / 129];
    if (std::isfinite(map.height[i])) {
      EXPECT_EQ(filled.height[i], map.height[i]);
    }
    if (std::hypot(x, y) < 0.14) worst = std::fmax(worst, std::fabs(filled.height[i] - smooth(x, y)));
  }
  EXPECT_LT(worst, 0.1e-9);  // zero in the holes would be wrong by 1e-9 and more
}

TEST(Holes, AreRefusedAboveTenPercent) {
  HeightMap map =
      disc_map(65, 5e-3, 0.15, [](double x, double y) { return std::hypot(x, y) < 0.06 ? not_a_number : 1e-9; });
  EXPECT_THAT(message_of([&] { refuse_large_holes(map); }),
              ::testing::HasSubstr("15 % of the points of the height map"));
}

// Law of ET-HF mirrors between two angles.
double halo_law(double angle) { return angle > 15e-6 && angle < 100e-6 ? 3.2145e-9 * std::pow(angle, -2.3986) : 0; }

// Mean over the area of a ring.
double ring_mean(double curvature) {
  constexpr double inner = 0.42, outer = 0.5;
  GaussPoints const gauss(12);
  double sum = 0;
  for (std::size_t i = 0; i < gauss.at.size(); ++i) {
    double const r = inner + (outer - inner) * gauss.at[i];
    sum += gauss.weight[i] * r * mean_irradiance(halo_law, 0.120467, curvature, 1e4, r);
  }
  return sum * (outer - inner) * 2 / (outer * outer - inner * inner);
}

TEST(Halo, MeanOfARingV6) {
  EXPECT_LT(deviation(ring_mean(1 / 5070.0), 8.5928e-7), 1e-5);
  EXPECT_GT(deviation(ring_mean(0), 8.5928e-7), 1e-3);  // without the curvature of the wavefront
}

// The closed form of a flat law, and the square law, whose mean is that of the square of the angle: theta^2 + w^2
// c^2/2.
TEST(Halo, FlatAndSquareLawsW17) {
  double const w = 0.12, l = 1e4, c = 1 / l - 1 / 5070.0;
  for (double x : {0.0, 0.1, 0.5}) {
    EXPECT_LT(deviation(mean_irradiance([](double) { return 2e3; }, w, 1 / 5070.0, l, x), 2e3 / (l * l)), 1e-9);
    double const square = x * x / (l * l) + w * w * c * c / 2;
    EXPECT_LT(deviation(mean_irradiance([](double a) { return a * a; }, w, 1 / 5070.0, l, x), square / (l * l)), 1e-9);
    // A wavefront that converges on the plane scatters from one angle to each point.
    EXPECT_LT(deviation(mean_irradiance([](double a) { return 1 + a; }, w, 1 / l, l, x), (1 + x / l) / (l * l)), 1e-12);
  }
  EXPECT_GE(mean_irradiance([](double a) { return a >= 0 ? 1.0 : not_a_number; }, w, 0, l, -0.2), 0);
}

// The integral over the spot in eq. W.17 itself, point by point.
TEST(Halo, IsTheIntegralOverTheSpotW17) {
  auto const law = [](double a) { return 3.2e-9 * std::pow(a * a + 1e-12, -1.2); };
  double const w = 0.12, l = 1e4, curvature = 1 / 5070.0, x = 0.46;
  double sum = 0;
  int const half = 160;
  for (int i = -half; i <= half; ++i)
    for (int j = -half; j <= half; ++j) {
      double const px = 3 * w * i / half, py = 3 * w * j / half, step = 3 * w / half;
      double const weight = 2 / (pi * w * w) * std::exp(-2 * (px * px + py * py) / (w * w));
      sum += weight * step * step * law(std::hypot(x / l - px * (1 / l - curvature), py * (1 / l - curvature)));
    }
  EXPECT_LT(deviation(mean_irradiance(law, w, curvature, l, x), sum / (l * l)), 1e-6);
  double const beyond = mean_irradiance(law, w, curvature, l, x, 45e-6);  // most of the spot is within 12 urad of 46
  auto const cut = [&law](double a) { return a < 45e-6 ? 0 : law(a); };
  EXPECT_LT(deviation(beyond, mean_irradiance(cut, w, curvature, l, x)), 1e-5);
  EXPECT_GT(deviation(beyond, sum / (l * l)), 0.2);  // control
  EXPECT_EQ(mean_irradiance(law, w, curvature, l, x, 1e-2), 0);
}

// A spot that is seen within a fraction of a microradian takes as few evaluations as a wide one, in its tails too. The
// integral over the angle itself takes millions.
TEST(Halo, TakesFewEvaluationsOfTheBsdf) {
  int evaluations = 0;
  auto const law = [&evaluations](double a) {
    ++evaluations;
    return 3.2e-9 * std::pow(a, -2.4);
  };
  double const l = 5649, w = 0.0767, curvature = 1 / 5500.0;
  EXPECT_GT(mean_irradiance(law, w, curvature, l, 80e-6 * l, 80e-6), 0);  // half of the spot
  EXPECT_GT(mean_irradiance(law, w, curvature, 4350, 0.28, 80e-6), 0);    // 8 standard deviations from its centre
  EXPECT_LT(evaluations, 300);
}

// Eq. 3.8 at a small angle: a surface with S2 scatters 16 pi^2/lambda^4 S2.
TEST(Halo, SpectrumOfALawW20) {
  EXPECT_LT(deviation(height_spectrum(16 * pi * pi / std::pow(nd_yag, 4) * 7e-30, nd_yag), 7e-30), 1e-12);
}

}  // namespace
}  // namespace straytrace::height_maps
