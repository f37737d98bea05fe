// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/network_interferometer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/errors.hpp"
#include "ifo/control_loops.hpp"
#include "ifo/layout/read_network.hpp"
#include "ifo/network_ways.hpp"

namespace straytrace::ifo {
namespace {

constexpr double least_field = 1e-12;  // of the largest: below it is rounding

BeamPlace reversed(BeamPlace const& p) { return {ifo::reversed(p.beam), p.distance}; }

// Stray light goes from the fundamental mode of a beam to that of another.
Phasor light_at_port(SteadyField const& field, NetworkBeam b, std::size_t carrier) {
  return b.leaving ? field.out(b.port, carrier) : field.in(b.port, carrier);
}

// The phase of a space that all carriers have in common counts as beyond the place.
Phasor light(SteadyField const& field, BeamPlace const& p, std::size_t carrier) {
  double const turn = 2 * pi * field.carriers()[carrier] * p.distance / speed_of_light;
  return light_at_port(field, p.beam, carrier) * std::polar(1.0, p.beam.leaving ? turn : -turn);
}

// Of light that joins at a place. Behind a port it meets the other end of the space, not the component it comes from.
Phasor weight(LinearResponse const& r, Network const& network, SteadyField const& field, BeamPlace const& p, int side,
              std::size_t carrier, double hz) {
  double const at = field.carriers()[carrier] + (side == 0 ? hz : -hz),
               turn = 2 * pi * at * p.distance / speed_of_light;
  auto const after = [&](double phase) { return std::polar(1.0, side == 0 ? phase : -phase); };
  if (!p.beam.leaving || p.distance == 0) return after(turn) * r.weight(p.beam.port, p.beam.leaving, side, carrier);
  auto const [to, space] = neighbours(network)[p.beam.port];
  return after(phase_along(network.spaces().at(space), at) - turn) * r.weight(to, false, side, carrier);
}

double largest_field(SteadyField const& field, Network const& network) {
  double most = 0;
  for (std::uint32_t p = 0; p < network.ports(); ++p) most = std::fmax(most, field.power_out(p));
  return std::sqrt(most);
}

}  // namespace

NetworkBeam reversed(NetworkBeam b) { return {b.port, !b.leaving}; }

bool same_beam(Network const& network, NetworkBeam a, NetworkBeam b) {
  if (a.port == b.port) return a.leaving == b.leaving;
  return a.leaving != b.leaving && neighbours(network)[a.port].first == b.port;
}

std::string beam_name(Network const& n, NetworkBeam b) { return n.port_name(b.port) + (b.leaving ? ".out" : ".in"); }

StrayWay returning(NetworkBeam fed, double distance) {
  return {.lit = {reversed(fed), distance}, .fed = {fed, distance}};
}

StrayWay passing(Network const& network, NetworkBeam beam) {
  auto const [to, space] = neighbours(network)[beam.port];
  bool const ends = to >= network.ports() || network.at(network.owner_of(to)).kind == Network::Component::Kind::dump;
  BeamPlace const place{beam, ends ? 0 : 0.5 * network.spaces().at(space).length};
  return {.lit = place, .fed = place};
}

bool is_own_reverse(Network const& network, StrayWay const& way) {
  return way.alone || same_beam(network, way.lit.beam, reversed(way.fed.beam));
}

void turn_to_local_light(StrayWay& way, Network const& network, SteadyField const& field) {
  std::size_t const n = field.carrier(0);
  Phasor const from = light(field, way.lit, n), to = light(field, way.fed, n);
  double const least = least_field * largest_field(field, network);
  way.turn = std::abs(from) > least && std::abs(to) > least ? std::arg(to / from) : 0;
}

double lighting_power(StrayWay const& way, SteadyField const& field) {
  double sum = 0;
  for (std::size_t n = 0; n < field.carriers().size(); ++n) sum += std::norm(light_at_port(field, way.lit.beam, n));
  return sum;
}

namespace {

StrayResponse response_to(LinearResponse const& r, Network const& network, SteadyField const& field,
                          StrayWay const& way, double hz) {
  bool const one = is_own_reverse(network, way);
  StrayResponse sum;
  for (std::size_t n = 0; n < field.carriers().size(); ++n) {
    Phasor const turn = std::polar(1.0, way.turn + 2 * pi * field.carriers()[n] * way.delay / speed_of_light);
    auto const add = [&](BeamPlace const& fed, BeamPlace const& lit) {
      Phasor const e = turn * light(field, lit, n);
      sum.upper += weight(r, network, field, fed, 0, n, hz) * e;
      sum.lower += weight(r, network, field, fed, 1, n, hz) * std::conj(e);
    };
    add(way.fed, way.lit);
    if (!one) add(reversed(way.lit), reversed(way.fed));
  }
  return sum;
}

}  // namespace

StrayResponse stray_response(LinearResponse const& r, Network const& network, SteadyField const& field,
                             StrayWay const& way, double hz) {
  StrayResponse const front = response_to(r, network, field, way, hz);
  if (!way.both_sides) return front;
  StrayWay const behind{.lit = reversed(way.lit), .fed = reversed(way.fed), .delay = way.delay, .turn = -way.turn};
  StrayResponse const back = response_to(r, network, field, behind, hz);
  return {front.upper - back.lower, front.lower - back.upper};
}

BeyondFundamental beyond_fundamental(LinearResponse const& r, Network const& network, SteadyField const& field,
                                     StrayWay const& way) {
  if (field.modes() == 1) return {};
  std::array<double, 2> light{}, weight{};  // of mode 00, of all
  auto const add = [&](NetworkBeam fed, NetworkBeam lit) {
    for (std::size_t n = 0; n < field.carriers().size(); ++n)
      for (std::size_t mode = 0; mode < field.modes(); ++mode) {
        double const power = std::norm(lit.leaving ? field.out(lit.port, n, mode) : field.in(lit.port, n, mode)),
                     seen = std::norm(r.weight(fed.port, fed.leaving, 0, n, mode)) +
                            std::norm(r.weight(fed.port, fed.leaving, 1, n, mode));
        light[1] += power;
        weight[1] += seen;
        if (mode == 0) light[0] += power, weight[0] += seen;
      }
  };
  add(way.fed.beam, way.lit.beam);
  if (!is_own_reverse(network, way)) add(ifo::reversed(way.lit.beam), ifo::reversed(way.fed.beam));
  if (way.both_sides) add(ifo::reversed(way.fed.beam), ifo::reversed(way.lit.beam));
  return {1 - light[0] / light[1], 1 - weight[0] / weight[1]};
}

namespace {

// Largest power that meets a mirror of the degree of freedom, W, and its mass.
std::pair<double, double> pushed_mirror(NetworkModel const& model, SteadyField const& field) {
  double power = 0, mass = infinity;
  for (auto const& [id, factor] : model.strain->freedom.moves) {
    Network::Component const& c = model.network.at(id);
    for (std::uint32_t p = c.first_port; p < c.first_port + c.ports; ++p)
      if (field.power_in(p) > power) power = field.power_in(p), mass = c.suspension.mass;
  }
  return {power, mass};
}

// The number that takes the place of Gamma in eq. 9.2 without its pole.
double gain_of(NetworkModel const& model, SteadyField const& field, Phasor per_amplitude, double hz) {
  auto const [power, mass] = pushed_mirror(model, field);
  double const gain =
      std::abs(per_amplitude) * speed_of_light * mass * std::pow(2 * pi * hz, 2) * model.strain->length / (8 * power);
  return std::isfinite(gain) ? gain : not_a_number;
}

}  // namespace

std::vector<StrayRow> stray_rows(NetworkModel const& model, std::vector<NamedWay> const& ways,
                                 std::vector<double> const& hz) {
  SteadyField const field(model.network);
  double const least = std::pow(least_field * largest_field(field, model.network), 2);
  std::vector<StrayRow> rows;
  for (double const f : hz) {
    std::vector<LinearResponse> reads;
    for (NamedReadout const& r : model.readouts) reads.emplace_back(model.network, field, r.readout, f);
    std::optional<CalibratedStrain> strain;
    if (model.strain) strain.emplace(model, field, f);
    for (NamedWay const& w : ways) {
      StrayRow row;
      row.entrance = w.name;
      row.lit = beam_name(model.network, w.way.lit.beam);
      row.fed = beam_name(model.network, w.way.fed.beam);
      row.hz = f;
      row.power = lighting_power(w.way, field);
      bool const lit = row.power > least;
      auto const add = [&](std::string const& readout, std::string const& unit, StrayResponse const& r) {
        row.readout = readout;
        row.unit = unit;
        row.response = r * (lit ? w.share : not_a_number);
        rows.push_back(row);
      };
      for (std::size_t i = 0; i < reads.size(); ++i) {
        row.beyond = beyond_fundamental(reads[i], model.network, field, w.way);
        add(model.readouts[i].name, model.readouts[i].readout.kind == Readout::Kind::homodyne ? "sqrt(W)" : "W",
            stray_response(reads[i], model.network, field, w.way, f));
      }
      if (!strain) continue;
      row.beyond = beyond_fundamental(strain->whole().response, model.network, field, w.way);
      add("h", "", strain->to_stray(w.way) * (1.0 / strain->calibration()));
      rows.back().gain = gain_of(model, field, rows.back().amplitude(), f);
    }
  }
  return rows;
}

std::optional<NamedWay> find_way(NetworkModel const& model, std::string const& name) {
  auto const named = std::ranges::find(model.entrances, name, &NamedWay::name);
  if (named != model.entrances.end()) return *named;
  auto const beam = find_beam(model.network, name);
  if (!beam) return {};
  NamedWay way{name, returning(*beam)};
  turn_to_local_light(way.way, model.network, SteadyField(model.network));
  return way;
}

std::vector<NamedWay> ways_of_all_beams(NetworkModel const& model) {
  SteadyField const field(model.network);
  std::vector<NamedWay> all;
  auto const add = [&](NetworkBeam beam) {
    NamedWay way{beam_name(model.network, beam), returning(beam)};
    turn_to_local_light(way.way, model.network, field);
    all.push_back(std::move(way));
  };
  for (std::uint32_t p = 0; p < model.network.ports(); ++p) {
    add({p, false});
    if (model.network.at(model.network.owner_of(p)).moves()) add({p, true});
  }
  return all;
}

NetworkInterferometer::NetworkInterferometer(NetworkModel model, std::string readout, std::vector<PortEntry> ports,
                                             Band const& band)
    : model_(std::move(model)),
      readout_(std::move(readout)),
      field_(model_.network),
      ports_(std::move(ports)),
      band_(band) {}

std::vector<NetworkInterferometer::Answer> const& NetworkInterferometer::answer(double hz) const {
  std::scoped_lock const lock(mutex_);
  if (auto const found = answers_.find(hz); found != answers_.end()) return found->second;
  CalibratedStrain const strain(model_, field_, hz);
  if (!(std::abs(strain.calibration()) > 0))
    throw NumericalError(
        fmt::format("the read-out '{}' has no response to '{}'", readout_, model_.strain->freedom.name));
  std::vector<Answer> all;
  for (PortEntry const& e : ports_) {
    Answer& a = all.emplace_back();
    if (!e.way) continue;
    a.stray = strain.to_stray(*e.way) * (e.field_share / strain.calibration());
    a.passing = strain.to_stray(passing(model_.network, e.way->lit.beam)) * (1.0 / strain.calibration());
  }
  return answers_.emplace(hz, std::move(all)).first->second;
}

std::complex<double> NetworkInterferometer::strain_per_phase(PortId port, double hz) const {
  return answer(hz).at(port.value).stray.phase();
}
std::complex<double> NetworkInterferometer::strain_per_amplitude(PortId port, double hz) const {
  return answer(hz).at(port.value).stray.amplitude();
}

std::optional<std::complex<double>> NetworkInterferometer::strain_per_passing_amplitude(PortId port, double hz) const {
  PortEntry const& e = ports_.at(port.value);
  if (!e.way || e.picked_off()) return {};
  return answer(hz).at(port.value).passing.amplitude();
}

std::string NetworkInterferometer::description() const {
  StrainScale const& s = *model_.strain;
  return fmt::format(
             "network of the scene, {} with radiation pressure: read-out '{}' calibrated as '{}' over {:g} m, "
             "no length held{}; lambda {:g} nm",
             wave_text(model_.network), readout_, s.freedom.name, s.length, describe(model_),
             model_.network.wavelength() * 1e9) +
         describe(ports_, *this, band_);
}

namespace {

template <class Named>
Named const* find_named(Node const& node, std::string const& name, std::vector<Named> const& all, char const* what,
                        char const* key) {
  auto const hit = std::ranges::find(all, name, &Named::name);
  if (hit != all.end()) return &*hit;
  std::vector<std::string> names;
  for (Named const& n : all) names.push_back(n.name);
  node.problem(fmt::format("the network has no {} '{}'", what, name),
               did_you_mean(name, names, fmt::format("add it to '{}' of the network", key)));
  return nullptr;
}

struct Stated {
  std::string readout;
  StrainScale scale;
};

std::optional<Stated> read_strain(Node const& interferometer, NetworkModel const& model) {
  Node const node = interferometer.table("strain");
  if (!node) return {};
  std::string const readout = node.word("readout"), freedom = node.word("freedom", "DARM");
  double const length = node.number("arm_length", dim::length, required, 1e-6, 1e12);
  node.refuse_unknown("the strain of a network");
  if (!interferometer.healthy()) return {};
  NamedReadout const* const r = find_named(node["readout"], readout, model.readouts, "read-out", "readouts");
  NamedFreedom const* const f = find_named(node.has("freedom") ? node["freedom"] : node, freedom, model.freedoms,
                                           "degree of freedom", "freedoms");
  if (!r || !f) return {};
  return Stated{readout, {r->readout, *f, length}};
}

// What a port of a network without a preset needs.
void refuse_ports_without_beams(Node const& table, std::vector<PortEntry> const& entries) {
  for (PortEntry const& e : entries)
    if (e.at.empty() && !table["ports"][e.name].has("at") && !has_response_files(table, e.name))
      place_of_entrance(table, e.name)
          .problem(fmt::format("the network does not say where light of port '{}' joins", e.name),
                   fmt::format("name the beam that it joins: 'ports: {{{}: {{at: ITM.front.in}}}}'", e.name));
}

// A stray field is relative to the light that is scattered: without any, the solution is rounding.
void refuse_dark_places(Node const& table, NetworkInterferometer const& ifo, std::vector<PortEntry> const& entries) {
  double most = 0;
  for (std::uint32_t p = 0; p < ifo.network()->network.ports(); ++p) most = std::fmax(most, ifo.field().power_out(p));
  for (PortEntry const& e : entries)
    if (e.way && !(lighting_power(*e.way, ifo.field()) > 1e-24 * most))
      place_of_entrance(table, e.name)
          .problem(fmt::format("no light comes from '{}', so a relative stray field is not defined",
                               beam_name(ifo.network()->network, e.way->lit.beam)),
                   "name the beam whose light is scattered by 'lit_by'");
}

// Without a response to the degree of freedom nothing becomes strain.
void refuse_blind_strain(Node const& strain, NetworkInterferometer const& ifo, Band const& band) {
  StrainScale const& s = *ifo.network()->strain;
  if (!sees(ifo.network()->network, ifo.field(), s.readout, s.freedom, std::sqrt(band.low * band.high)))
    strain["readout"].problem(
        fmt::format("'{}' does not respond to '{}'", strain["readout"].text(), s.freedom.name),
        "name a read-out with light that changes with it; at a dark fringe or the top of a resonance, state an offset");
}

}  // namespace

void warn_of_other_modes(Node const& table, NetworkModel const& model, SteadyField const& field,
                         std::vector<PortEntry> const& entries, Band const& band) {
  constexpr double small = 1e-3;
  if (!model.network.modes()) return;
  CalibratedStrain const strain(model, field, std::sqrt(band.low * band.high));
  LinearResponse const response = strain.whole().response;
  for (PortEntry const& e : entries) {
    auto const place = e.way ? std::nullopt : entrance_in(model.network, field, e.injection_point);
    if (has_response_files(table, e.name) || (!e.way && !place)) continue;
    auto const [light, weight] = beyond_fundamental(response, model.network, field, e.way ? *e.way : place->way);
    if (!(std::fmax(light, weight) > small)) continue;
    place_of_entrance(table, e.name)
        .warning(
            fmt::format("at port '{}', {:.2g} of the light and {:.2g} of the weight of the beam it joins are not in "
                        "mode 00, and the response to stray light leaves them out (eq. N.16)",
                        e.name, light, weight),
            "match curvatures and tilts of the network; --show modes says where they do not match");
  }
}

std::unique_ptr<Interferometer> read_network_interferometer(Node const& table, std::vector<TracedPort> const& ports,
                                                            double wavelength, Band const& band,
                                                            std::vector<DrawnOptic> const& optics) {
  std::optional<NetworkModel> model = read_bare_network(table, wavelength, optics);
  if (!table.has("strain")) {
    if (!ports.empty())
      table["preset"].problem("a network without a preset does not say how light of the ports becomes strain",
                              "add 'strain: {readout: AS, freedom: DARM, arm_length: 3 km}' with names of the network, "
                              "and to 'ports' the beam that each joins: '{at: ITM.front.in}'; or start from a preset");
    return nullptr;
  }
  std::vector<PortEntry> entries = read_port_entries(table, ports, 1);
  refuse_ports_without_beams(table, entries);
  if (!model || !table.healthy()) return nullptr;
  auto const strain = read_strain(table, *model);
  resolve_beams(table, model->network, 1, entries);
  resolve_places(table, model->network, entries);
  if (!strain || !table.healthy()) return nullptr;
  model->strain = strain->scale;
  add_entrances(entries, *model);
  read_subtracted_channels(table, *model, band);
  auto ifo = std::make_unique<NetworkInterferometer>(*std::move(model), strain->readout, entries, band);
  refuse_dark_places(table, *ifo, entries);
  if (table.healthy()) refuse_blind_strain(table["strain"], *ifo, band);
  if (table.healthy()) warn_of_other_modes(table, *ifo->network(), ifo->field(), entries, band);
  return table.healthy() ? std::move(ifo) : nullptr;
}

}  // namespace straytrace::ifo
