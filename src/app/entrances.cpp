// SPDX-License-Identifier: BSD-3-Clause
#include "app/entrances.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace straytrace {
namespace {

// Footprints of a cavity: its first mirror, then its second.
bool is_second_mirror(World const& world, std::uint32_t footprint) {
  std::vector<Footprint> const& all = world.footprints();
  return std::any_of(all.begin(), all.begin() + footprint,
                     [&](Footprint const& f) { return f.standing && f.beam == all[footprint].beam; });
}

// Whether light that comes back at this footprint joins the arm at its end mirror.
bool is_at_the_end(World const& world, std::uint32_t footprint) {
  bool const standing = world.footprints()[footprint].standing;
  std::uint32_t const mirror = standing ? footprint : world.feeds()[footprint].mirror;
  return mirror != Feed::none && is_second_mirror(world, mirror);
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
  for (std::string const& name : world.ports()) ports.push_back({.name = name, .entrance = Entrance::end_mirror});
  std::vector<bool> lit(ports.size(), false);
  for (std::uint32_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    if (!f.port.valid()) continue;
    TracedPort& port = ports[f.port.value];
    if (!is_at_the_end(world, i)) port.entrance = Entrance::arm;
    if (!lit[f.port.value]) port.power = world.beam_powers[f.beam];
    lit[f.port.value] = true;
  }
  for (auto const& [name, node] : scene.table("ports").items())
    if (std::find(world.ports().begin(), world.ports().end(), name) == world.ports().end())
      ports.push_back({.name = name, .power = power_of_beam(scene, world, node["beam"].text())});
  return ports;
}

void check_entrances(Node const& interferometer, World const& world) {
  Node const ports = interferometer.table("ports");
  if (!ports) return;
  for (std::size_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    if (!f.port.valid() || world.feeds()[i].mirror == Feed::none) continue;
    Node const entry = ports[world.ports()[f.port.value]];
    if (entry.kind() != Node::Kind::table || !entry.has("at")) continue;
    std::string const at = entry.word("at");
    if (at == "end-bench" || at == "short-arm")
      return entry["at"].problem("'lit' has followed this light through the mirror: its transmission would count twice",
                                 "leave 'at' out: couplings of the port are relative to the light in the arm");
  }
}

void warn_of_input_mirrors(Scene const& scene, World const& world) {
  auto const beams = scene.table("beams").items();
  for (std::size_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    if (world.feeds()[i].mirror == Feed::none || !(f.share > 1e-3) || f.beam >= beams.size()) continue;
    return beams[f.beam].second["lit"].warning(
        fmt::format("'{}' is lit through a mirror that passes {:.2g} of the light: the light that comes from the "
                    "splitter interferes there and is not followed",
                    world.groups()[world.surfaces()[f.surface.value].group.value], f.share),
        "behind an input mirror state spots by 'on' and their port by 'at: short-arm'; name end-mirror surfaces by "
        "'only'");
  }
}

}  // namespace straytrace
