// SPDX-License-Identifier: BSD-3-Clause
// The main file, its includes and the built-in parts as one table (docs/reference/scene.md).
#pragma once

#include <memory>

#include "scene/scene_document.hpp"

namespace straytrace::scene {

// The table of the whole model without `straytrace` and `include`. Throws InputError when a file cannot be read as
// YAML, because problems of the rest would be noise.
std::shared_ptr<NodeData> read_model(SceneDocument&, std::string const& main_file);

constexpr int format_version = 1;
// The source that holds them, in a document whose main file is `main`.
constexpr std::uint32_t builtin_source(std::uint32_t main) { return main + 1; }

}  // namespace straytrace::scene
