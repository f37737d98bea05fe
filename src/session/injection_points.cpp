// SPDX-License-Identifier: BSD-3-Clause
#include "session/injection_points.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "session/light/ghost_noise.hpp"
#include "world/ghosts/beam_tree.hpp"

namespace straytrace::session {
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
