// SPDX-License-Identifier: BSD-3-Clause
// Curves read at a frequency.
#include "results/curves/band.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/every_module.hpp"

namespace straytrace::test {

// A sine fills one bin: h is its average at every frequency of that bin, below and above the centre, and zero outside.
// Negative control: the bin of the last centre below the frequency, which is zero for half of the frequencies.
TEST(ReportBand, LineIsReadWithinItsBinAndNowhereElse) {
  FrequencyGrid const grid = logarithmic_grid(6, 15, 60);
  std::size_t const line = 13;
  NoiseTrace trace;
  trace.asd.assign(grid.size(), 0);
  trace.sigma.assign(grid.size(), 0);
  trace.asd[line] = 1.7e-24;
  trace.sigma[line] = 1e-26;
  double control_least = infinity;
  for (double const part : {0.001, 0.2, 0.5, 0.8, 0.999}) {
    double const low = grid.edges[line], high = grid.edges[line + 1], hz = low + part * (high - low);
    EXPECT_EQ(strain_at(trace, grid, hz).value, 1.7e-24) << hz;
    EXPECT_EQ(strain_at(trace, grid, hz).sigma, 1e-26) << hz;
    std::size_t below = 0;
    while (below + 2 < grid.size() && grid.centre(below + 1) <= hz) ++below;
    control_least = std::min(control_least, trace.asd[below]);
  }
  EXPECT_EQ(control_least, 0);
  EXPECT_EQ(strain_at(trace, grid, grid.edges[line] * 0.999).value, 0);
  EXPECT_EQ(strain_at(trace, grid, grid.edges[line + 1] * 1.001).value, 0);
}

}  // namespace straytrace::test
