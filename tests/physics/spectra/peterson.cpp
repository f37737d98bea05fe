// SPDX-License-Identifier: BSD-3-Clause
// Ground noise models (docs/theory/environment.md, eq. 11.1 and its table; case A21).
#include <gtest/gtest.h>

#include <cmath>

#include "base/every_module.hpp"
#include "spectra/spectrum.hpp"
#include "support/recorded.hpp"

namespace straytrace::signal_peterson {
namespace {

struct Row {
  double hz, low, high;  // m/sqrt(Hz)
};
constexpr Row table[] = {{0.1, 1.65e-8, 4.11e-6}, {0.2, 5.58e-8, 8.26e-6}, {0.3, 1.70e-8, 2.86e-6},
                         {1, 1.21e-10, 3.64e-8},  {2, 2.67e-11, 1.11e-8},  {5, 4.69e-12, 1.48e-8},
                         {10, 1.01e-12, 6.75e-9}};

TEST(Peterson, TableOfDisplacement) {  // three printed digits: 0.5 %
  for (Row const& r : table) {
    EXPECT_LT(testing::deviation(peterson_asd(GroundModel::low, r.hz), r.low), 5e-3);
    EXPECT_LT(testing::deviation(peterson_asd(GroundModel::high, r.hz), r.high), 5e-3);
    EXPECT_GT(testing::deviation(peterson_asd(GroundModel::typical, r.hz), r.low), 0.5);  // negative control
  }
}

TEST(Peterson, TypicalIsTheGeometricMean) {
  EXPECT_NEAR(peterson_asd(GroundModel::typical, 0.2), 6.8e-7, 0.05e-7);
  EXPECT_NEAR(peterson_asd(GroundModel::typical, 1), 2.1e-9, 0.05e-9);
  EXPECT_NEAR(peterson_asd(GroundModel::typical, 10), 8.3e-11, 0.09e-11);  // public code, which interpolates
}

TEST(Peterson, SpectrumFollowsTheModelAndItsContinuation) {
  Spectrum const s = peterson(GroundModel::high, 0.05, 1000);
  for (double hz : {0.07, 0.19, 0.33, 3.0, 9.9, 40.0, 900.0})
    EXPECT_NEAR(std::sqrt(s.at(hz)) / peterson_asd(GroundModel::high, hz), 1, 2e-3) << hz;
  EXPECT_NEAR(s.at(400) / s.at(40), 1e-4, 1e-7);  // displacement ASD 1/f^2 above 10 Hz
  EXPECT_EQ(s.at(0.04), 0);
}

}  // namespace
}  // namespace straytrace::signal_peterson
