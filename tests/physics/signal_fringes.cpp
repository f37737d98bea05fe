// SPDX-License-Identifier: BSD-3-Clause
// Highest fringe frequency of a sine motion (physics.md eq. 7.1, 7.2; cases A2, B1).
#include <gtest/gtest.h>

#include "sine_fringes.hpp"

namespace straytrace {
namespace {

double top(double peak, double hz) { return cutoff(phase_amplitude(peak, 1064e-9), hz); }
double off(double value, double expected) { return std::fabs(value / expected - 1); }

TEST(Fringes, CutOff) {  // A2, tolerance 1e-4
  EXPECT_LT(off(top(14e-6, 0.42), 69.446), 1e-4);
  EXPECT_LT(off(top(1e-6, 0.15), 1.7716), 1e-4);
  EXPECT_LT(off(top(10e-6, 0.15), 17.7157), 1e-4);
  EXPECT_LT(off(2 * pi * 0.42 * 14e-6, 36.945e-6), 1e-4);                          // highest speed, m/s
  EXPECT_LT(off(top(14e-6, 0.42), 2 * (2 * pi * 0.42 * 14e-6) / 1064e-9), 1e-12);  // eq. 7.1
  EXPECT_GT(off(top(7e-6, 0.42), 69.446), 1e-4);                                   // twin: peak to peak read as peak
}

TEST(Fringes, ShelfHoldsHalfThePower) {  // eq. 7.6 and 7.10: integral 1/2, power below half the cut-off 1/6
  double half = 0, all = 0;
  int const n = 100000;
  for (int i = 0; i < n; ++i) {
    double const u = (i + 0.5) / n * pi / 2, f = std::sin(u);  // substitution removes the pole at the cut-off
    double const w = shelf_psd(f, 1) * std::cos(u) * pi / 2 / n;
    all += w;
    if (f < 0.5) half += w;
  }
  EXPECT_NEAR(all, 0.5, 1e-4);
  EXPECT_NEAR(half, 1.0 / 6, 1e-4);
  EXPECT_GT(std::fabs(all - 1), 0.1);  // twin: normalised to one quadrature too many
  EXPECT_EQ(shelf_psd(1.1, 1), 0);
}

}  // namespace
}  // namespace straytrace
