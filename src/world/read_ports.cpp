// SPDX-License-Identifier: BSD-3-Clause
// Where light rejoins the beams: at the surfaces named, or at all that a beam lights.
#include <fmt/format.h>

#include <algorithm>

#include "world/file_parts.hpp"
#include "world/read_beams.hpp"

namespace straytrace {
namespace {

struct Port {
  std::string name;
  Node node;
  std::uint32_t beam = 0;
  enum class At : std::uint8_t { surface, pattern, everywhere } at = At::everywhere;
  std::vector<SurfaceId> surfaces;  // unless everywhere
};

bool is_pattern(std::string const& name) { return name.find('*') != std::string::npos; }

// The key `at`; false: a problem was recorded.
bool read_place(Port& port, Registry const& names) {
  if (!port.node.has("at")) return true;
  std::string const at = port.node.word("at");
  if (!is_pattern(at)) {
    port.at = Port::At::surface;
    port.surfaces = {find_surface(port.node["at"], names)};
    return port.surfaces.front().valid();
  }
  port.at = Port::At::pattern;
  for (auto const& [name, id] : names.surfaces)
    if (matches(at, name)) port.surfaces.push_back(id);
  return true;
}

// Footprints that the port stands for. Surfaces that scatter nothing count only where they are named themselves.
std::vector<std::uint32_t> footprints_of(Port const& port, World const& world) {
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    bool const idle = !f.emits && world.feeds()[i].propagated;
    if (f.beam != port.beam || f.free || (idle && port.at != Port::At::surface)) continue;
    if (port.at == Port::At::everywhere ||
        std::find(port.surfaces.begin(), port.surfaces.end(), f.surface) != port.surfaces.end())
      all.push_back(i);
  }
  return all;
}

void open(Port const& port, World& world, Beams const& beams) {
  std::vector<std::uint32_t> footprints = footprints_of(port, world);
  bool const lit = !footprints.empty();
  std::string taken;
  std::erase_if(footprints, [&](std::uint32_t i) {
    PortId const other = world.footprints()[i].port;
    if (other.valid()) taken = world.ports()[other.value];
    return other.valid();
  });
  if (!footprints.empty()) return world.open_port(port.name, footprints);
  if (beams.broken[port.beam]) return;
  std::string const& beam = beams.names[port.beam];
  Node const place = port.at == Port::At::everywhere ? port.node["beam"] : port.node["at"];
  if (lit)
    place.problem(fmt::format("the port '{}' is open there already", taken), "a spot of a beam belongs to one port");
  else if (port.at == Port::At::everywhere)
    place.problem(fmt::format("beam '{}' lights no surface that scatters", beam), "nothing can rejoin it");
  else
    place.problem(fmt::format("beam '{}' does not light '{}'", beam, port.node.word("at")),
                  "ports lie where their beam meets a surface");
}

}  // namespace

void read_ports(Scene const& scene, World& world, Registry const& names, Beams const& beams) {
  std::vector<Port> ports;
  for (auto const& [name, node] : scene.table("ports").items()) {
    std::string const beam = node.word("beam");
    auto const number = std::size_t(std::find(beams.names.begin(), beams.names.end(), beam) - beams.names.begin());
    bool const known = number < beams.names.size();
    if (!known && !beams.names.empty() && node.has("beam")) {
      std::string const near = nearest_word(beam, beams.names);
      node["beam"].problem(fmt::format("beam '{}' is not defined", beam),
                           near.empty() ? "name one of 'beams'" : fmt::format("did you mean '{}'?", near));
    }
    Port port;
    port.name = name;
    port.node = node;
    port.beam = std::uint32_t(number);
    bool const placed = read_place(port, names);
    node.refuse_unknown(fmt::format("port '{}'", name));
    if (known && placed) ports.push_back(port);
  }
  // The more is said about a port, the sooner it takes its spots; otherwise in the order of the scene.
  for (Port::At const at : {Port::At::surface, Port::At::pattern, Port::At::everywhere})
    for (Port const& port : ports)
      if (port.at == at) open(port, world, beams);
}

}  // namespace straytrace
