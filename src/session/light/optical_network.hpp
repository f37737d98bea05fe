// SPDX-License-Identifier: BSD-3-Clause
// The optical network of a scene: its model, its beams, and where light of ports joins it.
#pragma once

#include <string>
#include <vector>

#include "ifo/interferometer.hpp"
#include "ifo/network_model.hpp"
#include "scene/scene.hpp"
#include "session/options.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {

// The network of a scene: of its interferometer alone where it has no beams, else of the whole model.

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

// Beams of a scene that are light of its interferometer: their power is that of the solved network.

// The world of a scene; beams with `network` have the power of that beam of the interferometer.
World build_lit_world(Scene const&);
// A place that the table states for a port of such a beam must be lit by that beam. Names of beams and ports must not
// be those of the network.
void check_network_beams(Scene const&, Interferometer const&);

// Where light of the ports of a scene joins the interferometer, as far as the scene determines it.

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
