// SPDX-License-Identifier: BSD-3-Clause
// `like: NAME` in a material: everything of another material that is not stated here; scatter laws stated here are
// added.
#pragma once

#include "scene/scene_document.hpp"

namespace straytrace {

void take_over_materials(SceneDocument&, NodeData& model);

}  // namespace straytrace
