// SPDX-License-Identifier: BSD-3-Clause
// Tables of a scene from text, with data files in the same folder.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>

#include "base/every_module.hpp"
#include "scene/scene.hpp"

namespace straytrace::testing {

inline Scene scene_of(std::string const& text, FileTexts files = {}) {
  static std::deque<FileTexts> kept;  // a scene reads data files from its texts on demand
  files["scene.yaml"] = "straytrace: 1\n" + text;
  return read_scene("scene.yaml", {}, &kept.emplace_back(std::move(files)));
}

// All problems of a scene as text; empty when there are none.
inline std::string problems_of(Scene const& scene) {
  try {
    scene.throw_if_problems();
  } catch (InputError const& e) {
    return e.what();
  }
  return {};
}

}  // namespace straytrace::testing
