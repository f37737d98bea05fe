// SPDX-License-Identifier: BSD-3-Clause
// What the table `interferometer` says about each port of a scene: where its light joins again, and responses measured
// or computed elsewhere.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ifo/entrance.hpp"
#include "ifo/interferometer.hpp"
#include "ifo/transfer_function.hpp"

namespace straytrace {

struct PortEntry {
  std::string name;
  Entrance entrance = Entrance::arm;
  double field_share = 1;  // pick-off (eq. 9.8: its power ratio) and isolation (its root) on the way back
  double copies = 2;       // equal, independent ones of the traced port; powers add
};

// The sub-table `ports`; ports it leaves out join inside an arm. `arms`: copies of what an arm has.
std::vector<PortEntry> read_port_entries(Node const& interferometer, std::vector<std::string> const& ports,
                                         double arms);
// "ITM, ETM: arm, 2 copies; SNEB: end-bench, ...", each with its strain per phase and amplitude at 10 and 100 Hz.
std::string describe(std::vector<PortEntry> const&, Interferometer const&);

// A detector of which some ports have responses from files, instead of those it has: table `responses` of the table
// `interferometer`, here called the holder. The detector itself when there is none.
std::unique_ptr<Interferometer> with_responses(std::unique_ptr<Interferometer>, Node const& holder,
                                               std::vector<std::string> const& ports);

}  // namespace straytrace
