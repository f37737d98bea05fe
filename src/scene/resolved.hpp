// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "base/document.hpp"
#include "scene/scene.hpp"

namespace straytrace {

// The model as YAML text: parameters in SI, sections as written after includes, and one line per instance.
std::string resolved_text(Node const& root, std::vector<Scene::Instance> const&);

std::string si_text(std::optional<Value> const&);  // "0.35 m", "1e-05 m peak"; what reads back as the same value
std::string yaml_text(std::string const&);         // plain where YAML reads it back as the same text, otherwise quoted

}  // namespace straytrace
