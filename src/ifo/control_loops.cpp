// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/control_loops.hpp"

#include <Eigen/LU>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "ifo/dual_recycled.hpp"
#include "ifo/layout/signals.hpp"

namespace straytrace::ifo {
namespace {

constexpr std::array<Freedom, 4> freedoms = {Freedom::carm, Freedom::mich, Freedom::prcl, Freedom::srcl};
constexpr double close_to_unstable = 0.3;  // |1 + G|

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

}  // namespace

ControlledResponse::Square ControlledResponse::responses(std::vector<LinearResponse> const& readouts) const {
  Square m;
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j) m(i, j) = d_.to_freedom(readouts[std::size_t(i)], freedoms[std::size_t(j)]);
  return m;
}

// Actuators move by u, the loops sense y = R u + T s, and u = -C y, where C = G/R_pp of a closed loop. A held length
// has y = 0 with itself as sensor: the row R u = -T s without the term u.
ControlledResponse::ControlledResponse(DualRecycled const& d, double hz, ControlLoops const& loops)
    : d_(d), read_(d.response(hz)) {
  using Kind = ControlLoop::Kind;
  for (int i = 0; i < count; ++i) {
    lengths_.push_back(d.response(length_of(d.network(), freedoms[std::size_t(i)]), hz));
    seen_[i] = d.to_freedom(read_, freedoms[std::size_t(i)]);
  }
  move_ = responses(lengths_);
  per_length_ = seen_ * move_.inverse();
  for (int i = 0; i < count; ++i) {
    ControlLoop const& loop = loops[std::size_t(i)];
    sensors_.push_back(loop.kind == Kind::closed ? d.response(loop.sensor.readout, hz) : lengths_[std::size_t(i)]);
  }
  Square equations = responses(sensors_), sensed = Square::Identity();
  kept_ = seen_;
  for (int i = 0; i < count; ++i) {
    ControlLoop const& loop = loops[std::size_t(i)];
    if (loop.kind == Kind::held) continue;
    Phasor const control = loop.kind == Kind::free ? 0.0 : loop.open_loop(hz) / equations(i, i);
    equations.row(i) *= control;
    equations(i, i) += 1.0;
    sensed(i, i) = control;
    kept_[i] *= 1.0 - loop.feedforward(hz);
  }
  actuate_ = equations.inverse() * sensed;
  weight_ = kept_ * actuate_;
}

Phasor ControlledResponse::to(Cause const& cause) const {
  Phasor sum = cause(read_);
  for (int i = 0; i < count; ++i) sum -= weight_[i] * cause(sensors_[std::size_t(i)]);
  return sum;
}
Phasor ControlledResponse::to_freedom(Freedom f) const {
  return to([&](LinearResponse const& r) { return d_.to_freedom(r, f); });
}
Phasor ControlledResponse::to_phase(Injection const& i) const {
  return to([&](LinearResponse const& r) { return r.to_phase(i); });
}
Phasor ControlledResponse::to_amplitude(Injection const& i) const {
  return to([&](LinearResponse const& r) { return r.to_amplitude(i); });
}

ControlledResponse::Parts ControlledResponse::parts(Cause const& cause) const {
  Eigen::Matrix<Phasor, count, 1> sensed, lengths;
  for (int i = 0; i < count; ++i) {
    sensed[i] = cause(sensors_[std::size_t(i)]);
    lengths[i] = cause(lengths_[std::size_t(i)]);
  }
  Eigen::Matrix<Phasor, count, 1> const actuators = -actuate_ * sensed, residual = lengths + move_ * actuators;
  Parts p{.held = cause(read_) - Phasor(per_length_ * lengths)};
  for (int i = 0; i < count; ++i)
    p.by_length[std::size_t(i)] = per_length_[i] * residual[i] - (seen_[i] - kept_[i]) * actuators[i];
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
      node["sensor"].problem(fmt::format("'{}' is a homodyne detector, which no loop of a length uses", sensor),
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

ControlLoops read_control_loops(Node const& interferometer, NetworkModel const& model, Band const& band) {
  ControlLoops loops;
  for (auto const& [name, node] : interferometer.table("loops").items()) {
    if (name == "override") continue;
    auto const at = std::ranges::find(controlled_lengths, name);
    if (at != controlled_lengths.end()) {
      loops[std::size_t(at - controlled_lengths.begin())] = read_loop(node, name, model, band);
      continue;
    }
    if (node.kind() == Node::Kind::table)
      for (char const* key : {"sensor", "open_loop", "feedforward"}) (void)node.has(key);
    std::vector<std::string> const names(controlled_lengths.begin(), controlled_lengths.end());
    node.problem(fmt::format("no loop controls '{}'", name),
                 name == "DARM" ? std::string("remove it: the loop of DARM cancels in h")
                                : did_you_mean(name, names, fmt::format("it is one of: {}", fmt::join(names, ", "))));
  }
  return loops;
}

std::string describe(ControlLoops const& loops) {
  std::vector<std::string> held, others;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    std::string const name(controlled_lengths[i]);
    if (loops[i].kind == ControlLoop::Kind::held)
      held.push_back(name);
    else if (loops[i].kind == ControlLoop::Kind::free)
      others.push_back(name + " free");
    else
      others.push_back(fmt::format("{} controlled by {}", name, loops[i].sensor.name));
  }
  std::string text;
  for (std::size_t i = 0; i < held.size(); ++i) text += (i == 0 ? "" : i + 1 < held.size() ? ", " : " and ") + held[i];
  if (!held.empty()) others.insert(others.begin(), text + " held");
  return fmt::format("{}", fmt::join(others, ", "));
}

namespace {

// The band, with all corner frequencies well inside it, as far as the function is known.
Band around_corners(TransferFunction const& open_loop, Band band) {
  constexpr double beyond = 1000;
  for (double const hz : open_loop.features())
    if (hz > 0) band = {std::fmin(band.low, hz / beyond), std::fmax(band.high, hz * beyond)};
  Band const known = open_loop.range();
  return {std::fmax(band.low, known.low), std::fmin(band.high, known.high)};
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
  // Positive and negative frequencies together turn twice as far; a stable loop with two integrators turns by pi here.
  m.encircles = std::fabs(turned) > 1.5 * pi;
  return m;
}

std::vector<LoopRow> loop_rows(DualRecycled const& d, ControlledResponse const& r, ControlLoops const& loops, double hz,
                               Band const& band) {
  Phasor const darm = r.to_freedom(Freedom::darm) * d.parameters().arm_length;
  std::vector<LoopRow> rows;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    ControlLoop const& loop = loops[i];
    LoopRow row{.length = std::string(controlled_lengths[i])};
    if (loop.kind == ControlLoop::Kind::closed) {
      row.sensor = loop.sensor.name;
      row.unit = unit_of(loop.sensor.readout);
      row.plant = std::conj(d.to_freedom(d.response(loop.sensor.readout, hz), freedoms[i]));
      row.open_loop = std::conj(loop.open_loop(hz));
      row.suppressed = suppression(row.open_loop);
      row.noise_to_strain = std::conj(r.to_sensor_noise(i) / darm);
      row.margins = loop_margins(loop.open_loop, band);
    } else {
      row.sensor = loop.kind == ControlLoop::Kind::held ? "held" : "free";
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

void check_control_loops(Node const& interferometer, DualRecycled const& d, ControlLoops const& loops,
                         Band const& band) {
  for (std::size_t i = 0; i < loops.size(); ++i) {
    ControlLoop const& loop = loops[i];
    if (loop.kind != ControlLoop::Kind::closed) continue;
    Node const node = interferometer["loops"][controlled_lengths[i]];
    if (!d.sees(loop.sensor.readout, freedoms[i], std::sqrt(band.low * band.high))) {
      node["sensor"].problem(fmt::format("'{}' does not respond to {}", loop.sensor.name, controlled_lengths[i]),
                             fmt::format("name another read-out, or write 'phase: best({})'", controlled_lengths[i]));
      continue;
    }
    LoopMargins const m = loop_margins(loop.open_loop, band);
    if (m.encircles)
      node.warning(
          fmt::format("the open-loop gain of {} goes around -1: the closed loop is unstable", controlled_lengths[i]),
          "check its sign and phase; a gain of a loop that is closed in practice suppresses by 1/(1 + G)");
    else if (m.least < close_to_unstable)
      node.warning(fmt::format("|1 + G| of {} is {:.2g} at {:.4g} Hz: the loop amplifies there", controlled_lengths[i],
                               m.least, m.least_at),
                   "check gain and phase of 'open_loop'");
  }
}

}  // namespace straytrace::ifo
