// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/ports.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text/words.hpp"
#include "ifo/layout/read_network.hpp"
#include "ifo/network_interferometer.hpp"

namespace straytrace::ifo {
namespace {

constexpr double faintest = 1e-30;  // of the light that a port returns: below it the place is not a port
constexpr double same_power = 0.1;  // relative: powers nearer than this may be rounded, or with and without a loss
constexpr double same_length = 0.01;

bool agrees(double a, double b, double tolerance) { return std::fabs(a - b) <= tolerance * std::fabs(b); }

std::vector<TracedPort> inside_an_arm(std::vector<TracedPort> const& ports, std::vector<PortEntry> const& entries) {
  std::vector<TracedPort> inside;
  for (std::size_t i = 0; i < ports.size(); ++i)
    if (entries[i].is_inside_an_arm()) inside.push_back(ports[i]);
  return inside;
}

// Of ports that state this number, the first of each value.
std::vector<TracedPort> different(std::vector<TracedPort> const& ports, double TracedPort::*number, double tolerance) {
  std::vector<TracedPort> all;
  for (TracedPort const& p : ports)
    if (p.*number > 0 &&
        std::ranges::none_of(all, [&](TracedPort const& other) { return agrees(p.*number, other.*number, tolerance); }))
      all.push_back(p);
  return all;
}

std::string number(std::complex<double> response) {
  return response == 0.0 ? std::string("none") : fmt::format("{:.3g}", std::abs(response));
}

auto find(std::vector<TracedPort> const& ports, std::string const& name) {
  return std::ranges::find_if(ports, [&](TracedPort const& p) { return p.name == name; });
}

void unknown_port(Node const& at, std::string const& name, std::vector<TracedPort> const& all) {
  std::vector<std::string> ports;
  for (TracedPort const& p : all) ports.push_back(p.name);
  at.problem(fmt::format("the scene has no port '{}'", name),
             did_you_mean(name, ports,
                          ports.empty() ? "add it to 'ports' of the scene"
                                        : fmt::format("its ports: {}", fmt::join(ports, ", "))));
}

InjectionPoint read_injection_point(Node const& node, TracedPort const& port) {
  std::vector<std::string_view> names(entrance_names.begin(), entrance_names.end());
  for (BeamSynonym const& s : beam_synonyms) names.push_back(s.name);
  std::string const at = node.choice("at", names, entrance_names[std::size_t(port.injection_point)]);
  auto const found = std::ranges::find(entrance_names, at);
  return found == entrance_names.end() ? port.injection_point : InjectionPoint(found - entrance_names.begin());
}

// A point on the beam that a key names; nothing with a problem.
std::optional<BeamPlace> read_place(Node const& beam, Node const& entry, char const* distance, Network const& network) {
  std::optional<NetworkBeam> found;
  auto const synonym = std::ranges::find(beam_synonyms, beam.text(), &BeamSynonym::name);
  if (synonym != beam_synonyms.end()) {
    found = find_beam(network, std::string(synonym->beam));
    if (!found) beam.problem("this network has no such place", "name a beam of it: PRM.back.in");
  } else {
    found = read_beam(beam, network);
  }
  double const metres = entry.number(distance, dim::length, 0, 0, 1e12);
  if (!found) return {};
  auto const space = std::ranges::find_if(
      network.spaces(), [&](Network::Space const& s) { return s.from == found->port || s.to == found->port; });
  double const length = space == network.spaces().end() ? 0 : space->length;
  if (metres > length)
    entry[distance].problem(fmt::format("the space at '{}' is {:g} m long", network.port_name(found->port), length),
                            "measure the distance from this port, or name the next one");
  return BeamPlace{*found, metres};
}

// Both ends of the space of a beam of an arm of a preset, or one end at the splitter.
bool is_in_an_arm(Network const& network, NetworkBeam b) {
  auto const of_arm = [&](std::uint32_t port) {
    std::string const& name = network.name(network.owner_of(port));
    return name == "ITMx" || name == "ITMy" || name == "ETMx" || name == "ETMy";
  };
  return of_arm(b.port) || std::ranges::any_of(network.spaces(), [&](Network::Space const& s) {
           return (s.from == b.port && of_arm(s.to)) || (s.to == b.port && of_arm(s.from));
         });
}

// "BS.3.out" -> "BS.3.in".
std::string opposite(std::string const& beam) {
  return beam.substr(0, beam.rfind('.')) + (beam.ends_with(".out") ? ".in" : ".out");
}

// Of a port as the beams of the scene state it.
PortEntry entry_of(TracedPort const& p, double copies) {
  PortEntry entry{.name = p.name, .injection_point = p.injection_point, .copies = copies};
  if (p.light.empty()) return entry;
  entry.copies = 1;
  entry.reference = p.reference;
  entry.field_share = 1 / p.reference;
  entry.at = p.along ? p.light : opposite(p.light);
  entry.lit_by = p.along ? p.light : p.lit_by;
  entry.both_sides = p.both_sides;
  return entry;
}

PortEntry read_entry(Node const& node, TracedPort const& port, double arms) {
  PortEntry entry = entry_of(port, 1);
  if (node.kind() != Node::Kind::table) {
    node.problem(fmt::format("port '{}' must be a table", entry.name), "write {at: end-bench}");
    return entry;
  }
  std::string const word = node.has("at") ? node["at"].text() : "";
  if (word.find('.') != word.npos || std::ranges::find(beam_synonyms, word, &BeamSynonym::name) != beam_synonyms.end())
    entry.at = node.word("at");
  else if (entry.at.empty() || !word.empty())
    entry.at.clear(), entry.injection_point = read_injection_point(node, port);
  entry.both_sides = node.flag("both_sides", entry.both_sides);
  if (entry.both_sides && node.has("lit_by"))
    node["lit_by"].problem("'both_sides' is a face that returns the light of each side: 'lit_by' has no effect",
                           "remove one of them");
  for (char const* key : {"lit_by", "distance", "lit_distance", "both_sides"})
    if (node.has(key) && entry.at.empty())
      node[key].problem(fmt::format("'{}' needs a beam of the network in 'at'", key),
                        "write for example {at: ITMx.front.in, lit_by: ITMx.front.out}");
  entry.field_share *= node.number("pick_off", dim::plain, 1, faintest, 1) *
                       std::sqrt(node.number("isolation", dim::plain, 1, faintest, 1));
  bool const of_an_arm = entry.at.empty() && is_of_an_arm(entry.injection_point);
  entry.copies = node.number("copies", dim::plain, of_an_arm ? arms : 1, 1, 1e6);
  node.refuse_unknown(fmt::format("port '{}'", entry.name));
  return entry;
}

struct Measured {
  TransferFunction phase, amplitude;
  double factor = 1;  // to strain per relative field
  TransferFunction calibration;
  bool calibrated = false;
  std::string files;
  std::complex<double> operator()(TransferFunction const& t, double hz) const {
    return factor * t(hz) / (calibrated ? calibration(hz) : 1.0);
  }
};

Measured read_measured(Node const& node, std::string const& name, double arm_length, Band const& band) {
  Measured m;
  if (node.kind() != Node::Kind::table) {
    node.problem(fmt::format("the responses of port '{}' must be a table", name),
                 "write {phase: phase.txt, amplitude: amplitude.txt, columns: [Hz, re, im], unit: strain}");
    return m;
  }
  constexpr std::array<std::string_view, 3> units = {"strain", "m", "W"};
  constexpr std::array<std::string_view, 2> shares = {"field", "power"};
  bool const decibels = read_columns_are_decibels(node);
  std::string const unit = node.choice("unit", units);
  // dP/P = 2 Re s: a response per relative power is half of that per relative field.
  m.factor = (unit == "strain" ? 1 : 1 / arm_length) * (node.choice("per", shares, shares[0]) == "power" ? 2 : 1);
  for (auto [key, into] : {std::pair{"phase", &m.phase}, std::pair{"amplitude", &m.amplitude}})
    if (Node const file = node[key]) {
      *into = read_response_file(file, decibels, band);
      m.files += fmt::format("{}{} {}", m.files.empty() ? "" : ", ", key, file.text());
    }
  if (m.files.empty())
    node.problem("neither 'phase' nor 'amplitude' is given", "name a file of frequency and complex response");
  m.calibrated = unit == "W";
  if (m.calibrated && !node.has("darm"))
    node.problem("a response in W needs that of the same read-out to DARM", "add 'darm: FILE', in W/m");
  if (node.has("darm") && (unit == "strain" || unit == "m"))
    node["darm"].problem(fmt::format("a response in {} is already calibrated: 'darm' would have no effect", unit),
                         "remove it, or write 'unit: W' when the file gives watts of the read-out");
  if (node.has("darm")) m.calibration = read_response_file(node["darm"], decibels, band);
  node.refuse_unknown(fmt::format("the responses of port '{}'", name));
  return m;
}

class MeasuredResponses final : public Interferometer {
 public:
  MeasuredResponses(std::unique_ptr<Interferometer> rest, std::map<std::uint32_t, Measured> measured,
                    std::vector<TracedPort> const& ports)
      : rest_(std::move(rest)), measured_(std::move(measured)) {
    for (auto const& [port, m] : measured_)
      note_ += fmt::format("; port {}: responses from files ({})", ports[port].name, m.files);
  }
  std::complex<double> strain_per_phase(PortId port, double hz) const override {
    auto const found = measured_.find(port.value);
    return found == measured_.end() ? rest_->strain_per_phase(port, hz) : found->second(found->second.phase, hz);
  }
  std::complex<double> strain_per_amplitude(PortId port, double hz) const override {
    auto const found = measured_.find(port.value);
    return found == measured_.end() ? rest_->strain_per_amplitude(port, hz)
                                    : found->second(found->second.amplitude, hz);
  }
  std::optional<std::complex<double>> strain_per_passing_amplitude(PortId port, double hz) const override {
    return measured_.contains(port.value) ? std::nullopt : rest_->strain_per_passing_amplitude(port, hz);
  }
  double copies(PortId port) const override { return rest_->copies(port); }
  NetworkModel const* network() const override { return rest_->network(); }
  DetectorNumbers numbers() const override { return rest_->numbers(); }
  std::string description() const override { return rest_->description() + note_; }

 private:
  std::unique_ptr<Interferometer> rest_;
  std::map<std::uint32_t, Measured> measured_;
  std::string note_;
};

}  // namespace

std::vector<PortEntry> read_port_entries(Node const& interferometer, std::vector<TracedPort> const& ports,
                                         double arms) {
  std::vector<PortEntry> entries;
  for (TracedPort const& p : ports) entries.push_back(entry_of(p, arms));
  if (Node const table = interferometer.table("ports"))
    for (auto const& [name, node] : table.items()) {
      auto const at = find(ports, name);
      PortEntry read = read_entry(node, at == ports.end() ? TracedPort{.name = name} : *at, arms);
      if (at == ports.end())
        unknown_port(node, name, ports);
      else
        entries[std::size_t(at - ports.begin())] = std::move(read);
    }
  return entries;
}

namespace {

std::optional<BeamPlace> place_of(Network const& network, std::string const& beam) {
  auto const found = find_beam(network, beam);
  return found ? std::optional(BeamPlace{*found}) : std::nullopt;
}

// The same light where it enters the next component.
BeamPlace far_end(Network const& network, BeamPlace const& place) {
  for (Network::Space const& s : network.spaces())
    for (auto const& [from, to] : {std::pair{s.from, s.to}, std::pair{s.to, s.from}})
      if (place.beam.leaving && from == place.beam.port) return {{to, false}};
  return place;
}

// A face that returns the light of both sides: where the port says, or in the middle of its space, away from mirrors,
// which would take a recoil.
void set_between_ends(Network const& network, StrayWay& way) {
  way.both_sides = true;
  if (way.fed.distance > 0) return;
  double const middle = passing(network, way.fed.beam).fed.distance;
  way.fed.distance = way.lit.distance = middle;
}

// The beams that a port names, or that the beams of the scene are; nothing with a problem. Completes the text of its
// place.
std::optional<StrayWay> stated_way(Node const& node, Network const& network, PortEntry& e) {
  bool const stated = node && node["at"];
  auto const fed = stated ? read_place(node["at"], node, "distance", network) : place_of(network, e.at);
  if (!fed) return {};
  StrayWay way = returning(fed->beam, fed->distance);
  if (e.both_sides) {
    set_between_ends(network, way);
    e.at += " from both sides";
    return way;
  }
  if (auto const lit = place_of(network, e.lit_by)) {
    bool const along = e.lit_by == e.at;
    way.lit = *lit;
    if (along) way.fed = far_end(network, *fed);
    e.at += along ? ", along it" : " lit by " + e.lit_by;
  }
  if (!node) return way;
  if (Node const lit = node["lit_by"]) {
    auto const place = read_place(lit, node, "lit_distance", network);
    if (!place) return {};
    way.lit = *place;
    e.at += " lit by " + lit.text();
  } else if (node.has("lit_distance")) {
    node["lit_distance"].problem("'lit_distance' needs a beam in 'lit_by'", "remove it");
  }
  return way;
}

}  // namespace

void resolve_beams(Node const& interferometer, Network const& network, double arms, std::vector<PortEntry>& entries) {
  std::optional<SteadyField> field;
  for (PortEntry& e : entries) {
    if (e.at.empty()) continue;
    Node const ports = interferometer["ports"], node = ports ? ports[e.name] : Node();
    auto way = stated_way(node, network, e);
    if (!way) continue;
    if (!(node && node.has("copies")) && is_in_an_arm(network, way->fed.beam)) e.copies = arms;
    // A port of faces is named after those of both sides, and has as many copies.
    Node const side = ports && e.both_sides ? ports[e.name.substr(0, e.name.find(" + "))] : Node();
    if (!node && side && side.has("copies")) e.copies = side.number("copies", dim::plain, e.copies, 1, 1e6);
    if (!interferometer.healthy()) continue;
    if (!field) field.emplace(network);
    turn_to_local_light(*way, network, *field);
    e.way = way;
  }
}

void add_entrances(std::vector<PortEntry> const& entries, NetworkModel& model) {
  for (PortEntry const& e : entries) {
    if (!e.way) continue;
    std::erase_if(model.entrances, [&](NamedWay const& w) { return w.name == e.name; });
    model.entrances.push_back({e.name, *e.way, e.field_share});
  }
}

void resolve_places(Node const& interferometer, Network const& network, std::vector<PortEntry>& entries) {
  if (!interferometer.healthy()) return;
  std::optional<SteadyField> field;
  for (PortEntry& e : entries) {
    Node const at = interferometer["ports"][e.name]["at"];
    if (!e.at.empty() || !at) continue;
    if (!field) field.emplace(network);
    auto const place = entrance_in(network, *field, e.injection_point);
    if (!place) {
      at.problem("this network has no such place", "name a beam of it: PRM.back.in");
      continue;
    }
    e.at = place->name;
    e.way = place->way;
    e.field_share *= place->share;
  }
}

void read_entrances(Node const& interferometer, std::vector<TracedPort> const& ports, NetworkModel& model) {
  std::vector<PortEntry> entries = read_port_entries(interferometer, ports, 1);
  for (PortEntry const& e : entries)
    if (Node const entry = interferometer["ports"][e.name]; entry.kind() == Node::Kind::table && !entry.has("at"))
      entry.lack("at", fmt::format("the entrance '{}' has no 'at'", e.name),
                 "name the beam that light joins: ITM.front.in");
  resolve_beams(interferometer, model.network, 1, entries);
  resolve_places(interferometer, model.network, entries);
  add_entrances(entries, model);
}

Node place_of_entrance(Node const& interferometer, std::string const& port) {
  Node const ports = interferometer["ports"], entry = ports ? ports[port] : Node(), at = entry ? entry["at"] : Node();
  return at ? at : entry ? entry : interferometer;
}

bool has_response_files(Node const& interferometer, std::string const& port) {
  Node const files = interferometer["responses"];
  return files && files.has(port);
}

double beam_power_in_arm(Node const& interferometer, std::vector<TracedPort> const& ports,
                         std::vector<PortEntry> const& entries) {
  std::vector<TracedPort> const arm = different(inside_an_arm(ports, entries), &TracedPort::power, same_power);
  if (arm.size() > 1 && interferometer.healthy())
    interferometer.problem(
        fmt::format("two beams in the arms state different powers: {:.4g} W at port '{}', {:.4g} W at port '{}'",
                    arm[0].power, arm[0].name, arm[1].power, arm[1].name),
        "make them agree, add 'arm_power' here, or mark the beam outside the arms with 'at' of its port");
  return arm.empty() ? 0 : arm[0].power;
}

void warn_of_other_arms(Node const& interferometer, std::vector<TracedPort> const& ports,
                        std::vector<PortEntry> const& entries, double arm_power, double arm_length) {
  std::vector<TracedPort> const inside = inside_an_arm(ports, entries);
  for (TracedPort const& p : different(inside, &TracedPort::power, same_power))
    if (!agrees(p.power, arm_power, same_power))
      interferometer.warning(
          fmt::format("the beam of port '{}' has {:.4g} W, and the interferometer {:.4g} W in each arm", p.name,
                      p.power, arm_power),
          "make them agree, add 'arm_power' here, or say by 'at' of its port where the beam is; strain is computed "
          "with the power of the interferometer");
  for (TracedPort const& p : different(inside, &TracedPort::cavity_length, same_length))
    if (!agrees(p.cavity_length, arm_length, same_length))
      interferometer.warning(
          fmt::format("the cavity of port '{}' is {:.5g} m long, and the arms of the interferometer {:.5g} m", p.name,
                      p.cavity_length, arm_length),
          "make them agree, or say by 'at' of its port where the beam is; strain is computed with the length of the "
          "interferometer");
}

std::string describe(std::vector<PortEntry> const& entries, Interferometer const& ifo, Band const& band) {
  double const low = band.clamped(10), high = band.clamped(100);
  std::string text;
  std::vector<bool> listed;
  for (PortEntry const& e : entries) listed.push_back(!e.lit_by.empty() || e.both_sides);
  auto const between = std::ranges::count(listed, true);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (listed[i]) continue;
    PortEntry const& e = entries[i];
    std::vector<std::string> names;
    for (std::size_t j = i; j < entries.size(); ++j)
      if (entries[j].place() == e.place() && entries[j].field_share == e.field_share && entries[j].copies == e.copies) {
        names.push_back(entries[j].name);
        listed[j] = true;
      }
    PortId const port{std::uint32_t(i)};
    text += fmt::format("; {}: {}{}, {:g} {}, at {:.4g} and {:.4g} Hz h per Im s {} and {}, per Re s {} and {}",
                        fmt::join(names, ", "), e.place(),
                        e.field_share == 1 ? "" : fmt::format(" (field x {:.3g})", e.field_share), e.copies,
                        e.copies == 1 ? "copy" : "copies", low, high, number(ifo.strain_per_phase(port, low)),
                        number(ifo.strain_per_phase(port, high)), number(ifo.strain_per_amplitude(port, low)),
                        number(ifo.strain_per_amplitude(port, high)));
  }
  if (between > 0)
    text += fmt::format("; {} of light between beams ('straytrace ifo --show stray')", counted(between, "port"));
  return text;
}

std::unique_ptr<Interferometer> with_responses(std::unique_ptr<Interferometer> ifo, Node const& holder,
                                               std::vector<TracedPort> const& ports, Band const& band) {
  Node const table = holder.table("responses");
  if (!table) return ifo;
  std::map<std::uint32_t, Measured> measured;
  double const arm_length = ifo ? ifo->numbers().arm_length : not_a_number;
  for (auto const& [name, node] : table.items()) {
    auto const at = find(ports, name);
    Measured read = read_measured(node, name, arm_length, band);
    if (at == ports.end())
      unknown_port(node, name, ports);
    else
      measured[std::uint32_t(at - ports.begin())] = std::move(read);
  }
  return std::make_unique<MeasuredResponses>(std::move(ifo), std::move(measured), ports);
}

}  // namespace straytrace::ifo
