// SPDX-License-Identifier: BSD-3-Clause
// Entries that a model takes from the built-in library (docs/reference/library.md): files below "library/".
#pragma once

#include <string_view>

#include "scene/scene_document.hpp"

namespace straytrace::scene {

inline bool is_library(std::string_view file_name) { return file_name.starts_with("library/"); }

// Removes unused materials, media, parts and bodies of library files from the model, so that they cost nothing and
// cause no messages. A model that names an unknown material or part keeps all except bodies, so that a message can
// suggest one.
void drop_unused(SceneDocument const&, NodeData& model);

// "parameter first_baffle = 10 m: assumed; SOURCE" for each parameter marked so that something in the model names and
// that the command line does not set.
std::vector<std::string> assumed_parameters(Scene const&);

}  // namespace straytrace::scene
