// SPDX-License-Identifier: BSD-3-Clause
// Strain, length and phase of a detector with arms along x and y (docs/theory/conventions.md). Lengths in m, phases in
// rad.
#pragma once

#include <cstdint>

#include "base/math/constants.hpp"

namespace straytrace {

enum class Arm : std::uint8_t { x, y };

// Length change of one arm of length L by a gravitational wave h: +hL/2 along x, -hL/2 along y.
constexpr double arm_change(Arm arm, double strain, double length) {
  return (arm == Arm::x ? 1 : -1) * strain * length / 2;
}
// DARM = dLx - dLy: the change of one arm alone contributes fully, with the sign of the arm.
constexpr double darm_of_changes(double along_x, double along_y) { return along_x - along_y; }
constexpr double darm_of_strain(double strain, double length) { return strain * length; }
constexpr double strain_of_darm(double darm, double length) { return darm / length; }
// Phase of a round trip: 4 pi/lambda per m.
constexpr double phase_of_length(double change, double wavelength) { return 4 * pi * change / wavelength; }
constexpr double length_of_phase(double phase, double wavelength) { return phase * wavelength / (4 * pi); }

}  // namespace straytrace
