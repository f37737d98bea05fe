// SPDX-License-Identifier: BSD-3-Clause
// What the table `interferometer` says about each port of a scene: where its light joins again, and responses measured
// or computed elsewhere.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ifo/interferometer.hpp"
#include "spectra/transfer_function.hpp"

namespace straytrace {

struct PortEntry {
  std::string name;
  InjectionPoint injection_point = InjectionPoint::arm;
  double field_share = 1;  // pick-off (eq. 9.8: its power ratio) and isolation (its root) on the way back
  double copies = 2;       // equal, independent ones of the traced port; powers add
};

// The sub-table `ports`; what it leaves out is as the scene has it. `arms`: copies of what an arm has.
std::vector<PortEntry> read_port_entries(Node const& interferometer, std::vector<TracedPort> const& ports, double arms);
// Where the table says how light of this port joins; the nearest table above when it does not.
Node place_of_entrance(Node const& interferometer, std::string const& port);
// Whether files say what light of this port does, whatever the model of the interferometer says.
bool has_response_files(Node const& interferometer, std::string const& port);
// W that circulate in an arm, as the beams of ports inside an arm say it; 0: none does. Beams that say different powers
// are a problem of the table.
double beam_power_in_arm(Node const& interferometer, std::vector<TracedPort> const&, std::vector<PortEntry> const&);
// Warns of beams of ports inside an arm that state another power than the arms have (W), or whose cavity has another
// length (m).
void warn_of_other_arms(Node const& interferometer, std::vector<TracedPort> const&, std::vector<PortEntry> const&,
                        double arm_power, double arm_length);
// "ITM, ETM: arm, 2 copies; SNEB: end-bench, ...", each with its strain per phase and amplitude at 10 and 100 Hz, or at
// the ends of the band when these lie beyond.
std::string describe(std::vector<PortEntry> const&, Interferometer const&, Band const&);

// A detector of which some ports have responses from files, instead of those it has: table `responses` of the table
// `interferometer`, here called the holder. The detector itself when there is none.
std::unique_ptr<Interferometer> with_responses(std::unique_ptr<Interferometer>, Node const& holder,
                                               std::vector<TracedPort> const& ports, Band const&);

}  // namespace straytrace
