// SPDX-License-Identifier: BSD-3-Clause
// The table `network` of an interferometer (docs/reference/network.md).
#pragma once

#include <optional>

#include "base/input/table.hpp"
#include "ifo/interferometer.hpp"
#include "ifo/network_model.hpp"

namespace straytrace::ifo {

// The beam that a node names, "PRM.front.out"; a problem and nothing where there is none.
std::optional<NetworkBeam> read_beam(Node const&, Network const&);
// Components and spaces of the table; `base`: the network that they change. Problems stay in the document.
NetworkChanges read_network_changes(Node const& network, Network const& base, std::vector<DrawnOptic> const& optics);
// Modes in place of plane waves. Tries the bases, so that a scene without them gets an error at 'modes'.
std::optional<ModeSettings> read_modes(Node const& network_table, Network);
// Read-outs and degrees of freedom, of a network with its changes; those of the same name are replaced.
void read_network_questions(Node const& network, NetworkModel& model);
// A network without a preset. `wavelength`: of the beams of the scene, m; not a number: there are none.
std::optional<NetworkModel> read_bare_network(Node const& interferometer, double wavelength,
                                              std::vector<DrawnOptic> const& optics = {});

// The network of any table `interferometer`, without what it says of ports. Nothing with a problem, or of closed forms.
std::optional<NetworkModel> read_network_alone(Node const& interferometer, double wavelength,
                                               std::vector<DrawnOptic> const& optics = {});

}  // namespace straytrace::ifo
