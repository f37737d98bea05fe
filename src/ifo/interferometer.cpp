// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "ifo/dual_recycled.hpp"
#include "ifo/fabry_perot_michelson.hpp"
#include "ifo/layout/read_network.hpp"
#include "ifo/network_interferometer.hpp"

namespace straytrace::ifo {
namespace {

constexpr std::string_view closed_forms = "fabry-perot-michelson", own_numbers = "dual-recycled", no_preset = "none";

// Only numbers with a neutral value.
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
                                                    double wavelength, Band const& band,
                                                    std::vector<DrawnOptic> const& optics) {
  std::vector<DualRecycledPreset> const networks = network_presets();
  std::vector<std::string_view> names = {closed_forms};
  for (DualRecycledPreset const& p : networks) names.push_back(p.name);
  names.push_back(no_preset);
  std::string const name = table.choice("preset", names);
  if (name == no_preset) {
    auto bare = read_network_interferometer(table, ports, wavelength, band, optics);
    if (bare) bare = with_responses(std::move(bare), table, ports, band);
    table.refuse_unknown("interferometer 'none'");
    return bare;
  }
  auto const network = std::ranges::find_if(networks, [&](auto const& p) { return p.name == name; });
  bool const solves = network != networks.end();
  if (!solves && name != closed_forms) return nullptr;  // choice() reported it
  std::unique_ptr<Interferometer> ifo =
      solves ? read_recycled_interferometer(table, *network, ports, wavelength, band, optics)
             : read_closed_forms(table, ports, wavelength, band);
  ifo = with_responses(std::move(ifo), table, ports, band);
  table.refuse_unknown("interferometer '" + name + "'");
  return ifo;
}

std::optional<NetworkModel> read_network_alone(Node const& table, double wavelength,
                                               std::vector<DrawnOptic> const& optics) {
  std::string const name = table["preset"].text();
  if (name == no_preset) return read_bare_network(table, wavelength, optics);
  std::vector<DualRecycledPreset> const networks = network_presets();
  auto const preset = std::ranges::find_if(networks, [&](auto const& p) { return p.name == name; });
  return preset == networks.end() ? std::nullopt : read_preset_network(table, *preset, wavelength, optics);
}

// Detectors of docs/theory/sensitivity.md; sources and marks in docs/reference/interferometer.md. Where budgets of the
// same detectors (data/detectors) differ, tests/unit/results/presets.cpp gives the reason.

std::span<DualRecycledPreset const> dual_recycled_presets() {
  static std::array<DualRecycledPreset, 6> const presets = {{
      {"adv",
       "Advanced Virgo",
       {.arm_length = 2999.8,
        .input_transmission = 0.014,
        .end_transmission = 4.4e-6,
        .round_trip_loss = 75e-6,
        .mirror_mass = 42,
        .input_power = 125,
        .power_recycling_transmission = 0.05,
        .signal_recycling_transmission = 0.2,
        .power_recycling_length = 5.95,
        .signal_recycling_length = 5.95,
        .short_arm = 6,
        .schnupp_asymmetry = 0.23,
        .dark_fringe_offset = 4e-12}},
      {"aligo",
       "Advanced LIGO",
       {.arm_length = 3995,
        .input_transmission = 0.014,
        .end_transmission = 5e-6,
        .round_trip_loss = 75e-6,
        .mirror_mass = 39.6,
        .input_power = 125,
        .power_recycling_transmission = 0.03,
        .signal_recycling_transmission = 0.325,
        .beam_splitter_loss = 0.5e-3,
        .power_recycling_length = 52.6,
        .signal_recycling_length = 51,
        .short_arm = 5,
        .schnupp_asymmetry = 0.08,
        .dark_fringe_offset = 10e-12}},
      {"kagra",
       "KAGRA",
       {.arm_length = 3000,
        .input_transmission = 0.004,
        .end_transmission = 5e-6,
        .round_trip_loss = 100e-6,
        .mirror_mass = 22.8,
        .arm_power = 340e3,
        .power_recycling_transmission = 0.1,
        .signal_recycling_transmission = 0.1536,
        .power_recycling_length = 41.6,
        .signal_recycling_length = 41.6,
        .short_arm = 25,
        .schnupp_asymmetry = 3.33,
        .dark_fringe_offset = 10e-12}},
      {"et-hf",
       "Einstein Telescope, high frequency",
       {.arm_length = 10e3,
        .input_transmission = 0.007,
        .end_transmission = 5e-6,
        .round_trip_loss = 75e-6,
        .mirror_mass = 200,
        .input_power = 500,
        .power_recycling_transmission = 0.045,
        .signal_recycling_transmission = 0.05,
        .beam_splitter_loss = 1e-3,
        .power_recycling_length = 50,
        .signal_recycling_length = 50,
        .short_arm = 50}},
      {"et-lf",
       "Einstein Telescope, low frequency",
       {.wavelength = 1550e-9,
        .arm_length = 10e3,
        .input_transmission = 0.007,
        .end_transmission = 5e-6,
        .round_trip_loss = 40e-6,
        .mirror_mass = 211,
        .input_power = 1.7,
        .power_recycling_transmission = 0.026,
        .signal_recycling_transmission = 0.2,
        .signal_recycling_tuning = -0.3,
        .beam_splitter_loss = 1e-3,
        .power_recycling_length = 150,
        .signal_recycling_length = 150,
        .short_arm = 50}},
      {"ce",
       "Cosmic Explorer 1",
       {.arm_length = 40e3,
        .input_transmission = 0.014,
        .end_transmission = 5e-6,
        .round_trip_loss = 40e-6,
        .mirror_mass = 320,
        .input_power = 165,
        .power_recycling_transmission = 0.03,
        .signal_recycling_transmission = 0.02,
        .beam_splitter_loss = 0.5e-3,
        .power_recycling_length = 50,
        .signal_recycling_length = 15,
        .short_arm = 5}},
  }};
  return presets;
}

}  // namespace straytrace::ifo
