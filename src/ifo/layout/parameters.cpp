// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/layout/parameters.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "base/errors.hpp"
#include "ifo/mode_bases.hpp"

namespace straytrace::ifo {
namespace {

using Component = Network::Component;

// A number of a component: where it is stated, and how the component is made again.
struct Member {
  std::string_view name;
  Dimension dimension;
  double low, high;
  double (*get)(Component const&, double wavelength);
  void (*set)(Component&, double, double wavelength);
};

// A number that is stated as a member of `Parameters`.
template <class Parameters, double Parameters::*member>
constexpr Member stated(std::string_view name, Dimension dimension, double low, double high) {
  return {name,
          dimension,
          low,
          high,
          [](Component const& c, double) { return std::get<Parameters>(c.stated).*member; },
          [](Component& c, double to, double) { std::get<Parameters>(c.stated).*member = to; }};
}

template <std::size_t axis>
Member tilt_about(std::string_view name) {
  return {name,
          dim::angle,
          -0.1,
          0.1,
          [](Component const& c, double) { return std::get<MirrorParameters>(c.stated).tilt[axis]; },
          [](Component& c, double to, double) { std::get<MirrorParameters>(c.stated).tilt[axis] = to; }};
}

std::vector<Member> members_of(Component const& c) {
  if (c.interface())
    return {stated<MirrorParameters, &MirrorParameters::transmission>("transmission", dim::plain, 0, 1),
            stated<MirrorParameters, &MirrorParameters::loss>("loss", dim::plain, 0, 1),
            stated<MirrorParameters, &MirrorParameters::displacement>("displacement", dim::length, -1e-3, 1e-3),
            stated<MirrorParameters, &MirrorParameters::curvature>("curvature", dim::per_metre, -1e3, 1e3),
            {"curvature_y", dim::per_metre, -1e3, 1e3,
             [](Component const& m, double) {
               auto const& p = std::get<MirrorParameters>(m.stated);
               return p.curvature_across.value_or(p.curvature);
             },
             [](Component& m, double to, double) { std::get<MirrorParameters>(m.stated).curvature_across = to; }},
            tilt_about<0>("tilt_x"),
            tilt_about<1>("tilt_y"),
            {"tuning", dim::angle, -1e6, 1e6,
             [](Component const& m, double wavelength) {
               return std::get<MirrorParameters>(m.stated).displacement * 2 * pi / wavelength;
             },
             [](Component& m, double to, double wavelength) {
               std::get<MirrorParameters>(m.stated).displacement = to * wavelength / (2 * pi);
             }}};
  if (c.kind == Component::Kind::modulator)
    return {stated<ModulatorParameters, &ModulatorParameters::index>("index", dim::plain, -10, 10),
            stated<ModulatorParameters, &ModulatorParameters::hz>("frequency", dim::frequency, 1, 1e12)};
  if (c.kind == Component::Kind::laser)
    return {stated<LaserParameters, &LaserParameters::power>("power", dim::power, 0, 1e30)};
  return {};
}

Component made_again(Component const& c) {
  using Kind = Component::Kind;
  if (c.kind == Kind::mirror) return Network::mirror(c.name, std::get<MirrorParameters>(c.stated));
  if (c.kind == Kind::splitter) return Network::splitter(c.name, std::get<MirrorParameters>(c.stated));
  if (c.kind == Kind::modulator) return Network::modulator(c.name, std::get<ModulatorParameters>(c.stated));
  return Network::laser(c.name, std::get<LaserParameters>(c.stated));
}

NetworkParameter of_component(Network const& n, ComponentId id, Member const& m) {
  Component const& c = n.at(id);
  double high = m.high;
  if (c.interface() && (m.name == "transmission" || m.name == "loss")) {
    auto const& p = std::get<MirrorParameters>(c.stated);
    high = 1 - (m.name == "loss" ? p.transmission : p.loss);
  }
  double const before = c.modulation;
  return {fmt::format("{}.{}", c.name, m.name),
          m.dimension,
          m.get(c, n.wavelength()),
          m.low,
          high,
          [id, m, before](NetworkModel& model, double to) {
            Component changed = model.network.at(id);
            m.set(changed, to, model.network.wavelength());
            model.network.replace(id, made_again(changed));
            if (m.name != "frequency") return;
            for (NamedReadout& r : model.readouts)  // demodulated at the frequency of the modulator
              if (r.is_demodulated() && std::fabs(r.readout.hz - before) < 1e-3) r.readout.hz = to;
          }};
}

std::optional<NetworkParameter> of_space(Network const& n, std::string const& name) {
  for (std::size_t i = 0; i < n.spaces().size(); ++i)
    for (std::uint32_t const port : {n.spaces()[i].from, n.spaces()[i].to})
      for (bool const length : {true, false}) {
        if (n.port_name(port) + (length ? ".length" : ".phase") != name) continue;
        Network::Space const s = n.spaces()[i];
        return NetworkParameter{name,
                                length ? dim::length : dim::angle,
                                length ? s.length : s.phase,
                                length ? 0.0 : -1e6,
                                length ? 1e12 : 1e6,
                                [i, length](NetworkModel& m, double to) {
                                  Network::Space const old = m.network.spaces()[i];
                                  m.network.change(i, length ? to : old.length, length ? old.phase : to);
                                }};
      }
  return {};
}

}  // namespace

std::vector<std::string> parameter_names(NetworkModel const& model) {
  Network const& n = model.network;
  std::vector<std::string> names;
  for (Component const& c : n.components())
    for (Member const& m : members_of(c)) names.push_back(fmt::format("{}.{}", c.name, m.name));
  for (Network::Space const& s : n.spaces())
    for (std::uint32_t const port : {s.from, s.to})
      for (char const* what : {".length", ".phase"}) names.push_back(n.port_name(port) + what);
  for (NamedFreedom const& f : model.freedoms) names.push_back(f.name);
  return names;
}

std::optional<NetworkParameter> find_parameter(NetworkModel const& model, std::string const& name) {
  Network const& n = model.network;
  if (NamedFreedom const* f = model.freedom(name)) {
    std::vector<double> rest;
    for (auto const& [id, factor] : f->moves) rest.push_back(n.at(id).displacement);
    return NetworkParameter{name, dim::length, 0, -1e-3, 1e-3, [moves = f->moves, rest](NetworkModel& m, double to) {
                              for (std::size_t i = 0; i < moves.size(); ++i)
                                m.network.move(moves[i].first, rest[i] + moves[i].second * to);
                            }};
  }
  std::size_t const dot = name.rfind('.');
  if (dot == name.npos) return {};
  if (auto const id = n.search(name.substr(0, dot)))
    for (Member const& m : members_of(n.at(*id)))
      if (m.name == std::string_view(name).substr(dot + 1)) return of_component(n, *id, m);
  return of_space(n, name);
}

namespace {

// Value of the parameter nearest to `without` that still has modes, between there and where the network stands.
double last_with_modes(NetworkModel const& model, NetworkParameter const& p, double without) {
  double with = p.value;
  NetworkModel moved = model;
  for (int i = 0; i < 60; ++i) {
    double const middle = (with + without) / 2;
    p.set(moved, middle);
    try {
      ModeBases const bases(moved.network);
      with = middle;
    } catch (ModeError const&) {
      without = middle;
    }
  }
  return with;
}

std::string value_text(NetworkParameter const& p, double value) {
  if (p.dimension == dim::plain) return fmt::format("{:.6g}", value);
  if (p.dimension == dim::angle) return fmt::format("{:.6g} rad", value);
  return with_unit(fmt::format("{:.6g}", value), p.dimension);
}

InputError without_modes(NetworkModel const& model, std::vector<ScanAxis> const& axes,
                         std::vector<double> const& values, ModeError const& e) {
  std::string at;
  for (std::size_t i = 0; i < axes.size(); ++i)
    at += fmt::format("{}'{}' = {}", i == 0 ? "" : " and ", axes[i].parameter.name,
                      value_text(axes[i].parameter, values[i]));
  NetworkParameter const& p = axes.front().parameter;
  return InputError(
      fmt::format("the scan has no modes at {}: {}", at, e.reason),
      axes.size() > 1 ? "scan a smaller range"
                      : fmt::format("end the scan on this side at {}: from {}, where the network stands, to there it "
                                    "has modes",
                                    value_text(p, last_with_modes(model, p, values.front())), value_text(p, p.value)));
}

}  // namespace

NetworkScan scan_network(NetworkModel const& model, std::vector<ScanAxis> axes) {
  NetworkScan scan{std::move(axes), std::vector<std::vector<double>>(model.readouts.size())};
  std::size_t places = 1;
  for (ScanAxis const& axis : scan.axes) places *= axis.points;
  NetworkModel moved = model;
  for (std::size_t place = 0; place < places; ++place) {
    std::size_t rest = place;
    std::vector<double> at;
    for (ScanAxis const& axis : scan.axes) {
      at.push_back(axis.at(rest % axis.points));
      axis.parameter.set(moved, at.back());
      rest /= axis.points;
    }
    try {
      SteadyField const field(moved.network);
      for (std::size_t r = 0; r < moved.readouts.size(); ++r)
        scan.values[r].push_back(resolved_value(moved.readouts[r].readout, field));
    } catch (ModeError const& e) {
      throw without_modes(model, scan.axes, at, e);
    }
  }
  return scan;
}

}  // namespace straytrace::ifo
