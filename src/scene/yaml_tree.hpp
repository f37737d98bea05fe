// SPDX-License-Identifier: BSD-3-Clause
// Strict YAML (docs/reference/scene.md): no duplicate keys, anchors, aliases, merge keys, tags, further documents,
// tabs, plain values broken over lines.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "scene/scene_document.hpp"

namespace straytrace {

// The root of a file; null when the syntax is broken, with the problems recorded.
std::shared_ptr<NodeData> read_yaml(SceneDocument&, std::uint32_t file);

// As the parser gives it: line and column from 0, in bytes.
struct SyntaxComplaint {
  int line = 0, column = 0;
  std::string text;
};

// Records the cause in words of the input language: a bracket left open, a value that ran into the next line
// (`broken_lines`, found before the complaint), or else what the parser says.
void report_syntax(SceneDocument&, std::uint32_t file, std::vector<Problem> const& broken_lines,
                   SyntaxComplaint const&);

// What is refused before a text is read as YAML: size, broken UTF-8, control characters, tabs, directives.

// The text to hand to the parser (byte order mark and tabs blanked), or nothing when it cannot be read.
// All that is refused is recorded.
std::optional<std::string> checked_text(SceneDocument&, std::uint32_t file);

}  // namespace straytrace
