// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "scene/scene.hpp"

namespace straytrace {

// The model as YAML text: parameters in SI, sections as written after includes, and one line per instance.
std::string resolved_text(Node const& root, std::vector<Scene::Instance> const&);

}  // namespace straytrace
