// SPDX-License-Identifier: BSD-3-Clause
// Worlds of scenes that are written in the test.
#pragma once

#include <string>
#include <utility>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "scene/scene.hpp"
#include "world/model/world.hpp"

namespace straytrace::testing {

struct BuiltScene {
  World world;
  std::string warnings;
};
// Of the file a.yaml among `texts`. Throws InputError with all its problems.
inline BuiltScene built(FileTexts const& texts) {
  Scene const scene = read_scene("a.yaml", {}, &texts);
  BuiltScene all{build_world(scene), {}};
  scene.throw_if_problems();
  all.warnings = scene.warnings();
  return all;
}
inline BuiltScene built(std::string text) { return built(FileTexts{{"a.yaml", std::move(text)}}); }

// Messages about a scene: all its errors, or else its warnings.
inline std::string said_of(std::string const& text) {
  try {
    return built(text).warnings;
  } catch (InputError const& e) {
    return e.what();
  }
}

}  // namespace straytrace::testing
