// SPDX-License-Identifier: BSD-3-Clause
// The main file, its includes and the built-in parts as one table (docs/reference/scene.md).
#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "scene/scene.hpp"
#include "scene/scene_document.hpp"

namespace straytrace::scene {

// The table of the whole model without `straytrace` and `include`. Throws InputError when a file cannot be read as
// YAML, because problems of the rest would be noise.
std::shared_ptr<NodeData> read_model(SceneDocument&, std::string const& main_file,
                                     std::vector<std::string> const& overrides);

constexpr int format_version = 1;
// The source that holds them, in a document whose main file is `main`.
constexpr std::uint32_t builtin_source(std::uint32_t main) { return main + 1; }

// Strict YAML (docs/reference/scene.md): no duplicate keys, anchors, aliases, merge keys, tags, further documents,
// tabs, plain values broken over lines.

// The root of a file; null when the syntax is broken, with the problems recorded.
std::shared_ptr<NodeData> read_yaml(SceneDocument&, std::uint32_t file);

// The `scene` list with `use`, parts of parts and `repeat` expanded.

std::vector<Scene::Instance> expand_scene(SceneDocument&, Node const& root);

// Along which parts are repeated, by Instance::repeat_axis.
constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};

}  // namespace straytrace::scene
