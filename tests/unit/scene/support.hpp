// SPDX-License-Identifier: BSD-3-Clause
// Reads models from texts in memory and collects the messages about them.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "scene/scene.hpp"

namespace straytrace::test {

inline Scene scene_of(FileTexts const& texts, std::vector<std::string> const& overrides = {}) {
  return read_scene("arm.yaml", overrides, &texts);
}

inline Scene scene_of(std::string const& body, std::vector<std::string> const& overrides = {}) {
  return scene_of(FileTexts{{"arm.yaml", "straytrace: 1\n" + body}}, overrides);
}

// The rendered errors, empty when there are none.
inline std::string errors_of(FileTexts const& texts, std::vector<std::string> const& overrides = {}) {
  try {
    scene_of(texts, overrides).throw_if_problems();
  } catch (InputError const& e) {
    return e.what();
  }
  return {};
}

inline std::string errors_of(std::string const& body, std::vector<std::string> const& overrides = {}) {
  return errors_of(FileTexts{{"arm.yaml", "straytrace: 1\n" + body}}, overrides);
}

// The same after a reader has read the scene.
inline std::string said_by(Scene const& scene) {
  try {
    scene.throw_if_problems();
  } catch (InputError const& e) {
    return e.what();
  }
  return {};
}

// The value of `x` as a parameter, read with a dimension; NaN and errors in `said` when rejected.
inline double value_of(std::string const& expression, Dimension d, std::string const& params = "",
                       std::string* said = nullptr) {
  Scene const scene = scene_of("params: {" + params + "}\ntrace: {x: " + expression + "}\n");
  double const value = scene.table("trace").number("x", d);
  try {
    scene.throw_if_problems();
  } catch (InputError const& e) {
    if (said) *said = e.what();
    return not_a_number;
  }
  return value;
}

inline std::string error_text_of(std::string const& expression, Dimension d, std::string const& params = "") {
  std::string said;
  value_of(expression, d, params, &said);
  return said;
}

}  // namespace straytrace::test
