// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "scene/model_tree.hpp"

namespace straytrace {

// Every key with its value in SI, its origin, and how the readers ask for it (type, unit, range, default, choices).
nlohmann::ordered_json model_as_json(Scene const&);

}  // namespace straytrace
