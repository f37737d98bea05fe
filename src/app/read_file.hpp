// SPDX-License-Identifier: BSD-3-Clause
// A file of the language, a model or motion alone, read by every room that has a part in it.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace straytrace {

// By its first bytes; whether it is sound read_run() tells.
bool is_run_file(std::string const& file);

// A file with nothing to trace holds motion for `straytrace noise --motion`.
bool only_motion(Scene const&);

// Throws one InputError with all problems. `texts`: of a run file, instead of disk.
Scene read_by_all(std::string const& file, std::vector<std::string> const& overrides, FileTexts const* texts = nullptr);

}  // namespace straytrace
