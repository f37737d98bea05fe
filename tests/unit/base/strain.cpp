// SPDX-License-Identifier: BSD-3-Clause
// Strain, length and phase with the sign of each arm (docs/theory/conventions.md, R2.01).
#include "base/math/strain.hpp"

#include <gtest/gtest.h>

#include "support/recorded.hpp"

namespace straytrace {
namespace {

TEST(Strain, LengthAndSignPerArmR2_01) {  // h = 1e-21 over 3000 m: DARM 3.0e-18 m
  double const h = 1e-21, length = 3000, x = arm_change(Arm::x, h, length), y = arm_change(Arm::y, h, length);
  EXPECT_DOUBLE_EQ(x, 1.5e-18);
  EXPECT_DOUBLE_EQ(y, -1.5e-18);
  EXPECT_DOUBLE_EQ(darm_of_changes(x, y), 3.0e-18);
  EXPECT_DOUBLE_EQ(darm_of_strain(h, length), 3.0e-18);
  EXPECT_DOUBLE_EQ(strain_of_darm(darm_of_changes(x, y), length), h);
  EXPECT_EQ(darm_of_changes(x, x), 0);                                          // control: both arms with one sign
  EXPECT_DOUBLE_EQ(strain_of_darm(darm_of_changes(0, 3e-18), length), -1e-21);  // one arm alone counts fully
}

TEST(Strain, PhaseOfALengthIsThatOfTwoPasses) {  // half a wavelength of an arm is a full turn
  EXPECT_DOUBLE_EQ(phase_of_length(532e-9, 1064e-9), 2 * pi);
  EXPECT_DOUBLE_EQ(length_of_phase(phase_of_length(3e-18, 1064e-9), 1064e-9), 3e-18);
}

}  // namespace
}  // namespace straytrace
