// SPDX-License-Identifier: BSD-3-Clause
// Built-in design sensitivities (docs/theory/sensitivity.md). The name states the source: curves of one detector differ
// by factors.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::noise {

// "adv-lal", "kagra-lal" (formulas), "et-d-points" (seven points), and the tables of data/curves: "et-d",
// "aligo-gwinc", "aplus-gwinc", "ce1-gwinc", "ce2-silica-gwinc".
std::span<std::string const> built_in_designs();

// Budgets (data/detectors) of the detectors that the curve is of, whose numbers it depends on; of xylophones each.
// Empty for a name that is not built in.
std::vector<std::string> detectors_of_design(std::string_view name);

// Strain ASD in 1/sqrt(Hz); NaN outside the range of a table and for an unknown name.
double design_asd(std::string_view name, double hz);

}  // namespace straytrace::noise
