// SPDX-License-Identifier: BSD-3-Clause
// The ports of a scene in the table `interferometer`: where their light rejoins, and responses from files.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "ifo/interferometer.hpp"
#include "ifo/network_model.hpp"
#include "spectra/filters.hpp"

namespace straytrace::ifo {

// Names of ways back on a beam of the presets besides `entrance_names`.
struct BeamSynonym {
  std::string_view name, beam;  // the beam that the light joins
};
constexpr std::array<BeamSynonym, 3> beam_synonyms = {{{"short-arm-to-splitter", "BS.3.in"},
                                                       {"signal-cavity-to-splitter", "BS.4.in"},
                                                       {"recycling-cavity-to-mirror", "PRM.back.in"}}};

struct PortEntry {
  std::string name;
  InjectionPoint injection_point = InjectionPoint::arm;
  double field_share = 1;         // pick-off (eq. 9.8: its power ratio) and isolation (its root) on the way back
  double reference = 1;           // of TracedPort; its inverse is in field_share
  double copies = 2;              // equal, independent ones of the traced port; powers add
  std::string at{};               // a beam of the network or its synonym, instead of the injection point
  std::string lit_by{};           // the light that is scattered, stated by the beams of the scene
  bool both_sides = false;        // of a face that returns the light of both sides (eq. N.20)
  std::optional<StrayWay> way{};  // from it, once the network is known

  bool picked_off() const { return std::fabs(field_share * reference - 1) > 1e-12; }
  bool is_inside_an_arm() const { return at.empty() && ifo::is_inside_an_arm(injection_point); }
  std::string place() const { return at.empty() ? std::string(entrance_names[std::size_t(injection_point)]) : at; }
};

// The sub-table `ports`; defaults come from the scene. `arms`: number of copies of a port in an arm.
std::vector<PortEntry> read_port_entries(Node const& interferometer, std::vector<TracedPort> const& ports, double arms);
// Finds the beams that ports name. `arms`: copies of one in arm x or y of a preset.
void resolve_beams(Node const& interferometer, Network const&, double arms, std::vector<PortEntry>&);
// Ports with beams become entrances of the model, in the place of those of their name.
void add_entrances(std::vector<PortEntry> const&, NetworkModel&);
// The place of a preset in any network that has its mirror; nothing where it has none.
std::optional<Injection> injection_in(Network const&, SteadyField const&, InjectionPoint);
std::optional<NamedWay> entrance_in(Network const&, SteadyField const&, InjectionPoint);
// Ports of a network without a preset that name a place of a preset in `at`.
void resolve_places(Node const& interferometer, Network const&, std::vector<PortEntry>&);
// The entrances that the table `ports` of a network alone names.
void read_entrances(Node const& interferometer, std::vector<TracedPort> const&, NetworkModel&);
// The node that states where light of this port joins; the nearest table above when there is none.
Node place_of_entrance(Node const& interferometer, std::string const& port);
// Whether files give the response of this port instead of the model of the interferometer.
bool has_response_files(Node const& interferometer, std::string const& port);
// Power in W that circulates in an arm, stated by the beams of ports inside an arm; 0: not stated. Beams with different
// powers are a problem of the table.
double beam_power_in_arm(Node const& interferometer, std::vector<TracedPort> const&, std::vector<PortEntry> const&);
// Warns of beams of ports inside an arm that state another power than the arms have (W), or whose cavity has another
// length (m).
void warn_of_other_arms(Node const& interferometer, std::vector<TracedPort> const&, std::vector<PortEntry> const&,
                        double arm_power, double arm_length);
// "ITM, ETM: arm, 2 copies; SNEB: end-bench, ...", each with its strain per phase and amplitude at 10 and 100 Hz, or at
// the ends of the band when these lie beyond. Ports of light between beams are counted.
std::string describe(std::vector<PortEntry> const&, Interferometer const&, Band const&);

// A detector of which some ports have responses from files, instead of its own: table `responses` of the table
// `interferometer`, here called the holder. The detector itself when there is none.
std::unique_ptr<Interferometer> with_responses(std::unique_ptr<Interferometer>, Node const& holder,
                                               std::vector<TracedPort> const& ports, Band const&);

}  // namespace straytrace::ifo
