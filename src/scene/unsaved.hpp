// SPDX-License-Identifier: BSD-3-Clause
// Texts that another program holds and has not saved: an editor, or Python.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace straytrace {

// From now on `text` is read where a model names `file`, which need not exist. Before anything is read.
void set_unsaved(std::filesystem::path const& file, std::string text);
std::optional<std::string> unsaved_text(std::filesystem::path const& file);

}  // namespace straytrace
