// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/network_model.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace straytrace::ifo {
namespace {

template <class Named>
Named const* found(std::vector<Named> const& all, std::string const& name) {
  auto const hit = std::ranges::find(all, name, &Named::name);
  return hit == all.end() ? nullptr : &*hit;
}

NetworkPort port_of(Network const& n, std::string const& name) {
  auto const port = find_port(n, name);
  if (!port) throw std::out_of_range("there is no port '" + name + "'");
  ComponentId const id = n.owner_of(*port);
  return {id, *port - n.at(id).first_port};
}

}  // namespace

NamedReadout const* NetworkModel::readout(std::string const& name) const { return found(readouts, name); }
NamedFreedom const* NetworkModel::freedom(std::string const& name) const { return found(freedoms, name); }

double NamedNoise::asd(double hz) const {
  return curve.hz.empty() ? level * std::pow(hz / at, exponent) : curve.at(hz);
}

std::vector<std::string> port_names(Network const& n) {
  std::vector<std::string> names;
  for (std::uint32_t p = 0; p < n.ports(); ++p) names.push_back(n.port_name(p));
  return names;
}

std::optional<std::uint32_t> find_port(Network const& n, std::string const& name) {
  auto const id = n.search(name.substr(0, name.find('.')));
  if (!id) return {};
  Network::Component const& c = n.at(*id);
  for (std::uint32_t p = 0; p < c.ports; ++p)
    if (c.port_name(p) == name) return c.first_port + p;
  return {};
}

std::optional<NetworkBeam> find_beam(Network const& n, std::string const& name) {
  std::size_t const dot = name.rfind('.');
  if (dot == name.npos) return {};
  std::string const way = name.substr(dot + 1);
  auto const port = find_port(n, name.substr(0, dot));
  if (!port || (way != "in" && way != "out")) return {};
  return NetworkBeam{*port, way == "out"};
}

std::string beam_name(Network const& n, Readout const& r) { return n.port_name(r.port) + (r.leaving ? ".out" : ".in"); }

double power_of_beam(Readout const& r, SteadyField const& f) {
  return r.leaving ? f.power_out(r.port) : f.power_in(r.port);
}

double resolved_value(Readout const& r, SteadyField const& f) {
  double const value = value_of(r, f), power = power_of_beam(r, f),
               scale = r.kind == Readout::Kind::homodyne ? std::sqrt(power) : power;
  return std::fabs(value) > 1e-12 * scale ? value : not_a_number;
}

void apply(NetworkChanges const& changes, Network& network) {
  for (Network::Component const& c : changes.components) {
    if (auto const id = network.search(c.name))
      network.replace(*id, c);
    else
      network.add(c);
  }
  for (NetworkChanges::Shape const& s : changes.shapes)
    network.shape(network.find(s.component), s.curvature, s.tilt, s.curvature_across, s.origin);
  for (NetworkChanges::Space const& s : changes.spaces) {
    NetworkPort const from = port_of(network, s.from), to = port_of(network, s.to);
    for (NetworkPort const p : {from, to}) network.unlink(network.number_of(p));
    network.link(from, to, s.length, s.phase, s.origin);
  }
  if (changes.modes) network.use_modes(changes.modes);
}

}  // namespace straytrace::ifo
