// SPDX-License-Identifier: BSD-3-Clause
// Beams of a scene that are light of its interferometer: their power is that of the solved network.
#pragma once

#include "ifo/interferometer.hpp"
#include "scene/scene.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {

// The world of a scene; beams with `network` have the power of that beam of the interferometer.
World build_lit_world(Scene const&);
// A place that the table states for a port of such a beam must be lit by that beam. Names of beams and ports must not
// be those of the network.
void check_network_beams(Scene const&, Interferometer const&);

}  // namespace straytrace::session
