// SPDX-License-Identifier: BSD-3-Clause
// Power of the beams of an interferometer, for beams of a scene that are light of it.
#pragma once

#include <map>
#include <string>

#include "scene/scene.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {

struct NetworkPowers {
  bool faulty = false;                  // the interferometer has problems that its reader reports
  std::map<std::string, double> watts;  // by beam of the network, "ITMx.front.out"; empty: there is no network
};

// As build_world, with the powers of beams that state `network`.
World build_world(Scene const&, NetworkPowers const&);

}  // namespace straytrace::world
