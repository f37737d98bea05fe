// SPDX-License-Identifier: BSD-3-Clause
// Where light of the ports of a scene joins the interferometer, as far as the scene determines it.
#pragma once

#include <vector>

#include "ifo/interferometer.hpp"
#include "scene/scene.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {

// Ports in the order of PortId: behind the second mirror of a cavity `through_end`, at it `end_mirror`, elsewhere
// `arm`; of a port at several places the first of these that holds, from the input mirror on. Ports of faulty
// entries come last, so that their names cause no further messages.
std::vector<TracedPort> traced_ports(Scene const&, World const&);

// Light that `lit` followed through a mirror of a cavity has passed it in its coupling already, twice; the places
// behind that mirror would count the transmission again (docs/theory/interferometer.md, eq. 9.3). A problem at the port
// that names one.
void check_entrances(Node const& interferometer, std::vector<TracedPort> const&);

// Behind the input mirror the light of the cavity interferes with the light that comes from the splitter, which `lit`
// and `ghosts` do not follow (docs/theory/interferometer.md, eq. 9.5): surfaces lit there are a problem, ghosts there
// are left out with a warning. End mirrors pass some ppm, and nothing comes from behind them.
void refuse_input_mirrors(Scene const&, World const&);
void warn_of_ghosts_left_out(Scene const&, World const&);

}  // namespace straytrace::session
