// SPDX-License-Identifier: BSD-3-Clause
// What is refused before a text is read as YAML: size, broken UTF-8, control characters, tabs, directives.
#pragma once

#include <optional>
#include <string>

#include "scene/scene_document.hpp"

namespace straytrace {

// The text to hand to the parser (byte order mark and tabs blanked), or nothing when it cannot be read.
// All that is refused is recorded.
std::optional<std::string> checked_text(SceneDocument&, std::uint32_t file);

}  // namespace straytrace
