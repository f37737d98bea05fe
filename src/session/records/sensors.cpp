// SPDX-License-Identifier: BSD-3-Clause
#include "session/records/sensors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "beams/aperture.hpp"

namespace straytrace::session {
namespace {

constexpr double least_share = 1e-3;  // of the main light on the sensor

// Position of the name that a key gives.
std::optional<std::uint32_t> place_of(Node const& sensor, char const* key, std::vector<std::string> const& names) {
  std::string const name = sensor.word(key);
  if (name.empty()) return {};
  auto const at = std::ranges::find(names, name);
  if (at != names.end()) return std::uint32_t(at - names.begin());
  sensor[key].problem(fmt::format("there is no {} '{}'", key, name),
                      names.empty()
                          ? fmt::format("the scene has no {}s", key)
                          : did_you_mean(name, names, fmt::format("it is one of: {}", fmt::join(names, ", "))));
  return {};
}

// eta of eq. N.22 for a round sensor: 1 - exp(-2 a^2/w^2) at the middle of the beam.
double read_caught(Node const& sensor) {
  if (!sensor.has("radius") && !sensor.has("spot") && !sensor.has("offset")) return 1;
  double const radius = sensor.number("radius", dim::length, required, 1e-6, 1e3),
               spot = sensor.number("spot", dim::length, required, 1e-7, 1e3),
               offset = sensor.number("offset", dim::length, 0, 0, 1e3);
  if (!std::isfinite(radius + spot + offset)) return 1;
  double const caught = 1 - clipped_share(radius, spot, offset);
  if (!(caught >= least_share)) {
    sensor.problem(fmt::format("{:.2g} of the main light falls on this sensor", caught),
                   "move it into the beam, or make it larger");
    return 1;
  }
  return caught;
}

}  // namespace

std::vector<Sensor> read_sensors(Scene const& scene, std::vector<std::string> const& ports,
                                 std::vector<std::string> const& receivers) {
  std::vector<Sensor> all;
  for (auto const& [name, node] : scene.table("sensors").items()) {
    if (!node) continue;  // reported
    if (name.empty()) {
      node.problem("a sensor has no name", "write a name before its table");
      continue;
    }
    if (node.kind() != Node::Kind::table) {
      node.problem(fmt::format("sensor '{}' is a table", name), "write {port: PORT, radius: 5 mm, spot: 1 mm}");
      continue;
    }
    std::optional<std::uint32_t> const port = place_of(node, "port", ports);
    Sensor sensor{name, PortId{port.value_or(0)}, read_caught(node), {}};
    if (node.has("receiver")) sensor.receiver = place_of(node, "receiver", receivers);
    node.refuse_unknown(fmt::format("sensor '{}'", name));
    if (bool const other = port && ports[*port] != name; other && std::ranges::find(ports, name) != ports.end())
      node.problem(fmt::format("'{}' is the sensor of the port of this name", name), "choose another name");
    auto const taken = std::ranges::find_if(all, [&](Sensor const& s) { return port && s.port.value == *port; });
    if (taken != all.end())
      node["port"].problem(fmt::format("'{}' is already the sensor of port '{}'", taken->name, ports[*port]),
                           "give each sensor a port of its own");
    else if (port)
      all.push_back(std::move(sensor));
  }
  return all;
}

std::vector<Sensor> sensors_of_ports(Scene const& scene, CouplingTable const& table, std::vector<double> const& power,
                                     double main_power) {
  std::vector<Sensor> const stated = read_sensors(scene, table.ports, table.receivers);
  scene.throw_if_problems();
  std::vector<Sensor> all;
  for (std::uint32_t p = 0; p < table.ports.size(); ++p) {
    auto const own = std::ranges::find_if(stated, [&](Sensor const& s) { return s.port.value == p; });
    all.push_back(own != stated.end() ? *own : Sensor{table.ports[p], PortId{p}});
    if (power.at(p) > 0 && main_power > 0) all.back().share = power[p] / main_power;
  }
  return all;
}

}  // namespace straytrace::session
