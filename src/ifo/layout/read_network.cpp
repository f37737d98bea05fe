// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/layout/read_network.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "ifo/layout/drawn_optics.hpp"
#include "ifo/layout/signals.hpp"

namespace straytrace::ifo {
namespace {

using Component = Network::Component;
using Kind = Component::Kind;

constexpr std::array<std::string_view, 8> kinds = {"mirror",   "splitter",  "laser", "dump",
                                                   "isolator", "modulator", "lens",  "aperture"};
constexpr std::size_t most_carriers = 400;

bool is_name(std::string const& name) {
  return !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
    return (c < 128 && std::isalnum(c) != 0) || c == '_' || c == '-';
  });
}

// Two numbers of one kind; zeros where there are none.
std::array<double, 2> read_pair(Node const& t, char const* key, Dimension dimension, double most) {
  if (!t.has(key)) return {};
  std::vector<double> const both = t[key].as_numbers(dimension, 2);
  if (both.size() != 2) return {};
  for (double const v : both)
    if (std::fabs(v) > most)
      t[key].problem(fmt::format("{:g} is out of range", v), fmt::format("keep it within {:g} in SI units", most));
  if (std::isnan(both[0]) || std::isnan(both[1])) return {};
  return {both[0], both[1]};
}

struct Curvature {
  double along = 0;
  std::optional<double> across{};
};

// One number, or a list: in the plane of incidence, and across it.
Curvature read_curvature(Node const& t) {
  Node const node = t["curvature"];
  if (node.kind() != Node::Kind::list) return {t.number("curvature", dim::per_metre, 0, -1e3, 1e3), {}};
  if (std::size_t const count = node.as_list().size(); count != 2) {
    node.problem(fmt::format("'curvature' is one number or two, got {}", count),
                 "write '1/(1420 m)', or in the plane of incidence and across it: '[1/(1420 m), 1/(1400 m)]'");
    return {};
  }
  auto const both = read_pair(t, "curvature", dim::per_metre, 1e3);
  return {both[0], both[1]};
}

MirrorParameters read_mirror(Node const& t, double wavelength, bool splitter) {
  MirrorParameters p;
  p.transmission = t.number("transmission", dim::plain, required, 0, 1);
  p.loss = t.number("loss", dim::plain, 0, 0, 1);
  double const tuning = t.number("tuning", dim::angle, 0, -1e6, 1e6);
  p.displacement = tuning / (2 * pi) * wavelength + t.number("displacement", dim::length, 0, -1e-3, 1e-3);
  bool const drawn = t.has("optic");  // then the scene shows incidence and curvature
  if (splitter) p.incidence = t.number("incidence", dim::angle, drawn ? 0 : required, 0, 89.9 * pi / 180);
  Curvature const curvature = read_curvature(t);
  p.curvature = curvature.along;
  p.curvature_across = curvature.across;
  p.tilt = read_pair(t, "tilt", dim::angle, 0.1);
  p.suspension.mass = t.number("mass", dim::mass, infinity, 1e-9, 1e12);
  p.suspension.resonance = t.number("pendulum_frequency", dim::frequency, 0, 0, 1e3);
  if (p.transmission + p.loss > 1 + 1e-12)
    t.problem(fmt::format("a transmission of {:g} and a loss of {:g} are more than all light", p.transmission, p.loss),
              "make them at most 1 together");
  t.refuse_unknown(splitter ? "a splitter of a network" : "a mirror of a network");
  if (std::isnan(p.transmission) || !(p.transmission + p.loss <= 1)) p.transmission = p.loss = 0;
  return p;
}

ModulatorParameters read_modulator(Node const& t) {
  constexpr std::array<std::string_view, 2> of = {"all", "carrier"}, kind = {"phase", "amplitude"};
  ModulatorParameters p;
  p.hz = t.number("frequency", dim::frequency, required, 1, 1e12);
  p.index = t.number("index", dim::plain, required, -10, 10);
  p.order = int(t.whole("order", 1, 1, 20));
  p.phase = t.number("phase", dim::angle, 0, -1e3, 1e3);
  p.of = t.choice("of", of, of[0]) == "carrier" ? ModulatorParameters::Of::carrier : ModulatorParameters::Of::all;
  bool const amplitude = t.choice("kind", kind, kind[0]) == "amplitude";
  p.kind = amplitude ? ModulatorParameters::Kind::amplitude : ModulatorParameters::Kind::phase;
  if (amplitude && p.order != 1)
    t["order"].problem("an amplitude modulator makes sidebands of the first order only", "remove 'order'");
  t.refuse_unknown("a modulator of a network");
  if (!(p.hz > 0)) p.hz = 1;
  return p;
}

std::optional<LaserMode> read_laser_mode(Node const& laser) {
  if (!laser.has("mode")) return {};
  Node const t = laser.table("mode");
  if (!t) return {};
  LaserMode const mode{t.number("radius", dim::length, required, 1e-9, 1e3),
                       t.number("wavefront_curvature", dim::per_metre, 0, -1e3, 1e3)};
  t.refuse_unknown("the mode of a laser");
  if (!(mode.radius > 0)) return {};
  return mode;
}

Component read_kind(std::string const& name, Node const& t, Kind kind, double wavelength) {
  switch (kind) {
    case Kind::mirror:
      return Network::mirror(name, read_mirror(t, wavelength, false));
    case Kind::splitter:
      return Network::splitter(name, read_mirror(t, wavelength, true));
    case Kind::modulator:
      return Network::modulator(name, read_modulator(t));
    case Kind::laser: {
      LaserParameters const p{t.number("power", dim::power, required, 0, 1e30),
                              t.number("phase", dim::angle, 0, -1e3, 1e3), read_laser_mode(t)};
      t.refuse_unknown("a laser of a network");
      return Network::laser(name, p);
    }
    case Kind::isolator: {
      IsolatorParameters const p{t.number("isolation", dim::plain, required, 0, 1),
                                 t.number("transmission", dim::plain, 1, 0, 1)};
      t.refuse_unknown("an isolator of a network");
      return Network::isolator(name, p);
    }
    case Kind::lens: {
      LensParameters const p{t.number("focal_length", dim::length, required, -1e12, 1e12)};
      if (std::fabs(p.focal_length) < 1e-6)
        t["focal_length"].problem("a lens cannot focus within 1 um", "write its focal length, for example 500 mm");
      t.refuse_unknown("a lens of a network");
      return Network::lens(name, p);
    }
    case Kind::aperture: {
      ApertureParameters const p{t.number("radius", dim::length, required, 1e-9, 1e3),
                                 read_pair(t, "offset", dim::length, 1e3)};
      t.refuse_unknown("an aperture of a network");
      return Network::aperture(name, p);
    }
    case Kind::dump:
      t.refuse_unknown("a dump of a network");
      return Network::dump(name);
  }
  return {};
}

std::optional<Component> read_component(std::string const& name, Node const& node, double wavelength) {
  if (!is_name(name)) {
    node.problem(fmt::format("'{}' is not a name of a component", name), "use letters, digits, '_' and '-'");
    return {};
  }
  if (node.kind() != Node::Kind::table) {
    node.problem(fmt::format("component '{}' must be a table", name), "write {mirror: {transmission: 5 %}}");
    return {};
  }
  std::vector<std::size_t> given;
  for (std::size_t k = 0; k < kinds.size(); ++k)
    if (node.has(kinds[k])) given.push_back(k);
  node.refuse_unknown(fmt::format("component '{}'", name));
  if (given.size() != 1) {
    node.problem(fmt::format("component '{}' has {} kinds", name, given.size()),
                 fmt::format("give it one of: {}", fmt::join(kinds, ", ")));
    return {};
  }
  Node const t = node.table(kinds[given[0]]);
  if (!t) return {};
  return read_kind(name, t, Kind(given[0]), wavelength);
}

// {mirror: {curvature: ..., tilt: ..., optic: ...}} of a mirror or splitter of the preset, which keeps all else.
std::optional<NetworkChanges::Shape> read_shape(std::string const& name, Node const& node, Network const& base) {
  auto const id = base.search(name);
  if (!id || !base.at(*id).interface() || node.kind() != Node::Kind::table) return {};
  std::string_view const kind = kinds[std::size_t(base.at(*id).kind)];
  if (node.items().size() != 1 || !node.has(kind)) return {};
  Node const t = node.table(kind);
  bool const alone = std::ranges::all_of(t.items(), [](auto const& item) {
    return item.first == "curvature" || item.first == "tilt" || item.first == "optic";
  });
  if (!alone || t.items().empty()) return {};
  NetworkChanges::Shape shape{name};
  if (t.has("curvature")) {
    Curvature const curvature = read_curvature(t);
    shape.curvature = curvature.along;
    shape.curvature_across = curvature.across;
  }
  if (t.has("tilt")) shape.tilt = read_pair(t, "tilt", dim::angle, 0.1);
  return shape;
}

// The table of a mirror or splitter.
Node mirror_of(Node const& component) {
  for (Kind const kind : {Kind::mirror, Kind::splitter})
    if (component.has(kinds[std::size_t(kind)])) return component.table(kinds[std::size_t(kind)]);
  return {};
}

void read_components(Node const& table, Network const& base, OpticReader& optics, NetworkChanges& into) {
  for (auto const& [name, node] : table.items()) {
    if (name == "override") continue;
    if (auto shape = read_shape(name, node, base)) {
      optics.read(name, mirror_of(node));
      into.shapes.push_back(std::move(*shape));
      continue;
    }
    auto component = read_component(name, node, base.wavelength());
    if (!component) continue;
    if (auto const id = base.search(name); id && base.at(*id).kind != component->kind) {
      node.problem(fmt::format("'{}' of the preset is a {}, which a {} cannot replace", name,
                               kinds[std::size_t(base.at(*id).kind)], kinds[std::size_t(component->kind)]),
                   "choose another name");
      continue;
    }
    if (component->interface()) optics.read(name, mirror_of(node));
    into.components.push_back(std::move(*component));
  }
}

// The port that a key names; a problem and nothing where there is none.
std::optional<std::uint32_t> read_port(Node const& table, char const* key, Network const& network) {
  std::string const name = table.word(key);
  if (name.empty()) return {};
  auto const port = find_port(network, name);
  if (!port) {
    auto const id = network.search(name.substr(0, name.find('.')));
    std::vector<std::string> near = port_names(network);
    if (id) std::erase_if(near, [&](std::string const& p) { return !p.starts_with(network.name(*id) + "."); });
    std::string const ports = fmt::format("its ports: {}", fmt::join(near, ", "));
    table[key].problem(fmt::format("the network has no port '{}'", name),
                       id ? ports : did_you_mean(name, near, "name a component and its port: PRM.front, BS.1"));
  }
  return port;
}

// m; `origin`: where it comes from, when the scene shows it.
double read_length(Node const& space, OpticReader const& optics, std::string& origin) {
  std::string const from = space["from"].text(), to = space["to"].text();
  bool const of_scene = space.has("length") ? space["length"].text() == "scene" : optics.both_drawn(from, to);
  if (!of_scene) return space.number("length", dim::length, required, 0, 1e12);
  auto const drawn = optics.distance(space, from, to);
  if (drawn) origin = "as drawn";
  return drawn.value_or(0);
}

void read_spaces(Node const& table, Network const& network, OpticReader const& optics, NetworkChanges& into) {
  std::map<std::uint32_t, std::size_t> used;
  for (Node const& node : table.list("spaces")) {
    if (node.kind() != Node::Kind::table) {
      node.problem("a space must be a table", "write {from: PRM.back, to: ITM.front, length: 3 km}");
      continue;
    }
    auto const from = read_port(node, "from", network), to = read_port(node, "to", network);
    std::string origin;
    double const length = read_length(node, optics, origin);
    NetworkChanges::Space const s{node.word("from"), node.word("to"), length,
                                  node.number("phase", dim::angle, 0, -1e6, 1e6), origin};
    node.refuse_unknown("a space of a network");
    if (!from || !to) continue;
    bool fits = *from != *to;
    if (!fits) node["to"].problem("a space leads from a port to itself", "name another port");
    for (auto const& [port, key] : {std::pair{*from, "from"}, std::pair{*to, "to"}}) {
      auto const [at, first] = used.emplace(port, into.spaces.size());
      if (first || !fits) continue;
      node[key].problem(fmt::format("two spaces are at '{}'", network.port_name(port)),
                        fmt::format("the other leads from '{}' to '{}': remove one of them",
                                    into.spaces[at->second].from, into.spaces[at->second].to));
      fits = false;
    }
    if (fits) into.spaces.push_back(s);
  }
}

// Ports of the preset whose space the scene took away.
void warn_of_loose_ends(Node const& table, Network const& base, Network const& changed) {
  auto const linked = [](Network const& n, std::uint32_t port) {
    return std::ranges::any_of(n.spaces(), [&](auto const& s) { return s.from == port || s.to == port; });
  };
  for (std::uint32_t p = 0; p < base.ports(); ++p)
    if (linked(base, p) && !linked(changed, p))
      table.warning(fmt::format("the space of the preset at '{}' is gone, and light is lost there", base.port_name(p)),
                    fmt::format("add a space to '{}'", base.port_name(p)));
}

// Hz of a demodulation: a modulator, or a frequency.
double read_demodulation_frequency(Node const& table, Network const& network) {
  Node const node = table["frequency"];
  if (!node) {
    table.lack("frequency", "'frequency' of the demodulation is missing", "name a modulator, or write 6.27 MHz");
    return not_a_number;
  }
  if (auto const id = network.search(node.text()); id && network.at(*id).kind == Kind::modulator)
    return network.at(*id).modulation;
  double const hz = node.as_number(dim::frequency, 1, 1e12);
  if (std::isnan(hz)) return hz;
  std::vector<double> const carriers = network.carriers();
  bool const beats = std::ranges::any_of(carriers, [&](double a) {
    return std::ranges::any_of(carriers, [&](double b) { return std::fabs(b - a - hz) < 1e-3; });
  });
  if (beats) return hz;
  node.problem(fmt::format("no two carriers are {:g} Hz apart: no modulator makes such sidebands", hz),
               "name a modulator of the network, or add one of this frequency");
  return not_a_number;
}

struct BestPhase {
  Node node;
  std::string readout, freedom;
};

// Reader of the read-outs. Phases `best(FREEDOM)` wait until the degrees of freedom are known.
class QuestionReader {
 public:
  QuestionReader(Node const& table, NetworkModel& model) : table_(table), model_(model) {}
  void read() {
    for (auto const& [name, node] : table_.table("freedoms").items()) read_freedom(name, node);
    for (auto const& [name, node] : table_.table("readouts").items()) read_readout(name, node);
    for (auto const& [name, node] : table_.table("noises").items()) read_noise(name, node);
    if (!table_.healthy()) return;
    SteadyField const field(model_.network);
    for (BestPhase const& b : best_) turn_to_best(b, field);
  }

 private:
  void read_freedom(std::string const& name, Node const& node) {
    if (name == "override") return;
    NamedFreedom freedom{name};
    if (node.kind() != Node::Kind::table || node.items().empty())
      return node.problem(fmt::format("degree of freedom '{}' must name what moves", name), "write {ETM: 1}");
    for (auto const& [component, factor] : node.items()) {
      auto const id = model_.network.search(component);
      double const value = factor.as_number(dim::plain, -1e6, 1e6);
      if (id && model_.network.at(*id).interface())
        freedom.moves.emplace_back(*id, value);
      else
        factor.problem(fmt::format("the network has no mirror or splitter '{}'", component),
                       did_you_mean(component, movable(), "name a mirror or splitter of 'components'"));
    }
    if (std::ranges::all_of(freedom.moves, [](auto const& move) { return move.second == 0; }) && node.healthy())
      node.problem(fmt::format("nothing moves with '{}': all factors are 0", name), "write {ETM: 1}");
    std::erase_if(model_.freedoms, [&](NamedFreedom const& f) { return f.name == name; });
    model_.freedoms.push_back(std::move(freedom));
  }

  void read_noise(std::string const& name, Node const& node) {
    if (name == "override") return;
    auto const cause = find_cause(model_, name);
    if (!cause)
      node.problem(fmt::format("the network has no cause '{}'", name),
                   did_you_mean(name, cause_names(model_),
                                fmt::format("it is one of: {}", fmt::join(cause_names(model_), ", "))));
    if (node.kind() != Node::Kind::table)
      return node.problem(fmt::format("the noise of '{}' must be a table", name),
                          "write {asd: 1e-9 /sqrt(Hz), at: 100 Hz, exponent: -1}, or {file: FILE, columns: [...]}");
    NamedNoise noise{cause.value_or(NetworkCause{name})};
    Dimension const density = noise.cause.density();
    if (node.has("file")) {
      read_curve(node, density, noise);
    } else {
      noise.level = node.number("asd", density, required, 0);
      noise.at = node.number("at", dim::frequency, 100, 1e-9, 1e12);
      noise.exponent = node.number("exponent", dim::plain, 0, -20, 20);
    }
    node.refuse_unknown("a noise of a network");
    std::erase_if(model_.noises, [&](NamedNoise const& n) { return n.cause.name == name; });
    model_.noises.push_back(std::move(noise));
  }

  static void read_curve(Node const& node, Dimension density, NamedNoise& noise) {
    noise.file = node["file"].text();
    std::vector<Node> const columns = node.list("columns");
    auto const unit = columns.size() == 2 ? parse_unit(columns[1].text()) : std::nullopt;
    if (columns.size() != 2 || columns[0].text() != "Hz" || !unit || unit->dimension != density)
      (node.has("columns") ? node["columns"] : node)
          .problem("name the two columns of the file",
                   fmt::format("write 'columns: [Hz, {}]'", noise.cause.density_unit()));
    if (!unit) return;
    noise.curve = read_two_columns(
        node["file"], "write two columns: frequency in Hz and the amplitude spectral density, sorted by frequency");
    for (double& v : noise.curve.value) v *= unit->si;
  }

  std::vector<std::string> movable() const {
    std::vector<std::string> names;
    for (Component const& c : model_.network.components())
      if (c.interface()) names.push_back(c.name);
    return names;
  }

  void read_readout(std::string const& name, Node const& node) {
    if (name == "override") return;
    if (node.kind() != Node::Kind::table)
      return node.problem(fmt::format("read-out '{}' must be a table", name), "write {power: PRM.front.out}");
    int const given = node.has("power") + node.has("demodulate") + node.has("homodyne");
    if (given != 1) {
      node.refuse_unknown(fmt::format("read-out '{}'", name));
      return node.problem(fmt::format("read-out '{}' has {} kinds", name, given),
                          "give it one of: power, demodulate, homodyne");
    }
    std::erase_if(model_.readouts, [&](NamedReadout const& r) { return r.name == name; });
    NamedReadout readout{name};
    if (node.has("power")) {
      if (auto const beam = read_beam(node["power"], model_.network))
        readout.readout = at(Readout::power(beam->port), *beam);
    } else if (Node const t = node.table("demodulate")) {
      readout.readout = read_demodulation(t, name);
    } else if (Node const h = node.table("homodyne")) {
      readout.readout = read_homodyne(h);
    }
    node.refuse_unknown(fmt::format("read-out '{}'", name));
    model_.readouts.push_back(std::move(readout));
  }

  static Readout at(Readout r, NetworkBeam const& beam) {
    r.leaving = beam.leaving;
    return r;
  }
  std::optional<NetworkBeam> beam_at(Node const& t, char const* key) const {
    if (t.has(key)) return read_beam(t[key], model_.network);
    t.lack(key, fmt::format("'{}' is missing", key), "name a beam: PRM.front.out");
    return {};
  }

  Readout read_demodulation(Node const& t, std::string const& name) {
    auto const beam = beam_at(t, "at");
    double const hz = read_demodulation_frequency(t, model_.network);
    double phase = 0;
    std::string const word = t["phase"].text();
    if (word.starts_with("best(") && word.ends_with(")"))
      best_.push_back({t["phase"], name, word.substr(5, word.size() - 6)});
    else
      phase = t.number("phase", dim::angle, 0, -1e3, 1e3);
    t.refuse_unknown("a demodulation");
    return beam ? at(Readout::demodulated(beam->port, hz, phase), *beam) : Readout{};
  }

  Readout read_homodyne(Node const& t) {
    auto const beam = beam_at(t, "at");
    double angle = t.number("angle", dim::angle, required, -1e3, 1e3);
    std::optional<NetworkBeam> const local = t.has("local") ? read_beam(t["local"], model_.network) : std::nullopt;
    t.refuse_unknown("a homodyne detector");
    if (local && t.healthy()) {
      SteadyField const f(model_.network);
      Phasor const e = local->leaving ? f.out(local->port, f.carrier(0)) : f.in(local->port, f.carrier(0));
      if (!(std::abs(e) > 1e-12 * largest(f)))
        t["local"].problem("no carrier light is there, so it has no phase", "name a beam with light");
      angle += std::arg(e);
    }
    return beam ? at(Readout::homodyne(beam->port, angle), *beam) : Readout{};
  }
  double largest(SteadyField const& f) const {
    double most = 0;
    for (std::uint32_t p = 0; p < model_.network.ports(); ++p) most = std::fmax(most, f.power_out(p));
    return std::sqrt(most);
  }

  // Eq. N.2.
  void turn_to_best(BestPhase const& b, SteadyField const& field) {
    NamedFreedom const* const freedom = model_.freedom(b.freedom);
    if (!freedom) {
      std::vector<std::string> names;
      for (NamedFreedom const& f : model_.freedoms) names.push_back(f.name);
      return b.node.problem(fmt::format("there is no degree of freedom '{}'", b.freedom),
                            did_you_mean(b.freedom, names, "add it to 'freedoms', or write an angle"));
    }
    Readout& r = std::ranges::find(model_.readouts, b.readout, &NamedReadout::name)->readout;
    double slopes[2];
    for (int q : {0, 1}) {
      r.angle = q * pi / 2;
      AdjointSlope const slope(model_.network, field, r);
      slopes[q] = 0;
      for (auto const& [id, factor] : freedom->moves) slopes[q] += factor * slope.to_displacement(id);
    }
    double const whole = value_of(at(Readout::power(r.port), {r.port, r.leaving}), field);
    if (!(std::hypot(slopes[0], slopes[1]) > 1e-9 * whole * model_.network.wavenumber()))
      return b.node.problem(fmt::format("'{}' has no effect on this signal", b.freedom),
                            "demodulate another beam or frequency, or write an angle");
    r.angle = std::atan2(slopes[1], slopes[0]);
  }

  Node const& table_;
  NetworkModel& model_;
  std::vector<BestPhase> best_;
};

double read_wavelength(Node const& network, double of_beams) {
  bool const known = !std::isnan(of_beams);
  double const stated = network.number("wavelength", dim::length, known ? of_beams : 1064e-9, 1e-9, 1e-3);
  if (known && std::fabs(stated / of_beams - 1) > 1e-12)
    network["wavelength"].problem(fmt::format("the beams of the scene have {:g} nm", of_beams * 1e9),
                                  "remove it here: the network takes the wavelength of the beams");
  return std::isnan(stated) ? 1064e-9 : stated;
}

// At most so many carriers that they can be solved for. With more, the modulators are left out: their carriers alone
// could fill the memory.
void limit_carriers(Node const& table, Network const& network, NetworkChanges& changes) {
  double count = 1;
  for (Component const& c : network.components()) {
    if (c.kind != Kind::modulator) continue;
    double const bands = double(c.bands.size());
    count = c.carrier_alone ? count + bands - 1 : count * bands;
  }
  constexpr double countable = 1e5;
  if (count < countable) count = double(network.carriers().size());
  if (!(count > most_carriers)) return;
  table["components"].problem(fmt::format("the modulators make {:g} carriers", count),
                              "reduce 'order', or write 'of: carrier'");
  for (Component& c : changes.components)
    if (c.kind == Kind::modulator) c = Network::modulator(c.name, {.index = 0, .hz = 1, .order = 0});
}

}  // namespace

std::optional<NetworkBeam> read_beam(Node const& node, Network const& network) {
  std::string const name = node.as_word();
  if (name.empty()) return {};
  auto const beam = find_beam(network, name);
  if (!beam) {
    std::vector<std::string> all;
    for (std::string const& p : port_names(network))
      for (char const* way : {".in", ".out"}) all.push_back(p + way);
    node.problem(fmt::format("the network has no beam '{}'", name),
                 did_you_mean(name, all,
                              "name a port and the way of its light: PRM.front.out leaves, PRM.front.in "
                              "enters"));
  }
  return beam;
}

namespace {

// Apertures and tilts that plane waves leave out.
void warn_of_plane_waves(Node const& table, NetworkChanges const& changes) {
  if (changes.modes) return;
  for (Component const& c : changes.components) {
    auto const* mirror = std::get_if<MirrorParameters>(&c.stated);
    bool const tilted = mirror && (mirror->tilt[0] != 0 || mirror->tilt[1] != 0);
    if (tilted || c.kind == Kind::aperture)
      table["components"][c.name].warning(
          fmt::format("plane waves leave out the {} of '{}'", tilted ? "tilt" : "aperture", c.name),
          "add 'modes: {order: 2}' to the network");
  }
}

}  // namespace

NetworkChanges read_network_changes(Node const& network, Network const& base, std::vector<DrawnOptic> const& optics) {
  NetworkChanges changes;
  OpticReader drawn(optics);
  read_components(network.table("components"), base, drawn, changes);
  Network changed = base;
  apply(changes, changed);
  read_spaces(network, changed, drawn, changes);
  changed = base;
  apply(changes, changed);
  drawn.finish(changes, changed);
  changed = base;
  apply(changes, changed);
  warn_of_loose_ends(network, base, changed);
  limit_carriers(network, changed, changes);
  changed = base;
  apply(changes, changed);
  changes.modes = read_modes(network, changed);
  warn_of_plane_waves(network, changes);
  return changes;
}

void read_network_questions(Node const& network, NetworkModel& model) { QuestionReader(network, model).read(); }

std::optional<NetworkModel> read_bare_network(Node const& interferometer, double wavelength,
                                              std::vector<DrawnOptic> const& optics) {
  Node const table = interferometer.table("network");
  if (!table) {
    if (!interferometer.has("network"))
      interferometer.lack("network", "'preset: none' needs a 'network'",
                          "add 'network: {components: ..., spaces: ...}'");
    return {};
  }
  constexpr std::array<std::string_view, 2> polarisations = {"s", "p"};
  double const used = read_wavelength(table, wavelength);
  bool const p = table.choice("polarisation", polarisations, "s") == "p";
  NetworkModel model{.preset = "none", .network = Network(used, p ? LinearPolarisation::p : LinearPolarisation::s)};
  apply(read_network_changes(table, model.network, optics), model.network);
  bool const light = std::ranges::any_of(model.network.components(), [](Component const& c) { return c.emits != 0.0; });
  if (!light && table.healthy())
    table.problem("no laser of the network emits light", "add 'laser: {laser: {power: 1 W}}' to 'components'");
  read_network_questions(table, model);
  table.refuse_unknown("a network");
  if (!table.healthy()) return {};
  return model;
}

}  // namespace straytrace::ifo
