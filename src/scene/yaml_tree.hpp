// SPDX-License-Identifier: BSD-3-Clause
// Strict YAML (docs/reference/scene.md): no duplicate keys, anchors, aliases, merge keys, tags, further documents,
// tabs, plain values broken over lines.
#pragma once

#include <memory>

#include "scene/scene_document.hpp"

namespace straytrace::scene {

// The root of a file; null when the syntax is broken, with the problems recorded.
std::shared_ptr<NodeData> read_yaml(SceneDocument&, std::uint32_t file);

}  // namespace straytrace::scene
