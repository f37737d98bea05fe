// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/optical_network.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <type_traits>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "ifo/layout/read_network.hpp"
#include "ifo/network_interferometer.hpp"
#include "ifo/ports.hpp"
#include "scene/scene_document.hpp"
#include "session/light/ghost_search.hpp"
#include "session/model.hpp"
#include "session/open_run.hpp"
#include "world/build/read_parts.hpp"
#include "world/ghosts/beam_tree.hpp"

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
    auto const found = std::ranges::find_if(
        model->entrances,
        [&, name = name, key = at ? at.text() : ""](NamedWay const& w) { return w.name == name || w.name == key; });
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

namespace {

// Footprints of a cavity: its first mirror, then its second.
bool is_second_mirror(World const& world, std::uint32_t footprint) {
  std::vector<Footprint> const& all = world.footprints();
  return std::any_of(all.begin(), all.begin() + footprint,
                     [&](Footprint const& f) { return f.standing && f.beam == all[footprint].beam; });
}

// Where light returning at this footprint joins an arm.
InjectionPoint injection_point_of(World const& world, std::uint32_t footprint) {
  bool const standing = world.footprints()[footprint].standing;
  std::uint32_t const mirror = standing ? footprint : world.feeds()[footprint].mirror;
  if (mirror == Feed::none || !is_second_mirror(world, mirror)) return InjectionPoint::arm;
  return standing ? InjectionPoint::end_mirror : InjectionPoint::through_end;
}

// Between the mirrors of a cavity, m; 0: the beam is not a cavity.
double cavity_length(World const& world, std::uint32_t beam) {
  std::vector<Vec3> mirrors;
  for (Footprint const& f : world.footprints())
    if (f.standing && f.beam == beam) mirrors.push_back(f.centre);
  return mirrors.size() == 2 ? length(mirrors[1] - mirrors[0]) : 0;
}

// Ports of beams of the network, and those of light between them.
void add_network_lights(World const& world, std::vector<TracedPort>& ports) {
  for (Footprint const& f : world.footprints()) {
    if (!f.port.valid() || world.beams[f.beam].network.empty()) continue;
    ports[f.port.value].light = world.beams[f.beam].network;
    ports[f.port.value].reference = world.beams[f.beam].share;
  }
  for (World::PortPair const& pair : world.port_pairs()) {
    TracedPort& port = ports[pair.port.value];
    port.lit_by = pair.lit;
    port.light = pair.light;
    port.along = pair.light == pair.lit;
    port.reference = pair.reference;
    port.power = world.beam_powers[pair.beam];
  }
  for (World::FacePort const& face : world.face_ports()) {
    TracedPort const& first = ports[face.first.value];
    TracedPort& port = ports[face.port.value];
    port.light = first.light;
    port.reference = first.reference;
    port.power = first.power;
    port.both_sides = true;
  }
}

double power_of_beam(Scene const& scene, World const& world, std::string const& name) {
  auto const beams = scene.table("beams").items();
  for (std::size_t i = 0; i < beams.size(); ++i)
    if (beams[i].first == name) return world.beam_powers[i];
  return 0;
}

}  // namespace

std::vector<TracedPort> traced_ports(Scene const& scene, World const& world) {
  std::vector<TracedPort> ports;
  for (std::string const& name : world.ports())
    ports.push_back({.name = name, .injection_point = InjectionPoint::through_end});
  std::vector<bool> lit(ports.size(), false);
  for (std::uint32_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    if (!f.port.valid()) continue;
    TracedPort& port = ports[f.port.value];
    port.injection_point = std::min(port.injection_point, injection_point_of(world, i));
    port.through_mirror = port.through_mirror || world.feeds()[i].mirror != Feed::none;
    if (lit[f.port.value]) continue;
    port.power = world.beam_powers[f.beam];
    port.cavity_length = cavity_length(world, f.beam);
    lit[f.port.value] = true;
  }
  add_network_lights(world, ports);
  for (auto const& [name, node] : scene.table("ports").items())
    if (std::find(world.ports().begin(), world.ports().end(), name) == world.ports().end())
      ports.push_back({.name = name, .power = power_of_beam(scene, world, node["beam"].text())});
  return ports;
}

void check_entrances(Node const& interferometer, std::vector<TracedPort> const& traced) {
  Node const ports = interferometer.table("ports");
  if (!ports) return;
  for (TracedPort const& port : traced) {
    if (!port.through_mirror) continue;
    Node const entry = ports[port.name];
    if (entry.kind() != Node::Kind::table || !entry.has("at")) continue;
    std::string const at = entry.word("at");
    if (at == "end-bench" || at == "short-arm" || at == "short-arm-to-splitter" || at.find('.') != at.npos)
      return entry["at"].problem("'lit' already includes the transmission of the mirror: it would count twice",
                                 "remove 'at': couplings of the port are relative to the light in the arm");
  }
}

// Behind the input mirror the light of the arm interferes with the light that the splitter sends, which `lit` does not
// follow: on resonance the field behind it carries a quarter of the power that the mirror transmits
// (docs/theory/interferometer.md, eq. 9.5).
void refuse_input_mirrors(Scene const& scene, World const& world) {
  auto const beams = scene.table("beams").items();
  auto const name = [&](Footprint const& f) { return world.name_of(f.surface); };
  for (BeamLaunch const& launch : launches(world)) {
    if (!launch.through_input_mirror() || launch.beam >= beams.size()) continue;
    std::set<std::string> lit;
    for (std::size_t i = 0; i < world.footprints().size(); ++i)
      if (world.feeds()[i].mirror == launch.footprint) lit.insert('"' + name(world.footprints()[i]) + '"');
    if (lit.empty()) continue;
    beams[launch.beam].second["lit"].problem(
        fmt::format("{} lit through '{}', which passes {:.2g} of the light: the light that the splitter sends "
                    "interferes there and is not followed",
                    lit.size() == 1 ? *lit.begin() + " is" : fmt::format("{} surfaces are", lit.size()), launch.name,
                    launch.passes),
        fmt::format("name the port of the network behind it, 'lit: {{behind: ITM.front}}', in an interferometer whose "
                    "network is "
                    "solved ('preset: dual-recycled', 'none'), or write 'lit: {{except: [{}]}}'",
                    fmt::join(lit, ", ")));
  }
}

void warn_of_ghosts_left_out(Scene const& scene, World const& world) {
  auto const of_network = [](LightBeam const& b) { return !b.network.empty(); };
  if (!read_ghosts(scene) || std::ranges::any_of(world.beams, of_network)) return;
  BeamSink nobody;
  for (BeamLaunch const& launch : launches(world)) {
    if (!launch.through_input_mirror() || grow_tree(world, launch, {0, 0, 1}, nobody).spots < 2) continue;
    scene.root()["ghosts"].warning(
        fmt::format("ghosts behind '{}' are not counted: light from the splitter interferes there", launch.name),
        "write 'lit' for its beam, in an interferometer whose network is solved: the light there then is that of the "
        "network");
  }
}

}  // namespace straytrace::session
