// SPDX-License-Identifier: BSD-3-Clause
// `coating` of `specular`: a preset, or a table of shares against angle and wavelength
// (docs/reference/interfaces/coating.md).
#pragma once

#include <optional>

#include "world/read_parts.hpp"

namespace straytrace {

// Nothing when the table is wrong, and reported.
std::optional<Coating> read_coating(Node const& specular, World&);

}  // namespace straytrace
