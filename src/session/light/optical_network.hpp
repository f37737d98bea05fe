// SPDX-License-Identifier: BSD-3-Clause
// The network of a scene: of its interferometer alone where it has no beams, else of the whole model.
#pragma once

#include <string>

#include "ifo/network_model.hpp"
#include "scene/scene.hpp"
#include "session/options.hpp"

namespace straytrace::session {

// An interferometer with a network and nothing to trace.
bool only_network(Scene const&);
// Of such a scene. Throws one InputError with all problems.
NetworkModel read_lone_network(Scene const&);
// Of any scene; prints its warnings.
struct OpticalNetwork {
  std::string title;  // of the scene
  NetworkModel model;
  std::string warnings_json;  // of the scene, as problems_as_json; empty: none
};
OpticalNetwork read_optical_network(SceneOptions const&);

}  // namespace straytrace::session
