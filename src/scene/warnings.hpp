// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "scene/scene.hpp"

namespace straytrace {

// Every warning of the scene with its place, as a JSON list (problems_as_json); empty when there is none.
std::string warnings_as_json(Scene const&);

}  // namespace straytrace
