// SPDX-License-Identifier: BSD-3-Clause
// The key `rims` of a scene: motion of rims in the main beam (docs/theory/diffraction.md, eq. N.21).
#pragma once

#include "ifo/interferometer.hpp"
#include "scene/scene.hpp"
#include "trace/deterministic/moving_rims.hpp"

namespace straytrace::session {

bool counts_rims(Scene const&);

// A problem at `rims` for a port whose response to the amplitude of its main beam the interferometer does not know.
void check_rims(Scene const&, World const&, Interferometer const&);

}  // namespace straytrace::session
