// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/optical_network.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <type_traits>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "ifo/layout/read_network.hpp"
#include "ifo/ports.hpp"
#include "scene/diagnostics.hpp"
#include "session/diagnostics.hpp"
#include "session/model.hpp"
#include "world/build/network_powers.hpp"

namespace straytrace::session {
namespace {

NodeData const* entry(NodeData const* table, std::string_view key) {
  NodeData::Entry const* const found = table ? table->find(key) : nullptr;
  return found ? found->value.get() : nullptr;
}

// The values of `optic` in the components of an interferometer. No key counts as read by this.
std::set<std::string> names_of_optics(Node const& interferometer) {
  std::set<std::string> names;
  NodeData const* const components = entry(entry(interferometer.data().get(), "network"), "components");
  if (!components) return names;
  for (NodeData::Entry const& component : components->entries)
    for (NodeData::Entry const& kind : component.value->entries)
      if (NodeData const* const optic = entry(kind.value.get(), "optic")) names.insert(optic->text);
  return names;
}

}  // namespace

std::vector<DrawnOptic> drawn_optics(Node const& interferometer, World const& world) {
  if (names_of_optics(interferometer).empty()) return {};
  std::map<std::string, int> count;
  std::vector<DrawnOptic> all;
  std::vector<std::string> const bodies = world.body_names();
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    Surface const& surface = world.surfaces()[id];
    ++count[world.name_of({id})];
    world.view().shapes.visit(surface.shape, [&](auto const& s) {
      using Shape = std::decay_t<decltype(s)>;
      if constexpr (std::is_same_v<Shape, Cap> || std::is_same_v<Shape, Disk>) {
        DrawnOptic optic{world.name_of({id}), surface.body.valid() ? bodies.at(surface.body.value) : "", s.reference(),
                         s.axis};
        if constexpr (std::is_same_v<Shape, Cap>) optic.curvature = s.curvature;
        all.push_back(std::move(optic));
      }
    });
  }
  std::erase_if(all, [&](DrawnOptic const& o) { return count[o.name] > 1; });
  return all;
}

// Powers of beams are not needed for surfaces: `faulty` asks for none.
std::vector<DrawnOptic> drawn_optics(Scene const& scene) {
  if (names_of_optics(scene.root()["interferometer"]).empty()) return {};
  Scene const again = read_scene(scene.main_file(), scene.overrides(), &scene.files());
  NetworkPowers powers;
  powers.faulty = true;
  return drawn_optics(again.root()["interferometer"], build_world(again, powers));
}

std::vector<DrawnOptic> named_optics(Node const& interferometer, std::vector<DrawnOptic> const& all) {
  std::set<std::string> const names = names_of_optics(interferometer);
  std::vector<DrawnOptic> used;
  for (DrawnOptic const& o : all)
    if (names.contains(o.name)) used.push_back(o);
  return used;
}

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
