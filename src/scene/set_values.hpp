// SPDX-License-Identifier: BSD-3-Clause
// Values set by their place in the model, in the table `set` or on the command line:
// "-p materials.steel.scatter.brdf=5e-3/sr".
#pragma once

#include <string>
#include <vector>

#include "scene/scene_document.hpp"

namespace straytrace::scene {

// A place is two or more keys separated by dots; the name of a parameter contains no dot. An element of a list is
// addressed by its `name` or its number, counted from 0: "scene.ring.at[2]".
bool names_place(std::string const& override_text);
std::vector<std::string> keys_of_place(std::string_view place);  // "scene.ring.at[2]": scene, ring, at, 2

// Replaces the scalars of the merged model that the table `set` names, then those that these overrides name, or adds
// their last key; records problems at their places. Overrides of parameters are left out.
void set_values(SceneDocument&, NodeData& model, std::vector<std::string> const& overrides);

}  // namespace straytrace::scene
