// SPDX-License-Identifier: BSD-3-Clause
// Diffuse tubes, short and long (tests/support/diffuse_tube.hpp).
#include "support/diffuse_tube.hpp"

namespace straytrace::testing {
namespace {

TEST(DiffuseTube, ShortScene5) {
  expect_tubes({{1, 1, 0.671984, 2e-2, 1 << 16},
                {1, 0.5, 0.490881, 2e-2, 1 << 16},
                {1, 0.05, 0.390824, 2e-2, 1 << 16},
                {1, 0, 0.381966, 2e-2, 1 << 16},
                {2, 1, 0.514231, 2e-2, 1 << 17},
                {2, 0.5, 0.262203, 2e-2, 1 << 16},
                {2, 0.05, 0.177722, 2e-2, 1 << 16},
                {2, 0, 0.171573, 2e-2, 1 << 16}},
               false);
}
TEST(DiffuseTube, LongScene5) {
  expect_tubes({{10, 1, 0.190942, 4e-2, 1 << 18},
                {10, 0.5, 0.0129496, 1e-2, 1 << 17},
                {10, 0.05, 9.95106e-3, 5e-3, 1 << 16},
                {10, 0, 9.80486e-3, 5e-3, 1 << 16},
                {100, 0.5, 1.017657e-4, 1e-3, 1 << 16}},
               true);
}

// Where light is lost nowhere every place is worth about the same: aiming must not cost what bounces add up
// (docs/theory/sampling.md). Control: a fixed share of the law.
TEST(DiffuseTube, EnclosureIsNotSpoiledByAiming) {
  auto const error = [](Aim aim) {
    SampleMean const t = transmission(10, 1, 1 << 15, aim);
    return t.std_error / t.mean;
  };
  double const law = error(Aim::none);
  EXPECT_LT(error(Aim::as_made), 1.3 * law);
  EXPECT_GT(error(Aim::fixed_share), 2 * law);
}

// The test distinguishes the numbers, and finds a wall 1 % wider.
TEST(DiffuseTube, ControlsAreRejected) {
  SampleMean const t = transmission(2, 0.5, 1 << 17, Aim::none);
  expect_rejected("direct light alone", t, 0.171573);
  expect_rejected("a perfect wall", t, 0.514231);
  expect_rejected("1 % wider", transmission(2, 0.5, 1 << 17, Aim::none, 1.01), 0.262203);
}

}  // namespace
}  // namespace straytrace::testing
