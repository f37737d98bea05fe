// SPDX-License-Identifier: BSD-3-Clause
// Values that the command line sets by their place in the model: "-p materials.steel.scatter.brdf=5e-3/sr".
#pragma once

#include <string>
#include <vector>

#include "scene/scene_document.hpp"

namespace straytrace::scene {

// A place has at least two keys with a point between them, which no parameter has. "scene.ring.at[2]": elements of a
// list by their `name` or their number, counted from 0.
bool names_place(std::string const& override_text);

// Replaces the scalars of the merged model that these overrides name, or adds their last key; records problems at the
// command line. Overrides of parameters are left out.
void set_values(SceneDocument&, NodeData& model, std::vector<std::string> const& overrides);

}  // namespace straytrace::scene
