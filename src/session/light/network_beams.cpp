// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/network_beams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/input/document.hpp"
#include "ifo/layout/read_network.hpp"
#include "ifo/ports.hpp"
#include "ifo/stray_response.hpp"
#include "session/light/optical_network.hpp"
#include "world/build/network_powers.hpp"

namespace straytrace::session {
namespace {

bool is_of_a_network(Node const& beam) { return beam.kind() == Node::Kind::table && beam.data()->find("network"); }
bool lights_behind_mirrors(Node const& beam) {
  return beam.kind() == Node::Kind::table && beam.data()->find("cavity") && beam.data()->find("lit");
}

void add_spaces(Network const& network, NetworkPowers& powers) {
  for (Network::Space const& s : network.spaces())
    for (auto const& [port, other] : {std::pair{s.from, s.to}, std::pair{s.to, s.from}})
      powers.spaces[network.port_name(port)] = {beam_name(network, NetworkBeam{other, true}), s.length};
}

// Solved from a second reading, whose messages are those of the first.
NetworkPowers powers_of_network(Scene const& scene) {
  auto const beams = scene.table("beams").items();
  if (std::ranges::none_of(
          beams, [](auto const& beam) { return is_of_a_network(beam.second) || lights_behind_mirrors(beam.second); }))
    return {};
  Scene const again = read_scene(scene.main_file(), scene.overrides(), &scene.files());
  Node const table = again.root()["interferometer"];
  if (table.kind() != Node::Kind::table) return {};
  double const wavelength =
      again.table("beams").items().front().second.number("wavelength", dim::length, 1.064e-6, 1e-7, 1e-4);
  std::optional<NetworkModel> const model = read_network_alone(table, wavelength, drawn_optics(scene));
  NetworkPowers powers;
  powers.faulty = !table.healthy();
  if (!model) return powers;
  add_spaces(model->network, powers);
  if (model->preset != "none") powers.behind_input = "ITMx.front";
  SteadyField const field(model->network);
  for (std::uint32_t p = 0; p < model->network.ports(); ++p) {
    powers.watts[beam_name(model->network, NetworkBeam{p, false})] = field.power_in(p);
    powers.watts[beam_name(model->network, NetworkBeam{p, true})] = field.power_out(p);
  }
  for (auto const& [name, node] : beams)
    if (is_of_a_network(node)) powers.stated.insert(powers.named_where_it_leaves(node["network"].text()));
  return powers;
}

// Rows of light between beams bear names of beams of the network, and so do the ports that the program opens.
void refuse_names_of_network(Scene const& scene, Network const& network) {
  std::map<std::string, std::string> light_of_beam;
  auto const refuse = [&](std::string const& name, Node const& node, std::string const& light, char const* what) {
    for (std::uint32_t p = 0; p < network.ports(); ++p) {
      std::string const own[] = {beam_name(network, NetworkBeam{p, false}), beam_name(network, NetworkBeam{p, true})};
      bool const same = name == network.port_name(p) || (name != light && (name == own[0] || name == own[1]));
      if (same)
        return node.problem(fmt::format("{} '{}' has the name of a place of the interferometer", what, name),
                            "choose another name; 'network' says which light a beam is");
    }
  };
  for (auto const& [name, node] : scene.table("beams").items()) {
    if (is_of_a_network(node)) light_of_beam[name] = node["network"].text();
    refuse(name, node, light_of_beam[name], "beam");
  }
  for (auto const& [name, node] : scene.table("ports").items()) {
    Node const beam = node.kind() == Node::Kind::table ? node["beam"] : Node();
    refuse(name, node, light_of_beam[beam.text()], "port");
  }
}

std::optional<std::size_t> find_beam_of_scene(Scene const& scene, std::string const& name) {
  auto const beams = scene.table("beams").items();
  for (std::size_t i = 0; i < beams.size(); ++i)
    if (beams[i].first == name) return i;
  return {};
}

}  // namespace

World build_lit_world(Scene const& scene) { return build_world(scene, powers_of_network(scene)); }

void check_network_beams(Scene const& scene, Interferometer const& detector) {
  NetworkModel const* const model = detector.network();
  if (!model) return;
  refuse_names_of_network(scene, model->network);
  Node const table = scene.table("interferometer");
  for (auto const& [name, port] : scene.table("ports").items()) {
    auto const number = find_beam_of_scene(scene, port["beam"].text());
    if (!number || has_response_files(table, name)) continue;
    auto const [beam, node] = scene.table("beams").items()[*number];
    if (!is_of_a_network(node) || node.has("cavity")) continue;
    std::string const light = node["network"].text();
    auto const source = find_beam(model->network, light);
    if (!source) continue;
    Node const at = table["ports"][name]["at"];
    auto const found = std::ranges::find_if(model->entrances, [&, key = at ? at.text() : ""](NamedWay const& w) {
      return w.name == name || w.name == key;
    });
    std::string const back = beam_name(model->network, reversed(*source));
    if (!at) continue;
    if (found == model->entrances.end() || !same_beam(model->network, found->way.lit.beam, *source))
      place_of_entrance(table, name)
          .problem(fmt::format("beam '{}' is the light '{}', and port '{}' is not relative to it", beam, light, name),
                   fmt::format("write 'ports: {{{}: {{at: {}}}}}' in the interferometer, or another beam 'at' with "
                               "'lit_by: {}'",
                               name, back, light));
  }
}

}  // namespace straytrace::session
