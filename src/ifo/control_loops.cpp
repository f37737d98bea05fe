// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/control_loops.hpp"

#include <Eigen/LU>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace straytrace::ifo {
namespace {

constexpr double close_to_unstable = 0.3;  // |1 + G|
constexpr double dark = 1e-24;             // of the largest power: no light

Phasor along(LinearResponse const& r, NamedFreedom const& freedom) {
  Phasor sum = 0;
  for (auto const& [id, factor] : freedom.moves) sum += factor * r.to_displacement(id);
  return sum;
}

double largest_power(Network const& network, SteadyField const& field) {
  double most = 0;
  for (std::uint32_t p = 0; p < network.ports(); ++p) most = std::fmax(most, field.power_out(p));
  return most;
}

}  // namespace

Eigen::MatrixXcd CalibratedStrain::responses(std::vector<LinearResponse> const& readouts,
                                             std::vector<ControlledLength> const& controlled) const {
  auto const size = Eigen::Index(controlled.size());
  Eigen::MatrixXcd m(size, size);
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = 0; j < size; ++j)
      m(i, j) = along(readouts[std::size_t(i)], controlled[std::size_t(j)].freedom);
  return m;
}

// Actuators move by u, the loops sense y = R u + T s, and u = -C y, where C = G/R_pp of a closed loop. A held length
// has y = 0 with itself as sensor: the row R u = -T s without the term u.
CalibratedStrain::CalibratedStrain(Network const& network, SteadyField const& field, StrainScale const& scale,
                                   std::vector<ControlledLength> const& controlled, double hz)
    : network_(network), field_(field), scale_(scale), hz_(hz), read_(network, field, scale.readout, hz) {
  using Kind = ControlLoop::Kind;
  auto const size = Eigen::Index(controlled.size());
  seen_.resize(size);
  for (ControlledLength const& c : controlled) {
    seen_[Eigen::Index(lengths_.size())] = along(read_, c.freedom);
    lengths_.emplace_back(network, field, c.length, hz);
    bool const closed = c.loop.kind == Kind::closed;
    sensors_.push_back(closed ? LinearResponse(network, field, c.loop.sensor.readout, hz) : lengths_.back());
  }
  move_ = responses(lengths_, controlled);
  per_length_ = seen_;
  if (size > 0) per_length_ = seen_ * move_.inverse();
  Eigen::MatrixXcd equations = responses(sensors_, controlled), sensed = Eigen::MatrixXcd::Identity(size, size);
  kept_ = seen_;
  for (Eigen::Index i = 0; i < size; ++i) {
    ControlLoop const& loop = controlled[std::size_t(i)].loop;
    if (loop.kind == Kind::held) continue;
    Phasor const control = loop.kind == Kind::free ? 0.0 : loop.open_loop(hz) / equations(i, i);
    equations.row(i) *= control;
    equations(i, i) += 1.0;
    sensed(i, i) = control;
    kept_[i] *= 1.0 - loop.feedforward(hz);
  }
  actuate_ = equations;
  if (size > 0) actuate_ = equations.inverse() * sensed;
  weight_ = kept_ * actuate_;
  per_metre_ = to([&](LinearResponse const& r) { return along(r, scale_.freedom); });
}

Phasor CalibratedStrain::to(Cause const& cause) const {
  Phasor sum = cause(read_);
  for (std::size_t i = 0; i < sensors_.size(); ++i) sum -= weight_[Eigen::Index(i)] * cause(sensors_[i]);
  return sum;
}
StrayResponse CalibratedStrain::to_stray(StrayWay const& way) const {
  auto const of = [&](LinearResponse const& r) { return stray_response(r, network_, field_, way, hz_); };
  StrayResponse sum = of(read_);
  for (std::size_t i = 0; i < sensors_.size(); ++i) sum = sum + of(sensors_[i]) * -weight_[Eigen::Index(i)];
  return sum;
}

CalibratedStrain::Parts CalibratedStrain::parts(Cause const& cause) const {
  auto const size = Eigen::Index(lengths_.size());
  Eigen::VectorXcd sensed(size), lengths(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    sensed[i] = cause(sensors_[std::size_t(i)]);
    lengths[i] = cause(lengths_[std::size_t(i)]);
  }
  Eigen::VectorXcd const actuators = -actuate_ * sensed, residual = lengths + move_ * actuators;
  Parts p{.held = cause(read_)};
  for (Eigen::Index i = 0; i < size; ++i) {
    p.held -= per_length_[i] * lengths[i];
    p.by_length.push_back(per_length_[i] * residual[i] - (seen_[i] - kept_[i]) * actuators[i]);
  }
  return p;
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

std::string describe(std::vector<ControlledLength> const& controlled) {
  std::vector<std::string> held, others;
  for (ControlledLength const& c : controlled) {
    if (c.loop.kind == ControlLoop::Kind::held)
      held.push_back(c.freedom.name);
    else if (c.loop.kind == ControlLoop::Kind::free)
      others.push_back(c.freedom.name + " free");
    else
      others.push_back(fmt::format("{} controlled by {}", c.freedom.name, c.loop.sensor.name));
  }
  std::string text;
  for (std::size_t i = 0; i < held.size(); ++i) text += (i == 0 ? "" : i + 1 < held.size() ? ", " : " and ") + held[i];
  if (!held.empty()) others.insert(others.begin(), text + " held");
  return fmt::format("{}", fmt::join(others, ", "));
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
  auto const size = [&](double turn) {
    Readout turned = r;
    turned.angle += turn;
    return std::abs(along(LinearResponse(network, field, turned, hz), freedom));
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

LoopRow row_of(NetworkModel const& model, SteadyField const& field, CalibratedStrain const& r, std::size_t i, double hz,
               Band const& band) {
  ControlledLength const& c = model.controlled[i];
  LoopRow row{.length = c.freedom.name};
  if (c.loop.kind != ControlLoop::Kind::closed) {
    row.sensor = c.loop.kind == ControlLoop::Kind::held ? "held" : "free";
    return row;
  }
  row.sensor = c.loop.sensor.name;
  row.plant = std::conj(along(LinearResponse(model.network, field, c.loop.sensor.readout, hz), c.freedom));
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

}  // namespace

LoopTable loop_table(NetworkModel const& model, double hz, Band const& band) {
  SteadyField const field(model.network);
  CalibratedStrain const r(model, field, hz);
  LoopTable table{.hz = hz};
  for (std::size_t i = 0; i < model.controlled.size(); ++i) {
    table.loops.push_back(row_of(model, field, r, i, hz, band));
    if (table.loops.back().sensor != "held") table.lengths.push_back(table.loops.back().length);
  }
  double const least = dark * largest_power(model.network, field);
  for (NamedWay const& w : model.entrances)
    for (bool const phase : {true, false})
      if (lighting_power(w.way, field) > least) table.stray.push_back(by_loop(model, field, r, w, hz, phase));
  return table;
}

}  // namespace straytrace::ifo
