// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene_document.hpp"

namespace straytrace {

// As the parser gives it: line and column from 0, in bytes.
struct SyntaxComplaint {
  int line = 0, column = 0;
  std::string text;
};

// Records the cause in words of the input language: a bracket left open, a value that ran into the next line
// (`broken_lines`, found before the complaint), or else what the parser says.
void report_syntax(SceneDocument&, std::uint32_t file, std::vector<Problem> const& broken_lines,
                   SyntaxComplaint const&);

}  // namespace straytrace
