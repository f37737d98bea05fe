// SPDX-License-Identifier: BSD-3-Clause
// Cells of maps: values without an error are marked.
#include <gtest/gtest.h>

#include <cmath>

#include "base/every_module.hpp"
#include "results/receivers/receivers.hpp"

namespace straytrace::test {
namespace {

// One cell that got `block` in each of 32 blocks, as in the tally; `uneven`: relative, up and down.
CellEstimates one_cell(double block, double uneven) {
  MapSums map;
  map.sum = map.sum2 = {0};
  for (int b = 0; b < 32; ++b) {
    double const x = block * (1 + (b % 2 ? uneven : -uneven));
    map.sum[0] += x;
    map.sum2[0] += x * x;
  }
  return cell_estimates(map, 32 * largest_block, 32);
}

// The tail of a Gaussian beam falls without end; the square of what is left there underflows, first in single blocks.
TEST(CellEstimates, FaintLightHasNoError) {
  for (double const block : {1e-200, 1e-161, 1e-150, 1e-146}) {
    CellEstimates const cell = one_cell(block, 0.1);
    EXPECT_NEAR(cell.mean[0] * largest_block / block, 1, 1e-12);
    EXPECT_TRUE(std::isnan(cell.error[0])) << block;
  }
  CellEstimates const bright = one_cell(1e-140, 0.1);  // negative control
  EXPECT_NEAR(bright.error[0] / bright.mean[0], 0.1 / std::sqrt(31), 1e-9);
}

// Blocks that got the same show no spread: that is not an error of 0, but at most the light of one of them.
TEST(CellEstimates, EqualBlocksHaveTheErrorOfOne) {
  for (double const block : {0.5, 0.1, 0.7}) {
    CellEstimates const cell = one_cell(block, 0);
    EXPECT_NEAR(cell.error[0] * 32 / cell.mean[0], 1, 1e-12) << block;
  }
  EXPECT_LT(one_cell(0.5, 1e-3).error[0], one_cell(0.5, 0).error[0]) << "control: a spread that shows";
  EXPECT_TRUE(std::isnan(one_cell(0, 0).mean[0]));  // no light recorded
}

}  // namespace
}  // namespace straytrace::test
