// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/layout/operating_point.hpp"

#include <algorithm>
#include <cmath>

#include "ifo/mode_bases.hpp"
#include "ifo/network_ways.hpp"

namespace straytrace::ifo {
namespace {

using Component = Network::Component;

// W that an aperture stops. What it scatters to modes beyond the order is not lost but missing.
double stopped_by(Component const& c, SteadyField const& f) {
  double sum = 0;
  if (!f.bases()) return sum;
  for (std::uint32_t in : {0u, 1u})
    for (std::size_t n = 0; n < f.carriers().size(); ++n) {
      Eigen::VectorXcd entering(Eigen::Index(f.modes()));
      for (std::size_t mode = 0; mode < f.modes(); ++mode)
        entering[Eigen::Index(mode)] = f.in(c.first_port + in, n, mode);
      sum += f.bases()->stopped(c, in, entering);
    }
  return sum;
}

// W lost in a component by its stated losses; of a modulator: in bands beyond its order; of an aperture: what it stops.
double lost_in(Component const& c, SteadyField const& f) {
  auto const entering = [&](std::uint32_t p) { return f.power_in(c.first_port + p); };
  if (auto const* p = std::get_if<MirrorParameters>(&c.stated)) {
    double sum = 0;
    for (std::uint32_t i = 0; i < c.ports; ++i) sum += entering(i);
    return p->loss * sum;
  }
  if (auto const* p = std::get_if<IsolatorParameters>(&c.stated))
    return (1 - p->transmission) * entering(0) + (1 - p->isolation) * entering(1);
  if (c.kind == Component::Kind::aperture) return stopped_by(c, f);
  if (c.kind != Component::Kind::modulator) return 0;
  return entering(0) + entering(1) - f.power_out(c.first_port) - f.power_out(c.first_port + 1);
}

void add_energy(Network const& n, SteadyField const& f, OperatingPoint& into) {
  using Kind = EnergyRow::Kind;
  auto const other = neighbours(n);
  for (Component const& c : n.components())
    if (c.emits != 0.0) into.energy.push_back({Kind::emitted, c.name, std::norm(c.emits)});
  for (std::uint32_t p = 0; p < n.ports(); ++p)
    if (Component const& c = n.at(n.owner_of(p)); other[p].first == n.ports() && (c.ports > 1 || c.emits != 0.0))
      into.energy.push_back({Kind::leaving, n.port_name(p), f.power_out(p)});
  for (Component const& c : n.components())
    if (c.ports == 1) into.energy.push_back({Kind::absorbed, c.name, f.power_in(c.first_port)});
  for (Component const& c : n.components())
    if (double const w = lost_in(c, f); w != 0) into.energy.push_back({Kind::lost, c.name, w});
  for (EnergyRow const& row : into.energy) {
    if (row.kind == Kind::emitted) into.emitted += row.power;
    into.missing += row.kind == Kind::emitted ? row.power : -row.power;
  }
}

void use_modes(Network const& n, ModeBases const& bases, NetworkCavity& cavity) {
  Phasor const trip = round_trip_in_modes(n, bases, cavity);
  double const phase = std::arg(trip);
  cavity.round_trip = std::abs(trip);
  cavity.phase = std::fabs(phase) > 1e-12 ? phase : 0;
}

}  // namespace

OperatingPoint operating_point(NetworkModel const& model) {
  Network const& n = model.network;
  SteadyField const f(n);
  OperatingPoint point{.carriers = f.carriers(), .modes = f.bases() != nullptr};
  auto const other = neighbours(n);
  for (std::uint32_t p = 0; p < n.ports(); ++p) {
    point.ports.push_back({n.port_name(p), f.power_in(p), f.power_out(p), other[p].first == n.ports()});
    for (std::size_t c = 0; c < f.carriers().size(); ++c) point.ports.back().fundamental += std::norm(f.out(p, c));
  }
  add_energy(n, f, point);
  for (NetworkCavity& c : cavities_of(n)) {
    if (f.bases()) use_modes(n, *f.bases(), c);
    double const power = f.power_out(c.beams.front());
    point.cavities.push_back({std::move(c), power, power / point.emitted});
  }
  for (NamedReadout const& r : model.readouts)
    point.readouts.push_back({r.name, beam_name(n, r.readout), resolved_value(r.readout, f)});
  return point;
}

}  // namespace straytrace::ifo
