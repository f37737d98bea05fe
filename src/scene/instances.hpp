// SPDX-License-Identifier: BSD-3-Clause
// The `scene` list with `use`, parts of parts and `repeat` expanded.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/input/document.hpp"
#include "scene/scene.hpp"
#include "scene/scene_document.hpp"

namespace straytrace {

std::vector<Scene::Instance> expand_scene(SceneDocument&, Node const& root);

// `repeat`: where the instances of an entry stand and which parameters each of them has (docs/reference/scene.md).

// A column of a table besides the position: sets the parameter of that name.
struct RepeatColumn {
  std::string name;
  Dimension dimension;
  std::uint32_t line = 0, column = 0;  // of its header
};

struct Repeat {
  int axis = -1;                   // 0, 1, 2 = x, y, z; -1: not repeated
  std::vector<double> offsets{0};  // m along the axis, one per instance; empty when the input is wrong
  std::vector<RepeatColumn> columns{};
  std::vector<std::vector<Value>> rows{};  // one value per column, one row per instance
};

constexpr std::size_t most_instances = 1000000;

// `entry` holds `repeat` or not.
Repeat read_repeat(Node const& entry);

// "z [m], aperture [cm]" and rows of numbers. Problems are reported at their place in the file.
Repeat read_offset_table(Node const& name);

}  // namespace straytrace
