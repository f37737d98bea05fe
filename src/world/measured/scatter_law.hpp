// SPDX-License-Identifier: BSD-3-Clause
// The law that measured points make.
#pragma once

#include <string_view>
#include <vector>

#include "optics/measured.hpp"
#include "world/measured/scatter_file.hpp"

namespace straytrace {

// Beyond this relative difference the total a file states and the integral of its values are said to disagree.
constexpr double stated_tis_tolerance = 0.05;

// Without its lobe: the caller prepares it when it samples. `beyond`: constant, power or zero.
Measured law_of_points(std::vector<ScatterPoint> const&, std::string_view beyond, MeasuredSummary&);

}  // namespace straytrace
