// SPDX-License-Identifier: BSD-3-Clause
// Names of routes in tables of text, whose columns must stay narrow.
#pragma once

#include <string>
#include <vector>

namespace straytrace::results {

// Each name with whole steps left out around "…" until it has at most `width` characters; its first and last step
// always stay. Different names look different where that is possible.
std::vector<std::string> shortened_routes(std::vector<std::string> const& names, std::size_t width);

}  // namespace straytrace::results
