// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/optical_network.hpp"

#include <optional>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "ifo/layout/read_network.hpp"
#include "ifo/ports.hpp"
#include "scene/diagnostics.hpp"
#include "session/diagnostics.hpp"
#include "session/light/drawn_optics.hpp"
#include "session/model.hpp"

namespace straytrace::session {
namespace {

// Nothing with a problem in the scene.
std::optional<NetworkModel> network_of(Node const& table, double wavelength, Interferometer const* detector,
                                       std::vector<DrawnOptic> const& optics,
                                       std::vector<TracedPort> const& entrances = {}) {
  if (detector && detector->network()) return *detector->network();
  if (detector) {
    table["preset"].problem("closed forms have no network of components",
                            "write 'preset: dual-recycled' with numbers of your own, or 'preset: none'");
    return {};
  }
  std::optional<NetworkModel> model = read_bare_network(table, wavelength, optics);
  if (model && !entrances.empty()) read_entrances(table, entrances, *model);
  table.refuse_unknown("interferometer 'none'");
  return model;
}

// Without a scene, ports are entrances that the table names.
std::vector<TracedPort> stated_ports(Node const& table) {
  std::vector<TracedPort> ports;
  Node const stated = table["ports"];
  if (stated.kind() == Node::Kind::table)
    for (auto const& [name, node] : stated.items()) ports.push_back({.name = name});
  return ports;
}

}  // namespace

bool only_network(Scene const& scene) {
  Node const root = scene.root(), table = root["interferometer"];
  bool const network = table.kind() == Node::Kind::table && table.data()->find("network") != nullptr;
  return network && !root.has("scene") && !root.has("beams") && !root.has("bodies");
}

namespace {

OpticalNetwork read_lone(Scene const& scene) {
  Node const table = scene.table("interferometer");
  std::vector<DrawnOptic> const optics = table ? drawn_optics(scene) : std::vector<DrawnOptic>{};
  std::optional<NetworkModel> model;
  if (!table) {
    scene.root().lack("interferometer", "the scene has no 'interferometer'",
                      "add 'interferometer: {preset: adv}', or 'preset: none' with a 'network'");
    scene.root().refuse_misspelt("a model");
  } else if (table["preset"].text() == "none" && !table.has("strain")) {
    table.has("preset");
    model = network_of(table, not_a_number, nullptr, optics, stated_ports(table));
  } else if (auto const detector = make_interferometer(table, stated_ports(table), not_a_number, {}, optics)) {
    model = network_of(table, not_a_number, detector.get(), optics);
  }
  scene.throw_if_problems();
  return {scene.title(), *std::move(model), warnings_as_json(scene)};
}

}  // namespace

NetworkModel read_lone_network(Scene const& scene) { return read_lone(scene).model; }

OpticalNetwork read_optical_network(SceneOptions const& options) {
  Scene const scene = read_scene(options.input, options.overrides);
  if (!scene.root().has("beams")) {
    OpticalNetwork network = read_lone(scene);
    print_warnings(scene, options);
    return network;
  }
  Model const whole = read_model(options.input, options.overrides);
  Node const table = whole.scene.table("interferometer");
  std::optional<NetworkModel> model;
  if (table)
    model = network_of(table, whole.world.wavelength, whole.detector.get(), whole.traced.optics);
  else
    whole.scene.root().problem("the scene has no 'interferometer'", "add 'interferometer: {preset: adv}'");
  whole.scene.throw_if_problems();
  print_warnings(whole.scene, options);
  return {whole.scene.title(), *std::move(model), warnings_as_json(whole.scene)};
}

}  // namespace straytrace::session
