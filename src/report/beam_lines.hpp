// SPDX-License-Identifier: BSD-3-Clause
// Main beams of a scene in its pictures.
#pragma once

#include <vector>

#include "report/scene_picture.hpp"
#include "trace/camera/camera.hpp"
#include "world/model/world.hpp"

namespace straytrace::report {

struct BeamLine {
  Vec3 from, to;  // m, of the chief ray
};
// Modes of cavities between their mirrors, and every launched beam at order 0 (world/ghosts/beam_tree.hpp), up to where
// it ends; light that leaves the scene ends at its box.
std::vector<BeamLine> beam_lines(World const&);

// Draws them into a picture of the scene, red, dotted behind what hides them, and adds them to the legend.
void draw_beams(Drawn&, World const&, Camera const&, LookSettings const&, std::vector<BeamLine> const&);

}  // namespace straytrace::report
