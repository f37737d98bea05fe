// SPDX-License-Identifier: BSD-3-Clause
// Light of an interferometer, for beams of a scene that are light of it.
#pragma once

#include <map>
#include <set>
#include <string>

#include "scene/scene.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {

struct NetworkPowers {
  bool faulty = false;                  // the interferometer has problems that its reader reports
  std::map<std::string, double> watts;  // by beam of the network, "ITMx.front.out"; empty: there is no network
  // By port of the network: the light that comes to it, named where it leaves ("BS.3.out"), and the length of the
  // space.
  struct Space {
    std::string source;
    double length = 0;  // m
  };
  std::map<std::string, Space> spaces;
  std::string behind_input;      // port behind the input mirror of an arm of a preset; empty: not known
  std::set<std::string> stated;  // lights of the network that beams of the scene name

  // The same light has two names, one at each end of its space.
  std::string named_where_it_leaves(std::string const& light) const {
    auto const port = light.substr(0, light.rfind('.'));
    auto const space = spaces.find(port);
    return light.ends_with(".in") && space != spaces.end() ? space->second.source : light;
  }
  // The light that runs the other way.
  std::string reverse_of(std::string const& light) const {
    auto const dot = light.rfind('.');
    return named_where_it_leaves(light.substr(0, dot) + (light.ends_with(".in") ? ".out" : ".in"));
  }
};

// As build_world, with the powers of beams that state `network`.
World build_world(Scene const&, NetworkPowers const&);

}  // namespace straytrace::world
