// SPDX-License-Identifier: BSD-3-Clause
// The network of a scene: of its interferometer alone where it has no beams, else of the whole model.
#pragma once

#include "ifo/layout/network_model.hpp"
#include "session/options.hpp"

namespace straytrace::session {

// Throws one InputError with all problems; prints warnings.
NetworkModel read_network_model(SceneOptions const&);

}  // namespace straytrace::session
