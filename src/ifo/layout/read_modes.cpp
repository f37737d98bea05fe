// SPDX-License-Identifier: BSD-3-Clause
// The table `modes` of a network.
#include <fmt/format.h>

#include <array>
#include <string_view>

#include "ifo/layout/read_network.hpp"
#include "ifo/mode_bases.hpp"

namespace straytrace::ifo {
namespace {

using Component = Network::Component;

constexpr std::size_t most_modes = 2000;  // of all carriers
constexpr int most_order = 16;

std::vector<std::vector<std::string>> read_cavities(Node const& modes, Network const& network) {
  std::vector<std::vector<std::string>> cavities;
  std::vector<std::string> known;
  for (Component const& c : network.components()) known.push_back(c.name);
  for (Node const& cavity : modes.has("cavities") ? modes.list("cavities") : std::vector<Node>{}) {
    std::vector<std::string>& names = cavities.emplace_back();
    for (Node const& name : cavity.as_list()) {
      names.push_back(name.as_word());
      if (!network.search(names.back()))
        name.problem(fmt::format("the network has no component '{}'", names.back()),
                     did_you_mean(names.back(), known, "name mirrors of the cavity: [PRM, ITM]"));
    }
  }
  return cavities;
}

// Tilts and offsets put light into odd modes, which `parity: even` leaves out.
void refuse_odd_light(Node const& parity, Network const& network) {
  auto const any = [](std::array<double, 2> const& of) { return of[0] != 0 || of[1] != 0; };
  for (Component const& c : network.components()) {
    auto const* mirror = std::get_if<MirrorParameters>(&c.stated);
    auto const* stop = std::get_if<ApertureParameters>(&c.stated);
    if ((mirror && any(mirror->tilt)) || (stop && any(stop->offset)))
      parity.problem(fmt::format("'even' leaves out the odd modes, which the {} of '{}' makes",
                                 mirror ? "tilt" : "offset", c.name),
                     fmt::format("write 'parity: all', or remove the {}", mirror ? "tilt" : "offset"));
  }
}

}  // namespace

std::optional<ModeSettings> read_modes(Node const& table, Network network) {
  Node const modes = table.table("modes");
  if (!modes) return {};
  constexpr std::array<std::string_view, 2> parities = {"all", "even"};
  if (!modes.has("order"))
    modes.lack("order", "'modes' has no 'order'", "add 'order: 2', the largest n + m; 'order: 0' is plane waves");
  ModeSettings settings{int(modes.whole("order", 0, 0, most_order)),
                        modes.choice("parity", parities, parities[0]) == "even", read_cavities(modes, network)};
  modes.refuse_unknown("the modes of a network");
  if (settings.even) refuse_odd_light(modes["parity"], network);
  if (settings.order == 0 || !table.healthy()) return {};
  network.use_modes(settings);
  try {
    std::size_t const count = ModeBases(network).count() * network.carriers().size();
    if (count > most_modes)
      modes.problem(fmt::format("the carriers have {} modes together", count),
                    "reduce 'order', or the carriers of the modulators");
  } catch (ModeError const& e) {
    modes.problem(e.reason, e.remedy);
  }
  return settings;
}

}  // namespace straytrace::ifo
