// SPDX-License-Identifier: BSD-3-Clause
// The table `sensors` of a scene: sizes of the sensors on the beams of ports, and where their watts are counted.
#pragma once

#include <string>
#include <vector>

#include "noise/project/sensor_noise.hpp"
#include "scene/scene.hpp"

namespace straytrace::session {

// Problems go to the document of the scene. Names in the order of ids.
std::vector<Sensor> read_sensors(Scene const&, std::vector<std::string> const& ports,
                                 std::vector<std::string> const& receivers);

// One for each port of a run, in their order: those of the table, and else sensors larger than their beam. Throws where
// the table has problems. `power`: of the beam of each port, W; `main_power`: that of the main mode. 0: not stated.
std::vector<Sensor> sensors_of_ports(Scene const&, CouplingTable const&, std::vector<double> const& power,
                                     double main_power);

}  // namespace straytrace::session
