// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/layout/drawn_optics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "ifo/layout/read_network.hpp"
#include "ifo/mode_bases.hpp"
#include "ifo/network_ways.hpp"

namespace straytrace::ifo {
namespace {

using Component = Network::Component;
using Kind = Component::Kind;

constexpr double curvature_agrees = 1e-6, angle_agrees = 1e-3;  // relative; rad
constexpr double most_tilt = 0.05;                              // rad, of a mirror against the light that it returns

// The next mirror or splitter behind a port, through components that light passes straight; the number of ports: none.
std::uint32_t next_interface(Network const& n, std::uint32_t port) {
  auto const other = neighbours(n);
  for (std::size_t steps = 0; steps <= n.components().size(); ++steps) {
    std::uint32_t const end = other[port].first;
    if (end == n.ports()) return end;
    Component const& c = n.at(n.owner_of(end));
    if (c.interface()) return end;
    if (c.ports != 2) return n.ports();
    port = c.first_port + (end == c.first_port ? 1 : 0);
  }
  return n.ports();
}

double degrees(double radians) { return radians * 180 / pi; }

}  // namespace

void OpticReader::read(std::string const& component, Node const& mirror) {
  if (!mirror.has("optic")) return;
  Node const node = mirror["optic"];
  std::string const name = node.as_word();
  auto const found = std::ranges::find(drawn_, name, &DrawnOptic::name);
  if (found != drawn_.end()) {
    used_.push_back({component, mirror, &*found});
    return;
  }
  std::vector<std::string> known;
  for (DrawnOptic const& d : drawn_) known.push_back(d.name);
  node.problem(
      known.empty() ? std::string("the scene draws no mirror") : fmt::format("the scene has no mirror '{}'", name),
      known.empty() ? "add disks or caps to 'scene', or state 'curvature' and lengths instead of 'optic'"
                    : did_you_mean(name, known, "name a disk or cap of 'scene'"));
}

OpticReader::Used const* OpticReader::find(std::string const& port_or_component) const {
  auto const found = std::ranges::find(used_, port_or_component.substr(0, port_or_component.find('.')),
                                       [](Used const& u) { return u.component; });
  return found == used_.end() ? nullptr : &*found;
}

std::optional<double> OpticReader::distance(Node const& space, std::string const& from, std::string const& to) const {
  Used const *one = find(from), *two = find(to);
  if (one && two) return length(two->optic->vertex - one->optic->vertex);
  space["length"].problem(fmt::format("'scene' is the way between two optics, and '{}' names none", one ? to : from),
                          "add 'optic: NAME' to this component, or write the length");
  return {};
}

std::vector<OpticReader::Meeting> OpticReader::meetings(Used const& used, Network const& n) const {
  Component const& c = n.at(n.find(used.component));
  std::vector<Meeting> all;
  for (std::uint32_t port = 0; port < c.ports; ++port) {
    std::uint32_t const end = next_interface(n, c.first_port + port);
    Used const* const other = end == n.ports() ? nullptr : find(n.name(n.owner_of(end)));
    if (!other || other == &used) continue;
    Vec3 const way = unit(other->optic->vertex - used.optic->vertex);
    double const cosine = dot(way, used.optic->axis);
    all.push_back({n.port_name(c.first_port + port), other, cosine > 0, port < c.ports / 2,
                   std::acos(std::fmin(1, std::fabs(cosine)))});
  }
  for (Meeting const& m : all)
    if ((m.ahead == m.front) != (all[0].ahead == all[0].front)) {
      used.mirror["optic"].problem(
          fmt::format("'{}' is drawn {} '{}' and '{}' {} it, which does not suit the ports '{}' and '{}'",
                      all[0].other->optic->name, all[0].ahead ? "ahead of" : "behind", used.optic->name,
                      m.other->optic->name, m.ahead ? "ahead of" : "behind", all[0].port, m.port),
          "exchange the sides in 'spaces', or name another optic");
      return {};
    }
  return all;
}

// Positive when concave seen from the front of the component; nothing with a problem.
std::optional<double> OpticReader::curvature(Used const& used, std::vector<Meeting> const& met) const {
  double const drawn = used.optic->curvature;
  Node const& t = used.mirror;
  bool const stated = t.has("curvature");
  if (met.empty() && drawn != 0 && !stated) {
    t["optic"].problem(fmt::format("which side of '{}' is the front of '{}' is not known: no space leads from it to "
                                   "another optic",
                                   used.optic->name, used.component),
                       "name the optic at the other end of a space, or state 'curvature'");
    return {};
  }
  double const taken = met.empty() ? drawn : met[0].ahead == met[0].front ? drawn : -drawn;
  if (!stated) return taken;
  bool const two = t["curvature"].kind() == Node::Kind::list;
  std::vector<double> const values = two ? t["curvature"].as_numbers(dim::per_metre, 2)
                                         : std::vector{t.number("curvature", dim::per_metre, 0, -1e3, 1e3)};
  for (double const v : values) {
    bool const agrees = std::fabs((met.empty() ? std::fabs(v) : v) - (met.empty() ? std::fabs(taken) : taken)) <=
                        curvature_agrees * std::fabs(taken) + 1e-15;
    if (std::isnan(v) || agrees) continue;
    t["curvature"].problem(fmt::format("the optic '{}' has a curvature of {:.9g} /m, seen from the front of '{}'",
                                       used.optic->name, taken, used.component),
                           "remove 'curvature', or 'optic'");
    return {};
  }
  return std::nullopt;
}

// rad; nothing where it is stated, or with a problem.
std::optional<double> OpticReader::incidence(Used const& used, std::vector<Meeting> const& met, bool splitter) const {
  Node const& t = used.mirror;
  bool const stated = splitter && t.has("incidence");
  double const expected = !splitter     ? 0
                          : stated      ? t.number("incidence", dim::angle, 0)
                          : met.empty() ? 0
                                        : met[0].incidence;
  for (Meeting const& m : met) {
    if (std::isnan(expected) || std::fabs(m.incidence - expected) <= (splitter ? angle_agrees : most_tilt)) continue;
    t[stated ? "incidence" : "optic"].problem(
        fmt::format("the way to '{}' makes {:.6g} deg with the normal of '{}', not {:.6g} deg", m.other->optic->name,
                    degrees(m.incidence), used.optic->name, degrees(expected)),
        stated     ? "remove 'incidence', or 'optic'"
        : splitter ? "state 'incidence', or turn the optics of the scene"
                   : "make it a splitter, or turn the optics of the scene");
    return {};
  }
  if (!splitter || stated) return {};
  if (!met.empty()) return expected;
  t["optic"].problem(fmt::format("the incidence on '{}' is not known: no space leads from '{}' to another optic",
                                 used.optic->name, used.component),
                     "state 'incidence', or name the optic at the other end of a space");
  return {};
}

void OpticReader::finish(NetworkChanges& changes, Network const& network) const {
  for (Used const& used : used_) {
    auto const id = network.search(used.component);
    if (!id || !network.at(*id).interface()) continue;
    std::vector<Meeting> const met = meetings(used, network);
    bool const splitter = network.at(*id).kind == Kind::splitter;
    auto const curvature = this->curvature(used, met);
    auto const incidence = this->incidence(used, met, splitter);
    std::string const origin =
        fmt::format("optic {}{}", used.optic->name, used.optic->body.empty() ? "" : ", body " + used.optic->body);
    for (NetworkChanges::Shape& s : changes.shapes) {
      if (s.component != used.component) continue;
      if (curvature) s.curvature = curvature;
      s.origin = origin;
    }
    for (Component& c : changes.components) {
      if (c.name != used.component) continue;
      MirrorParameters p = std::get<MirrorParameters>(c.stated);
      p.curvature = curvature.value_or(p.curvature);
      p.incidence = incidence.value_or(p.incidence);
      p.origin = origin;
      c = splitter ? Network::splitter(c.name, p) : Network::mirror(c.name, p);
    }
  }
}

// The table `modes` of a network.

namespace {

using Component = Network::Component;

constexpr std::size_t most_modes = 2000;  // of all carriers
constexpr int most_order = 16;

std::vector<std::vector<std::string>> read_cavities(Node const& modes, Network const& network) {
  std::vector<std::vector<std::string>> cavities;
  std::vector<std::string> known;
  for (Component const& c : network.components()) known.push_back(c.name);
  for (Node const& cavity : modes.has("cavities") ? modes.list("cavities") : std::vector<Node>{}) {
    std::vector<std::string>& names = cavities.emplace_back();
    for (Node const& name : cavity.as_list()) {
      names.push_back(name.as_word());
      if (!network.search(names.back()))
        name.problem(fmt::format("the network has no component '{}'", names.back()),
                     did_you_mean(names.back(), known, "name mirrors of the cavity: [PRM, ITM]"));
    }
  }
  return cavities;
}

// Tilts and offsets put light into odd modes, which `parity: even` leaves out.
void refuse_odd_light(Node const& parity, Network const& network) {
  auto const any = [](std::array<double, 2> const& of) { return of[0] != 0 || of[1] != 0; };
  for (Component const& c : network.components()) {
    auto const* mirror = std::get_if<MirrorParameters>(&c.stated);
    auto const* stop = std::get_if<ApertureParameters>(&c.stated);
    if ((mirror && any(mirror->tilt)) || (stop && any(stop->offset)))
      parity.problem(fmt::format("'even' leaves out the odd modes, which the {} of '{}' makes",
                                 mirror ? "tilt" : "offset", c.name),
                     fmt::format("write 'parity: all', or remove the {}", mirror ? "tilt" : "offset"));
  }
}

}  // namespace

std::optional<ModeSettings> read_modes(Node const& table, Network network) {
  Node const modes = table.table("modes");
  if (!modes) return {};
  constexpr std::array<std::string_view, 2> parities = {"all", "even"};
  if (!modes.has("order"))
    modes.lack("order", "'modes' has no 'order'", "add 'order: 2', the largest n + m; 'order: 0' is plane waves");
  ModeSettings settings{int(modes.whole("order", 0, 0, most_order)),
                        modes.choice("parity", parities, parities[0]) == "even", read_cavities(modes, network)};
  modes.refuse_unknown("the modes of a network");
  if (settings.even) refuse_odd_light(modes["parity"], network);
  if (settings.order == 0 || !table.healthy()) return {};
  network.use_modes(settings);
  try {
    std::size_t const count = ModeBases(network).count() * network.carriers().size();
    if (count > most_modes)
      modes.problem(fmt::format("the carriers have {} modes together", count),
                    "reduce 'order', or the carriers of the modulators");
  } catch (ModeError const& e) {
    modes.problem(e.reason, e.remedy);
  }
  return settings;
}

}  // namespace straytrace::ifo
