// SPDX-License-Identifier: BSD-3-Clause
// Degrees of freedom, places of stray light and controlled lengths of a dual-recycled interferometer.
#include <cmath>

#include "ifo/dual_recycled.hpp"

namespace straytrace::ifo {
namespace {

// Displacements of mirrors per m of a degree of freedom, with the splitter at rest.
std::array<std::pair<char const*, double>, 6> moves_of(Freedom f) {
  Eigen::Matrix<double, 6, 1> const length = lengths_of_freedoms().col(Eigen::Index(f));
  auto const of = [&](Length l) { return length[Eigen::Index(l)]; };
  return {{{"SRM", of(Length::signal)},
           {"PRM", -of(Length::recycling)},
           {"ITMx", of(Length::short_x)},
           {"ETMx", of(Length::short_x) + of(Length::arm_x)},
           {"ITMy", of(Length::short_y)},
           {"ETMy", of(Length::short_y) + of(Length::arm_y)}}};
}

}  // namespace

Phasor DualRecycled::to_freedom(LinearResponse const& r, Freedom f) const {
  auto const moves = moves_of(f);
  auto const to = [&](int i) { return r.to_displacement(network_.find(moves[i].first)) * moves[i].second; };
  Phasor sum = to(0) + to(1);
  sum += to(2) + to(3);
  return sum + to(4) + to(5);
}

namespace {

constexpr std::array<Freedom, 4> locked = {Freedom::carm, Freedom::mich, Freedom::prcl, Freedom::srcl};

// The length itself as a read-out, with the splitter at rest.
Readout length_of(Network const& n, Freedom f) {
  Eigen::Matrix<double, 1, 6> const of = freedoms_of_lengths().row(Eigen::Index(f));
  auto const part = [&](Length l) { return of[Eigen::Index(l)]; };
  double const x = part(Length::arm_x), y = part(Length::arm_y);
  return Readout::motion({{n.find("ETMx"), x},
                          {n.find("ITMx"), part(Length::short_x) - x},
                          {n.find("ETMy"), y},
                          {n.find("ITMy"), part(Length::short_y) - y},
                          {n.find("PRM"), -part(Length::recycling)},
                          {n.find("SRM"), part(Length::signal)}});
}

constexpr bool is_at_the_splitter(InjectionPoint e) {
  return e == InjectionPoint::short_arm || e == InjectionPoint::recycling_cavity || e == InjectionPoint::signal_cavity;
}

StrayWay way_of(Injection const& i) {
  return {.lit = {{i.port, i.of_leaving}}, .fed = {{i.port, i.joins_leaving}}, .turn = i.turn, .alone = true};
}

}  // namespace

NamedFreedom DualRecycled::freedom(Freedom f) const {
  constexpr std::array<char const*, 6> names = {"DARM", "CARM", "MICH", "PRCL", "SRCL", "mean short arm"};
  NamedFreedom freedom{names[std::size_t(f)]};
  for (auto const& [mirror, factor] : moves_of(f))
    if (factor != 0) freedom.moves.emplace_back(network_.find(mirror), factor);
  return freedom;
}

NetworkModel DualRecycled::model(std::string preset) const {
  NetworkModel m{.preset = std::move(preset), .network = network_};
  auto const at = [&](char const* component, std::uint32_t port) {
    return network_.number_of({network_.find(component), port});
  };
  m.readouts = {{"AS", Readout::power(at("SRM", 1)).of_leaving()},
                {"REFL", Readout::power(at("PRM", 0)).of_leaving()},
                {"POP", Readout::power(at("BS", 0))}};
  for (std::size_t f = 0; f <= std::size_t(Freedom::srcl); ++f) m.freedoms.push_back(freedom(Freedom(f)));
  m.strain = {readout_, m.freedoms[std::size_t(Freedom::darm)], p_.arm_length};
  for (Freedom const f : locked) m.controlled.push_back({length_of(network_, f), m.freedoms[std::size_t(f)], {}});
  m.entrances = entrances();
  return m;
}

std::vector<NamedWay> DualRecycled::entrances() const {
  std::vector<NamedWay> all;
  for (std::size_t e = 0; e < entrance_names.size(); ++e)
    all.push_back(
        {std::string(entrance_names[e]), way_of(injection(InjectionPoint(e))), 1 / share_outside(InjectionPoint(e))});
  for (BeamSynonym const& s : beam_synonyms) {
    NamedWay way{std::string(s.name), returning(*find_beam(network_, std::string(s.beam)))};
    turn_to_local_light(way.way, network_, *field_);
    all.push_back(std::move(way));
  }
  return all;
}

std::optional<Injection> injection_in(Network const& network, SteadyField const& field,
                                      InjectionPoint injection_point) {
  struct Way {
    char const* component;
    std::uint32_t port;
    bool joins_leaving, of_leaving;
    double turn;
  };
  // The light of a bench passes the end mirror twice, t against the i r of reflection: a bench at such a distance that
  // Re s comes back in phase with the light in the arm. In the three cavities of the splitter Re s comes back in phase
  // with the light it joins.
  constexpr std::array<Way, entrance_names.size()> ways = {{{"ITMx", 1, true, true, 0},
                                                            {"ETMx", 0, true, true, 0},
                                                            {"ETMx", 1, false, true, pi / 2},
                                                            {"ETMx", 1, false, true, pi / 2},
                                                            {"ITMx", 0, false, true, 0},
                                                            {"BS", 0, false, true, 0},
                                                            {"SRM", 0, false, true, 0},
                                                            {"SRM", 1, false, true, 0},
                                                            {"PRM", 0, false, true, 0},
                                                            {"PRM", 0, false, false, 0}}};
  Way const& way = ways[std::size_t(injection_point)];
  auto const id = network.search(way.component);
  if (!id || way.port >= network.at(*id).ports) return {};
  Injection i{network.number_of({*id, way.port}), way.joins_leaving, way.of_leaving, way.turn};
  if (is_at_the_splitter(injection_point)) {
    StrayWay back = way_of(i);
    turn_to_local_light(back, network, field);
    i.turn = back.turn;
  }
  return i;
}

std::optional<NamedWay> entrance_in(Network const& network, SteadyField const& field, InjectionPoint e) {
  auto const i = injection_in(network, field, e);
  if (!i) return {};
  NamedWay way{std::string(entrance_names[std::size_t(e)]), way_of(*i)};
  if (e == InjectionPoint::through_end) {
    auto const* end = std::get_if<MirrorParameters>(&network.at(network.owner_of(i->port)).stated);
    if (!end) return {};
    way.share = 1 / end->transmission;
  }
  return way;
}

Injection DualRecycled::injection(InjectionPoint e) const { return injection_in(network_, *field_, e).value(); }

}  // namespace straytrace::ifo
