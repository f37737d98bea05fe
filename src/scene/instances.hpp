// SPDX-License-Identifier: BSD-3-Clause
// The `scene` list with `use`, parts of parts and `repeat` expanded.
#pragma once

#include <memory>
#include <vector>

#include "scene/scene.hpp"
#include "scene/scene_document.hpp"

namespace straytrace {

std::vector<Scene::Instance> expand_scene(SceneDocument&, Node const& root);

}  // namespace straytrace
