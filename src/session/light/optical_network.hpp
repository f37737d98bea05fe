// SPDX-License-Identifier: BSD-3-Clause
// The network of a scene: of its interferometer alone where it has no beams, else of the whole model.
#pragma once

#include <string>
#include <vector>

#include "ifo/interferometer.hpp"
#include "ifo/network_model.hpp"
#include "scene/scene.hpp"
#include "session/options.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {

// Disks and caps with a name of their own; none where no mirror of the interferometer names an optic.
std::vector<DrawnOptic> drawn_optics(Node const& interferometer, World const&);
// The same from a second reading of the scene, before its beams are known.
std::vector<DrawnOptic> drawn_optics(Scene const&);
// Those that the interferometer names.
std::vector<DrawnOptic> named_optics(Node const& interferometer, std::vector<DrawnOptic> const&);

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
