// SPDX-License-Identifier: BSD-3-Clause
// Mirrors of a scene that its interferometer may name: `optic`.
#pragma once

#include <vector>

#include "ifo/interferometer.hpp"
#include "scene/scene.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {

// Disks and caps with a name of their own; none where no mirror of the interferometer names an optic.
std::vector<DrawnOptic> drawn_optics(Node const& interferometer, World const&);
// The same from a second reading of the scene, before its beams are known.
std::vector<DrawnOptic> drawn_optics(Scene const&);
// Those that the interferometer names.
std::vector<DrawnOptic> named_optics(Node const& interferometer, std::vector<DrawnOptic> const&);

}  // namespace straytrace::session
