// SPDX-License-Identifier: BSD-3-Clause
// Names of routes in tables of text, whose columns must stay narrow.
#pragma once

#include <string>
#include <vector>

#include "results/text/columns.hpp"

namespace straytrace::results {

// Each name with whole steps left out around "…" until it has at most `width` characters; its first and last step
// always stay. Different names look different where that is possible.
std::vector<std::string> shortened_routes(std::vector<std::string> const& names, std::size_t width);

// In the column `route`, to a width for terminals; whether one had to be shortened.
bool shorten_routes(Columns&);
inline constexpr char const* explanation_of_shortened =
    "…: steps of a long route that are left out here; CSV and JSON list all of them.\n";

}  // namespace straytrace::results
