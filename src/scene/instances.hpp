// SPDX-License-Identifier: BSD-3-Clause
// The `scene` list with `use`, parts of parts and `repeat` expanded.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "scene/scene.hpp"
#include "scene/scene_document.hpp"

namespace straytrace::scene {

std::vector<Scene::Instance> expand_scene(SceneDocument&, Node const& root);

// Along which parts are repeated, by Instance::repeat_axis.
constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};

}  // namespace straytrace::scene
