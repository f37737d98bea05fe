// SPDX-License-Identifier: BSD-3-Clause
// Physical and mathematical constants in SI units (docs/theory/conventions.md).
#pragma once

#include <limits>

#include "base/namespaces.hpp"

namespace straytrace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180;             // rad
constexpr double speed_of_light = 299792458.0;  // m/s
constexpr double hbar = 1.054571817e-34;        // J s
constexpr double boltzmann = 1.380649e-23;      // J/K

}  // namespace straytrace
