// SPDX-License-Identifier: BSD-3-Clause
// Beams of the interferometer -> lit surfaces, and the ports where light rejoins them.
#include "world/read_beams.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/document.hpp"

namespace straytrace {
namespace {

// A route and its reverse are one coherent pair: C_rev counts on both ends being ports (physics.md eq. 1.5).
void warn_of_closed_ends(Scene const& scene, World const& world) {
  for (Footprint const& f : world.footprints())
    if (f.standing && !f.receives && !world.ports().empty())
      scene.table("ports").warning(
          fmt::format("no port is open at '{}', a mirror of a cavity: light that rejoins there is not counted",
                      world.groups()[world.surfaces()[f.surface.value].group.value]),
          "open a port at each mirror of the cavity");
}

}  // namespace

void read_beams(Scene const& scene, World& world, Registry const& names) {
  Beams beams;
  bool first = true;
  for (auto const& [name, node] : scene.table("beams").items()) {
    double const wavelength = node.number("wavelength", dim::length, 1.064e-6, 1e-7, 1e-4);
    if (!first && wavelength != world.wavelength)
      node.problem("all beams of a scene share one wavelength", "trace other wavelengths in scenes of their own");
    world.wavelength = wavelength;
    first = false;
    Lighting light{name, std::uint32_t(beams.names.size())};
    std::size_t const spots = world.footprints().size();
    world.beam_powers.push_back(0);
    if (node.has("power")) {
      double const power = node.number("power", dim::power, required, 1e-12, 1e9);
      bool const wrong = std::isnan(power);
      if (world.beam_power == 0) world.beam_power = wrong ? 1 : power;
      if (!wrong) light.power = power / world.beam_power;
      world.beam_powers.back() = wrong ? 1 : power;  // then it is not also a missing one
    }
    if (Node const cavity = node["cavity"])
      read_cavity(node, cavity, names, world, light);
    else if (node.has("on"))
      read_spot(node, names, world, light);
    else if (node.has("from"))
      read_free(node, names, world, light);
    else
      node.problem(fmt::format("beam '{}' lights nothing", name),
                   "give 'cavity: [MIRROR, MIRROR]', 'on: SURFACE', or 'from' and 'facing'");
    node.refuse_unknown(fmt::format("beam '{}'", name));
    beams.names.push_back(name);
    bool const unfollowed = node.has("lit") && !node.healthy();
    beams.broken.push_back(world.footprints().size() == spots || unfollowed);
  }
  read_ports(scene, world, names, beams);
  warn_of_closed_ends(scene, world);
  if (scene.root().data()->misspelt) return;  // which may be what is missing
  if (beams.names.empty())
    scene.root().problem("no beam lights the scene", "add 'beams: {arm: {cavity: [ITM, ETM]}}'");
  else if (scene.table("ports").items().empty() && scene.table("receivers").items().empty())
    scene.root().problem("there is no port where light could rejoin, and no receiver",
                         "add 'ports: {ITM: {beam: arm, at: ITM}}', or 'receivers: {PD: {on: SURFACE}}'");
}

}  // namespace straytrace
