// SPDX-License-Identifier: BSD-3-Clause
// Problems as text for people (docs/reference/scene.md).
#pragma once

#include <string>

#include "scene/scene.hpp"
#include "scene/scene_document.hpp"

namespace straytrace::scene {

std::string rendered_errors(SceneDocument const&);    // with the closing line "5 errors. Nothing was run."
std::string rendered_warnings(SceneDocument const&);  // one sentence per kind: count and first place
// Throws InputError when the document has errors.
void throw_errors(SceneDocument const&);

// Every warning of the scene with its place, as a JSON list (problems_as_json); empty when there is none.
std::string warnings_as_json(Scene const&);

}  // namespace straytrace::scene
