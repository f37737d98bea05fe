// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "ifo/fabry_perot_michelson.hpp"
#include "ifo/recycled_interferometer.hpp"

namespace straytrace {
namespace {

constexpr std::string_view closed_forms = "fabry-perot-michelson", own_numbers = "dual-recycled";

// No numbers but those that have a neutral value.
DualRecycledPreset without_numbers() {
  DualRecycledParameters p;
  p.arm_length = p.input_transmission = p.mirror_mass = p.input_power = required;
  return {own_numbers, "", p};
}

std::vector<DualRecycledPreset> network_presets() {
  std::vector<DualRecycledPreset> all(dual_recycled_presets().begin(), dual_recycled_presets().end());
  all.push_back(without_numbers());
  return all;
}

}  // namespace

std::unique_ptr<Interferometer> make_interferometer(Node const& table, std::vector<TracedPort> const& ports,
                                                    double wavelength, Band const& band) {
  std::vector<DualRecycledPreset> const networks = network_presets();
  std::vector<std::string_view> names = {closed_forms};
  for (DualRecycledPreset const& p : networks) names.push_back(p.name);
  std::string const name = table.choice("preset", names);
  auto const network = std::find_if(networks.begin(), networks.end(), [&](auto const& p) { return p.name == name; });
  bool const solves = network != networks.end();
  if (!solves && name != closed_forms) return nullptr;  // said by choice()
  std::unique_ptr<Interferometer> ifo = solves ? read_recycled_interferometer(table, *network, ports, wavelength, band)
                                               : read_closed_forms(table, ports, wavelength, band);
  ifo = with_responses(std::move(ifo), table, ports, band);
  table.refuse_unknown("interferometer '" + name + "'");
  return ifo;
}

}  // namespace straytrace
