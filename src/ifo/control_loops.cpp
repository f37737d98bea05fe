// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/control_loops.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "ifo/layout/signals.hpp"

namespace straytrace::ifo {
namespace {

constexpr double close_to_unstable = 0.3;  // |1 + G|
constexpr double dark = 1e-24;             // of the largest power: no light

double largest_power(Network const& network, SteadyField const& field) {
  double most = 0;
  for (std::uint32_t p = 0; p < network.ports(); ++p) most = std::fmax(most, field.power_out(p));
  return most;
}

}  // namespace

Phasor to_freedom(LinearResponse const& r, NamedFreedom const& freedom) {
  Phasor sum = 0;
  for (auto const& [id, factor] : freedom.moves) sum += factor * r.to_displacement(id);
  return sum;
}

namespace {

ControlLoop read_loop(Node const& node, std::string const& length, NetworkModel const& model, Band const& band) {
  using Kind = ControlLoop::Kind;
  constexpr char const* example = "write {sensor: POP_I, open_loop: {gain: 100, poles: [1 Hz]}}, held or free";
  ControlLoop loop;
  if (node.kind() == Node::Kind::scalar && (node.text() == "held" || node.text() == "free")) {
    loop.kind = node.text() == "held" ? Kind::held : Kind::free;
    return loop;
  }
  if (node.kind() != Node::Kind::table) {
    node.problem(fmt::format("the loop of '{}' must be a table", length), example);
    return loop;
  }
  loop.kind = Kind::closed;
  std::string const sensor = node.word("sensor");
  if (NamedReadout const* r = model.readout(sensor)) {
    loop.sensor = *r;
    if (!r->is_power() && !r->is_demodulated())
      node["sensor"].problem(
          fmt::format("'{}' is a homodyne detector, and a length loop needs a power or a demodulated signal", sensor),
          "name a read-out of kind 'power' or 'demodulate'");
  } else if (!sensor.empty()) {
    std::vector<std::string> names;
    for (NamedReadout const& other : model.readouts) names.push_back(other.name);
    node["sensor"].problem(fmt::format("the network has no read-out '{}'", sensor),
                           did_you_mean(sensor, names, "add it to 'readouts' of the 'network'"));
  }
  if (Node const gain = node["open_loop"])
    loop.open_loop = read_transfer_function(gain, band);
  else
    node.lack("open_loop", fmt::format("the loop of '{}' has no 'open_loop'", length), example);
  if (Node const filter = node["feedforward"])
    loop.feedforward = filter.kind() == Node::Kind::table
                           ? read_transfer_function(filter, band)
                           : TransferFunction({}, {}, filter.as_number(dim::plain, 0, 2));
  node.refuse_unknown("a control loop");
  return loop;
}

bool same_beam_of(Readout const& a, Readout const& b) {
  return a.port == b.port && a.leaving == b.leaving && a.angle == b.angle && a.hz == b.hz;
}

}  // namespace

void read_control_loops(Node const& interferometer, NetworkModel& model, Band const& band) {
  std::vector<std::string> names;
  for (ControlledLength const& c : model.controlled) names.push_back(c.freedom.name);
  for (auto const& [name, node] : interferometer.table("loops").items()) {
    if (name == "override") continue;
    auto const at = std::ranges::find(names, name);
    if (at != names.end()) {
      model.controlled[std::size_t(at - names.begin())].loop = read_loop(node, name, model, band);
      continue;
    }
    if (node.kind() == Node::Kind::table)
      for (char const* key : {"sensor", "open_loop", "feedforward"}) (void)node.has(key);
    node.problem(fmt::format("no loop controls '{}'", name),
                 name == model.strain->freedom.name
                     ? fmt::format("remove it: the loop of {} cancels in h", name)
                     : did_you_mean(name, names, fmt::format("it is one of: {}", fmt::join(names, ", "))));
  }
}

namespace {

std::optional<SubtractedChannel> read_subtracted(Node const& node, NetworkModel const& model, Band const& band) {
  if (node.kind() != Node::Kind::table) {
    node.problem("a subtracted channel must be a table", "write {channel: POP_I, filter: best}");
    return {};
  }
  SubtractedChannel s;
  std::string const name = node.word("channel");
  Node const filter = node["filter"];
  if (!filter)
    node.lack("filter", "the subtraction has no 'filter'", "write 'filter: best', or a transfer function");
  else if (filter.kind() == Node::Kind::table)
    s.filter = read_transfer_function(filter, band);
  else if (filter.text() != "best")
    filter.problem(fmt::format("a filter cannot be '{}'", filter.text()),
                   "write 'best', or a transfer function {gain: 2, poles: [1 Hz]} in units of the read-out of strain "
                   "per unit of the channel");
  node.refuse_unknown("a subtracted channel");
  NamedReadout const* const channel = model.readout(name);
  if (!channel) {
    std::vector<std::string> names;
    for (NamedReadout const& other : model.readouts) names.push_back(other.name);
    if (!name.empty())
      node["channel"].problem(fmt::format("the network has no read-out '{}'", name),
                              did_you_mean(name, names, "add it to 'readouts' of the 'network'"));
    return {};
  }
  s.channel = *channel;
  return s;
}

}  // namespace

void read_subtracted_channels(Node const& interferometer, NetworkModel& model, Band const& band) {
  for (Node const& node : interferometer.has("subtract") ? interferometer.list("subtract") : std::vector<Node>{}) {
    auto read = read_subtracted(node, model, band);
    if (!read) continue;
    std::string const& name = read->channel.name;
    if (std::ranges::any_of(model.subtracted, [&](auto const& s) { return s.channel.name == name; }))
      node.problem(fmt::format("'{}' is subtracted twice", name), "remove one of them");
    else if (read->channel.readout.kind == model.strain->readout.kind &&
             same_beam_of(read->channel.readout, model.strain->readout))
      node["channel"].problem(fmt::format("'{}' is the read-out of strain itself", name), "name another channel");
    if (!read->filter && model.noises.empty())
      node["filter"].problem("the best filter is that of the stated noises, and the network states none",
                             "add 'noises' to the network, or write a transfer function");
    for (NamedNoise const& n : model.noises)
      if (!read->filter && (std::isnan(n.asd(band.low)) || std::isnan(n.asd(band.high))))
        node["filter"].problem(
            fmt::format("the noise of '{}' is not known from {:g} to {:g} Hz", n.cause.name, band.low, band.high),
            "give a file that covers the band");
    model.subtracted.push_back(*std::move(read));
  }
}

namespace {

// "A, B and C"
std::string listed(std::vector<std::string> const& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " and ") + names[i];
  return text;
}

}  // namespace

std::string describe(NetworkModel const& model) {
  std::vector<std::string> held, others, subtracted;
  for (SubtractedChannel const& s : model.subtracted) subtracted.push_back(s.channel.name);
  for (ControlledLength const& c : model.controlled) {
    if (c.loop.kind == ControlLoop::Kind::held)
      held.push_back(c.freedom.name);
    else if (c.loop.kind == ControlLoop::Kind::free)
      others.push_back(c.freedom.name + " free");
    else
      others.push_back(fmt::format("{} controlled by {}", c.freedom.name, c.loop.sensor.name));
  }
  if (!held.empty()) others.insert(others.begin(), listed(held) + " held");
  return fmt::format("{}{}", fmt::join(others, ", "),
                     subtracted.empty() ? "" : ", " + listed(subtracted) + " subtracted");
}

namespace {

// The band, with all corner frequencies well inside it and up to where the gain is small, as far as the function is
// known.
Band around_corners(TransferFunction const& open_loop, Band band) {
  constexpr double beyond = 1000, small = 0.03, highest = 1e9;  // Hz
  for (double const hz : open_loop.features())
    if (hz > 0) band = {std::fmin(band.low, hz / beyond), std::fmax(band.high, hz * beyond)};
  Band const known = open_loop.range();
  while (band.high < std::fmin(known.high, highest) && std::abs(open_loop(band.high)) > small) band.high *= 10;
  return {std::fmax(band.low, known.low), std::fmin(band.high, known.high)};
}

// How far 1 + G of a stable loop of positive gain turns from the low to the high end of the band, rad: n integrators
// begin at n pi/2 and end at 0. One that is unstable differs by pi, half of what both signs of the frequency turn.
double turn_of_stable(TransferFunction const& open_loop, Band const& band) {
  double const next = std::fmin(1.1 * band.low, band.high);
  Phasor const low = open_loop(band.low), above = open_loop(next);
  if (!(std::abs(low) > 1)) return 0;
  double const slope = std::log(std::abs(low) / std::abs(above)) / std::log(next / band.low);
  return -std::max(0.0, std::round(slope)) * pi / 2;
}

}  // namespace

LoopMargins loop_margins(TransferFunction const& open_loop, Band const& noise_band) {
  constexpr int points = 4000;
  Band const band = around_corners(open_loop, noise_band);
  LoopMargins m;
  double turned = 0, last = band.low;
  Phasor before = open_loop(last);
  for (int i = 0; i <= points; ++i) {
    double const hz = i == points ? band.high : band.low * std::pow(band.high / band.low, double(i) / points);
    Phasor const g = open_loop(hz);
    if (std::abs(1.0 + g) < m.least) m.least = std::abs(1.0 + g), m.least_at = hz;
    turned += std::arg((1.0 + g) / (1.0 + before));
    if ((std::abs(g) < 1) != (std::abs(before) < 1)) {
      double const share = std::log(std::abs(before)) / std::log(std::abs(before / g));
      m.unity_gain = last * std::pow(hz / last, share);
      m.phase_margin = std::remainder(pi - std::arg(open_loop(m.unity_gain)), 2 * pi);  // a lag has a positive phase
    }
    before = g;
    last = hz;
  }
  m.encircles = std::fabs(turned - turn_of_stable(open_loop, band)) > 0.75 * pi;
  return m;
}

bool sees(Network const& network, SteadyField const& field, Readout const& r, NamedFreedom const& freedom, double hz) {
  constexpr double blind = 1e-9;
  bool const power = r.kind == Readout::Kind::power, homodyne = r.kind == Readout::Kind::homodyne;
  double const light = homodyne ? 0 : power_of_beam(r, field);
  if (!homodyne && !(light > dark * largest_power(network, field))) return false;
  SmallSignals const signals(network, field, hz);
  auto const size = [&](double turn) {
    Readout turned = r;
    turned.angle += turn;
    return std::abs(to_freedom(LinearResponse(signals, turned), freedom));
  };
  // A response is compared with that in the other quadrature and, of a power, with what all its light could give.
  return size(0) > blind * std::fmax(light * network.wavenumber(), power ? 0 : size(pi / 2));
}

void check_control_loops(Node const& interferometer, NetworkModel const& model, SteadyField const& field,
                         Band const& band) {
  for (ControlledLength const& c : model.controlled) {
    ControlLoop const& loop = c.loop;
    if (loop.kind != ControlLoop::Kind::closed) continue;
    std::string const& name = c.freedom.name;
    Node const node = interferometer["loops"][name];
    if (!sees(model.network, field, loop.sensor.readout, c.freedom, std::sqrt(band.low * band.high))) {
      node["sensor"].problem(fmt::format("'{}' does not respond to {}", loop.sensor.name, name),
                             fmt::format("name another read-out, or write 'phase: best({})'", name));
      continue;
    }
    LoopMargins const m = loop_margins(loop.open_loop, band);
    if (m.encircles)
      node.warning(fmt::format("the open-loop gain of {} goes around -1: the closed loop is unstable", name),
                   "check its sign and phase; a gain of a loop that is closed in practice suppresses by 1/(1 + G)");
    else if (m.least < close_to_unstable)
      node.warning(
          fmt::format("|1 + G| of {} is {:.2g} at {:.4g} Hz: the loop amplifies there", name, m.least, m.least_at),
          "check gain and phase of 'open_loop'");
  }
}

namespace {

LoopRow row_of(NetworkModel const& model, CalibratedStrain const& r, std::size_t i, double hz, Band const& band) {
  ControlledLength const& c = model.controlled[i];
  LoopRow row{.length = c.freedom.name};
  if (c.loop.kind != ControlLoop::Kind::closed) {
    row.sensor = c.loop.kind == ControlLoop::Kind::held ? "held" : "free";
    return row;
  }
  row.sensor = c.loop.sensor.name;
  row.plant = std::conj(to_freedom(LinearResponse(r.signals(), c.loop.sensor.readout), c.freedom));
  row.open_loop = std::conj(c.loop.open_loop(hz));
  row.suppressed = suppression(row.open_loop);
  row.noise_to_strain = std::conj(r.to_sensor_noise(i) / r.calibration());
  row.margins = loop_margins(c.loop.open_loop, band);
  return row;
}

StrayByLoop by_loop(NetworkModel const& model, SteadyField const& field, CalibratedStrain const& r, NamedWay const& w,
                    double hz, bool phase) {
  auto const parts = r.parts([&](LinearResponse const& x) {
    StrayResponse const s = stray_response(x, model.network, field, w.way, hz);
    return phase ? s.phase() : s.amplitude();
  });
  Phasor const per_field = w.share / r.calibration();
  StrayByLoop s{.entrance = w.name, .phase = phase, .held = std::conj(parts.held * per_field)};
  s.total = s.held;
  for (std::size_t i = 0; i < parts.by_length.size(); ++i) {
    if (model.controlled[i].loop.kind == ControlLoop::Kind::held) continue;
    s.by_length.push_back(std::conj(parts.by_length[i] * per_field));
    s.total += s.by_length.back();
  }
  return s;
}

std::vector<NoiseByLoop> noises_by_loop(NetworkModel const& model, CalibratedStrain const& r, double hz) {
  std::vector<CalibratedStrain::Sum> const parts = r.part_sums();
  CalibratedStrain::Sum const whole = r.whole();
  double const per_strain = 1 / std::abs(r.calibration());
  auto const row = [&](std::string name, auto const& asd) {
    NoiseByLoop n{std::move(name), per_strain * asd(parts[0])};
    for (std::size_t i = 0; i < model.controlled.size(); ++i)
      if (model.controlled[i].loop.kind != ControlLoop::Kind::held)
        n.by_length.push_back(per_strain * asd(parts[i + 1]));
    n.total = per_strain * asd(whole);
    return n;
  };
  using Sum = CalibratedStrain::Sum;
  std::vector<NoiseByLoop> all{
      row("vacuum", [&](Sum const& s) { return std::sqrt(std::fmax(0, std::real(r.vacuum(s, s)))); })};
  for (NamedNoise const& n : model.noises)
    all.push_back(row(n.cause.name, [&](Sum const& s) {
      return std::abs(response_to(s.response, model.network, n.cause, hz)) * n.asd(hz);
    }));
  return all;
}

}  // namespace

std::vector<LoopCurve> loop_curves(NetworkModel const& model, std::vector<double> const& hz) {
  std::vector<LoopCurve> curves;
  for (ControlledLength const& c : model.controlled) {
    if (c.loop.kind != ControlLoop::Kind::closed) continue;
    LoopCurve& curve = curves.emplace_back(LoopCurve{c.freedom.name});
    Band const known = c.loop.open_loop.range();
    for (double const f : hz) {
      bool const inside = f >= known.low && f <= known.high;
      curve.open_loop.push_back(inside ? std::conj(c.loop.open_loop(f)) : not_a_number);
      curve.suppressed.push_back(inside ? suppression(curve.open_loop.back()) : not_a_number);
    }
  }
  return curves;
}

StrainNoise strain_noise(NetworkModel const& model, std::vector<double> const& hz) {
  SteadyField const field(model.network);
  NetworkModel read = model;
  read.subtracted.clear();
  StrainNoise noise{.hz = hz, .names = {"vacuum"}};
  for (NamedNoise const& n : model.noises) noise.names.push_back(n.cause.name);
  noise.asd.resize(noise.names.size());
  auto const asd = [](CalibratedStrain const& r) {
    CalibratedStrain::Sum const whole = r.whole();
    return std::sqrt(std::real(r.spectrum(whole, whole))) / std::abs(r.calibration());
  };
  for (double const f : hz) {
    CalibratedStrain const strain(model, field, f);
    CalibratedStrain::Sum const whole = strain.whole();
    double const per_strain = 1 / std::abs(strain.calibration());
    noise.asd[0].push_back(per_strain * std::sqrt(std::real(strain.vacuum(whole, whole))));
    for (std::size_t i = 0; i < model.noises.size(); ++i)
      noise.asd[i + 1].push_back(per_strain * model.noises[i].asd(f) *
                                 std::abs(response_to(whole.response, model.network, model.noises[i].cause, f)));
    noise.total.push_back(asd(strain));
    if (!model.subtracted.empty()) noise.as_read.push_back(asd(CalibratedStrain(read, field, f)));
  }
  return noise;
}

LoopTable loop_table(NetworkModel const& model, double hz, Band const& band) {
  SteadyField const field(model.network);
  CalibratedStrain const r(model, field, hz);
  LoopTable table{.hz = hz};
  for (std::size_t i = 0; i < model.controlled.size(); ++i) {
    table.loops.push_back(row_of(model, r, i, hz, band));
    if (table.loops.back().sensor != "held") table.lengths.push_back(table.loops.back().length);
  }
  table.noise = noises_by_loop(model, r, hz);
  for (std::size_t i = 0; i < model.subtracted.size(); ++i)
    table.subtracted.push_back(
        {model.subtracted[i].channel.name, !model.subtracted[i].filter, std::conj(r.filters()[Eigen::Index(i)])});
  double const least = dark * largest_power(model.network, field);
  for (NamedWay const& w : model.entrances)
    for (bool const phase : {true, false})
      if (lighting_power(w.way, field) > least) table.stray.push_back(by_loop(model, field, r, w, hz, phase));
  return table;
}

}  // namespace straytrace::ifo
