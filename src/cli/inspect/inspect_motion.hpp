// SPDX-License-Identifier: BSD-3-Clause
// How far and how fast the bodies of a file move, as understood.
#pragma once

#include <string>

#include "scene/scene.hpp"
#include "session/options.hpp"

namespace straytrace {

// Whether a scene moves bodies and has no materials to show.
bool shows_motion(Scene const&);
// Prints rms per body and coordinate; `plot`: a file of results/curves/curve_file.hpp with the ASDs, none when empty.
int inspect_motion(Scene const&, std::string const& plot, PrintOptions const&);

}  // namespace straytrace
