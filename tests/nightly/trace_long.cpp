// SPDX-License-Identifier: BSD-3-Clause
// Tests that take minutes: the scenes of docs/theory/sampling.md at the accuracy stated there.
#include "support/baffled_tube.hpp"
#include "support/diffuse_tube.hpp"

namespace straytrace::testing {
namespace {

// Receiver A to 0.1 %.
TEST(NightlyBaffledTube, EstimatorsAgreeScene11) { expect_estimators_agree(3 << 23, 1e-3); }

// Clausing's problem in a long tube.
TEST(NightlyDiffuseTube, LosslessScene5) { expect_tubes({{10, 1, 0.190942, 1e-2, 1 << 22}}, false); }

TEST(NightlyDiffuseTube, ControlsAreRejected) {
  expect_rejected("1 % less", transmission(10, 1, 1 << 22, Aim::none), 0.99 * 0.190942);
}

}  // namespace
}  // namespace straytrace::testing
