// SPDX-License-Identifier: BSD-3-Clause
// Design sensitivities in closed form (docs/theory/environment.md, eq. 12.1, table of 12.2; cases A22, B12).
#include "noise/fundamental/budget.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing {
namespace {

double worst(std::string_view name, std::vector<std::pair<double, double>> const& table) {
  double d = 0;
  for (auto const& [hz, asd] : table) d = std::max<double>(d, deviation(design_asd(name, hz), asd));
  return d;
}

void expect_curve(std::string_view name, std::vector<std::pair<double, double>> const& table, double tolerance) {
  for (auto const& [hz, asd] : table) EXPECT_LT(deviation(design_asd(name, hz), asd), tolerance) << name;
}

std::vector<std::pair<double, double>> const adv = {{10, 1.124e-21}, {100, 4.595e-24}, {1000, 1.870e-23}};
std::vector<std::pair<double, double>> const kagra = {{10, 2.809e-22}, {100, 3.018e-24}, {1000, 1.459e-23}};

TEST(TargetCurves, FitsAndTables) {  // tolerance 1e-3
  expect_curve("adv-lal", adv, 1e-3);
  expect_curve("kagra-lal", kagra, 1e-3);
  expect_curve("et-d-points", {{1, 3.50e-17}, {10, 1.16e-24}, {1000, 5.78e-25}}, 1e-12);
  EXPECT_LT(deviation(design_asd("et-d-points", std::sqrt(200.0)), std::sqrt(1.16e-24 * 9.39e-25)), 1e-9);
  EXPECT_GT(worst("adv-lal", kagra), 0.1);  // control: the curve of another detector
}

TEST(TargetCurves,
     TablesOfPublicBudgets) {  // docs/theory/sensitivity.md: the seven values of ET-D, read off between points
  expect_curve("et-d",
               {{1, 3.50e-17}, {3, 2.21e-23}, {10, 1.16e-24}, {20, 9.39e-25}, {100, 3.93e-25}, {1000, 5.78e-25}}, 3e-3);
  // LIGO-P1600143: points next to 5 Hz, and the line of the suspensions at 420.29 Hz, a per cent wide; printed digits.
  expect_curve("et-d", {{4.9991899, 3.5631545e-24}, {5.0145667, 3.5264629e-24}}, 1.1e-3);
  expect_curve("et-d", {{420.2824, 5.888153e-24}}, 1.1e-3);
  expect_curve("et-d-points", {{5, 3.5612e-24}, {3, 2.2155e-23}}, 3e-3);
  EXPECT_GT(worst("et-d", {{5, 3.53e-24}}), 8e-3);  // control: the neighbour of 5 Hz, where the curve halves in each Hz
  EXPECT_GT(worst("et-d", kagra), 0.1);             // negative control
  // pygwinc 0.6.2 itself at 100 Hz
  expect_curve("aligo-gwinc", {{100, 3.700e-24}}, 1e-3);
  for (std::string const& name : built_in_designs()) EXPECT_GT(design_asd(name, 100), 1e-26) << name;
}

TEST(TargetCurves, NothingOutsideATable) {
  EXPECT_TRUE(std::isnan(design_asd("et-d-points", 0.9)));
  EXPECT_TRUE(std::isnan(design_asd("et-d-points", 2000)));
  EXPECT_TRUE(std::isnan(design_asd("et-d", 0.9)));
  EXPECT_TRUE(std::isnan(design_asd("unknown", 100)));
}

}  // namespace
}  // namespace straytrace::testing
