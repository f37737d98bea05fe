// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/layout/operating_point.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/math/linear_algebra.hpp"
#include "ifo/control_loops.hpp"
#include "ifo/layout/signals.hpp"
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

namespace {

BeamModes modes_at(Network const& n, SteadyField const& f, std::uint32_t port) {
  ModeBases const& bases = *f.bases();
  BeamModes beam{.port = n.port_name(port), .power = f.power_out(port)};
  for (std::size_t axis : {0, 1}) beam.w[axis] = std::sqrt(n.wavelength() / (pi * bases.leaving(port)[axis].imag()));
  beam.share.resize(std::size_t(n.modes()->order) + 1);
  for (std::size_t mode = 0; mode < f.modes(); ++mode)
    for (std::size_t c = 0; c < f.carriers().size(); ++c)
      beam.share[std::size_t(bases.orders(mode)[0] + bases.orders(mode)[1])] += std::norm(f.out(port, c, mode));
  for (double& s : beam.share) s = beam.power > 0 ? s / beam.power : not_a_number;
  return beam;
}

Truncation truncation_of(NetworkModel const& model, SteadyField const& f) {
  Network const& n = model.network;
  Truncation t{.order = n.modes()->order, .lower = std::max(0, n.modes()->order - 2)};
  double most = 0;
  for (std::uint32_t p = 0; p < n.ports(); ++p) most = std::max(most, f.power_out(p));
  for (int const less : {2, 4}) {  // one order alone may couple to nothing, as at some radii of an aperture
    Network coarse = n;
    ModeSettings settings = *n.modes();
    settings.order = std::max(0, t.order - less);
    if (less > 2 && settings.order < 2) continue;  // the fundamental mode is no comparison
    coarse.use_modes(settings);
    SteadyField const g(coarse);
    for (std::uint32_t p = 0; p < n.ports(); ++p) {
      double const power = f.power_out(p);
      if (!(power > Truncation::least_power * most)) continue;
      double const change = std::fabs(g.power_out(p) / power - 1);
      if (change > t.change || t.beam.empty())
        t.change = change, t.beam = n.port_name(p) + ".out", t.lower = settings.order;
    }
  }
  OperatingPoint const point = operating_point(model);
  t.missing = point.missing;
  t.emitted = point.emitted;
  return t;
}

}  // namespace

ModeTable mode_table(NetworkModel const& model) {
  Network const& n = model.network;
  if (!n.modes()) ModeBases{n};  // says why not
  SteadyField const f(n);
  ModeBases const& bases = *f.bases();
  ModeTable table;
  for (std::uint32_t p = 0; p < n.ports(); ++p)
    if (f.power_out(p) > 0) table.beams.push_back(modes_at(n, f, p));
  for (NetworkCavity const& c : cavities_of(n)) {
    CavityMode const mode = mode_of(n, c);
    bool const basis =
        std::ranges::any_of(bases.cavities(), [&](CavityMode const& b) { return b.cavity.name == c.name; });
    table.resonances.push_back({c.name, n.port_name(c.beams.front()), mode.stable(), basis, mode});
  }
  table.mismatches = bases.mismatches();
  table.truncation = truncation_of(model, f);
  return table;
}

double vacuum_beside_carriers(Network const& network, SteadyField const& field, Readout const& r,
                              Readout const& other) {
  constexpr auto demodulated = Readout::Kind::demodulated;
  if (r.kind != demodulated || other.kind != demodulated || r.port != other.port || r.leaving != other.leaving ||
      r.hz != other.hz)
    return 0;
  double outside = 0;  // W: each carrier beats with the vacuum on either side
  std::vector<double> const& carriers = field.carriers();
  for (std::size_t n = 0; n < carriers.size(); ++n)
    for (double const beat : {r.hz, -r.hz})
      if (!carrier_at(carriers, carriers[n] + beat))
        for (std::size_t mode = 0; mode < field.modes(); ++mode)
          outside += std::norm(r.leaving ? field.out(r.port, n, mode) : field.in(r.port, n, mode));
  return hbar * network.wavenumber() * speed_of_light / 2 * outside * std::cos(r.angle - other.angle);
}

double vacuum_noise(Network const& network, SteadyField const& field, Readout const& r, double hz) {
  return LinearResponse(network, field, r, hz).quantum_noise() + vacuum_beside_carriers(network, field, r, r);
}

namespace {

void add_total(ReadoutNoise& noise) {
  for (std::size_t i = 0; i < noise.hz.size(); ++i) {
    double sum = 0;
    for (auto const& part : noise.asd) sum += part[i] * part[i];
    noise.total.push_back(std::sqrt(sum));
  }
}

}  // namespace

ReadoutNoise noise_of(NetworkModel const& model, NamedReadout const& readout, NamedFreedom const* referred,
                      std::vector<double> const& hz) {
  SteadyField const field(model.network);
  ReadoutNoise noise{.hz = hz, .names = {"vacuum"}};
  for (NamedNoise const& n : model.noises) noise.names.push_back(n.cause.name);
  noise.asd.resize(noise.names.size());
  for (double const f : hz) {
    LinearResponse const r(model.network, field, readout.readout, f);
    double per = 1;
    if (referred)
      per = std::abs(response_to(r, model.network, {"", NetworkCause::Kind::displacement, referred->moves}, f));
    noise.asd[0].push_back(std::sqrt(vacuum_noise(model.network, field, readout.readout, f)) / per);
    for (std::size_t i = 0; i < model.noises.size(); ++i) {
      NamedNoise const& n = model.noises[i];
      noise.asd[i + 1].push_back(std::abs(response_to(r, model.network, n.cause, f)) * n.asd(f) / per);
    }
  }
  add_total(noise);
  return noise;
}

Eigen::MatrixXcd CalibratedStrain::responses(std::vector<LinearResponse> const& readouts) const {
  Eigen::MatrixXcd m(Eigen::Index(readouts.size()), Eigen::Index(model_.controlled.size()));
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.cols(); ++j)
      m(i, j) = to_freedom(readouts[std::size_t(i)], model_.controlled[std::size_t(j)].freedom);
  return m;
}

Readout const& CalibratedStrain::sensor(std::size_t loop) const {
  ControlledLength const& c = model_.controlled[loop];
  return c.loop.kind == ControlLoop::Kind::closed ? c.loop.sensor.readout : c.length;
}

// Actuators move by u, the loops sense y = R u + T s, and u = -C y, where C = G/R_pp of a closed loop. A held length
// has y = 0 with itself as sensor: the row R u = -T s without the term u.
CalibratedStrain::CalibratedStrain(NetworkModel const& model, SteadyField const& field, double hz)
    : model_(model),
      network_(model.network),
      field_(field),
      scale_(*model.strain),
      hz_(hz),
      signals_(network_, field, hz),
      read_(signals_, scale_.readout) {
  using Kind = ControlLoop::Kind;
  std::vector<ControlledLength> const& controlled = model.controlled;
  auto const size = Eigen::Index(controlled.size());
  seen_.resize(size);
  for (ControlledLength const& c : controlled) {
    seen_[Eigen::Index(lengths_.size())] = to_freedom(read_, c.freedom);
    lengths_.emplace_back(signals_, c.length);
    bool const closed = c.loop.kind == Kind::closed;
    sensors_.push_back(closed ? LinearResponse(signals_, c.loop.sensor.readout) : lengths_.back());
  }
  move_ = responses(lengths_);
  per_length_ = seen_;
  if (size > 0) per_length_ = seen_ * inverse(move_);
  Eigen::MatrixXcd equations = responses(sensors_), sensed = Eigen::MatrixXcd::Identity(size, size);
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
  if (size > 0) actuate_ = inverse(equations) * sensed;
  weight_ = kept_ * actuate_;
  if (!model.subtracted.empty()) subtract();
  per_metre_ = to([&](LinearResponse const& r) { return to_freedom(r, scale_.freedom); });
}

// Eq. N.33: the strain becomes D + sum of filter x channel, both with all loops acting. Stated filters come first.
void CalibratedStrain::subtract() {
  Sum strain = whole();
  std::vector<Sum> channels;
  std::vector<Eigen::Index> best;
  auto const count = Eigen::Index(model_.subtracted.size());
  Eigen::RowVectorXcd filters = Eigen::RowVectorXcd::Zero(count);
  std::vector<LinearResponse> responses_of;
  for (SubtractedChannel const& c : model_.subtracted) responses_of.emplace_back(signals_, c.channel.readout);
  Eigen::MatrixXcd const seen = responses(responses_of), weights = seen * actuate_;
  for (Eigen::Index i = 0; i < count; ++i) {
    SubtractedChannel const& c = model_.subtracted[std::size_t(i)];
    channels.push_back(with_loops(responses_of[std::size_t(i)], c.channel.readout, weights.row(i)));
    if (!c.filter) {
      best.push_back(i);
      continue;
    }
    filters[i] = (*c.filter)(hz_);
    strain.add(filters[i], channels.back());
  }
  auto const size = Eigen::Index(best.size());
  Eigen::RowVectorXcd cross(size);
  Eigen::MatrixXcd own(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    Sum const& channel = channels[std::size_t(best[std::size_t(i)])];
    cross[i] = spectrum(strain, channel);
    for (Eigen::Index j = 0; j < size; ++j) own(j, i) = spectrum(channels[std::size_t(best[std::size_t(j)])], channel);
  }
  if (size > 0) {
    Eigen::RowVectorXcd const solution = -solve(own.transpose(), cross.transpose()).transpose();
    for (Eigen::Index i = 0; i < size; ++i) filters[best[std::size_t(i)]] = solution[i];
  }
  channels_ = std::move(responses_of);
  filters_ = filters;
  seen_ += filters * seen;
  kept_ += filters * seen;
  weight_ = kept_ * actuate_;
  if (move_.size() > 0) per_length_ += filters * seen * inverse(move_);
}

Phasor CalibratedStrain::to(Cause const& cause) const {
  Phasor sum = cause(read_);
  for (std::size_t i = 0; i < channels_.size(); ++i) sum += filters_[Eigen::Index(i)] * cause(channels_[i]);
  for (std::size_t i = 0; i < sensors_.size(); ++i) sum -= weight_[Eigen::Index(i)] * cause(sensors_[i]);
  return sum;
}
StrayResponse CalibratedStrain::to_stray(StrayWay const& way) const {
  auto const of = [&](LinearResponse const& r) { return stray_response(r, network_, field_, way, hz_); };
  StrayResponse sum = of(read_);
  for (std::size_t i = 0; i < channels_.size(); ++i) sum = sum + of(channels_[i]) * filters_[Eigen::Index(i)];
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
  for (std::size_t i = 0; i < channels_.size(); ++i) p.held += filters_[Eigen::Index(i)] * cause(channels_[i]);
  for (Eigen::Index i = 0; i < size; ++i) {
    p.held -= per_length_[i] * lengths[i];
    p.by_length.push_back(per_length_[i] * residual[i] - (seen_[i] - kept_[i]) * actuators[i]);
  }
  return p;
}

void CalibratedStrain::Sum::add(Phasor factor, LinearResponse const& r, Readout const& readout) {
  response.add(factor, r);
  of.emplace_back(factor, readout);
}
void CalibratedStrain::Sum::add(Phasor factor, Sum const& other) {
  response.add(factor, other.response);
  for (auto const& [part, readout] : other.of) of.emplace_back(factor * part, readout);
}

CalibratedStrain::Sum CalibratedStrain::with_loops(LinearResponse const& r, Readout const& readout,
                                                   Eigen::RowVectorXcd const& weight) const {
  Sum sum{r, {{1.0, readout}}};
  for (std::size_t i = 0; i < sensors_.size(); ++i) sum.add(-weight[Eigen::Index(i)], sensors_[i], sensor(i));
  return sum;
}

CalibratedStrain::Sum CalibratedStrain::whole() const {
  Sum sum = with_loops(read_, scale_.readout, weight_);
  for (std::size_t i = 0; i < channels_.size(); ++i)
    sum.add(filters_[Eigen::Index(i)], channels_[i], model_.subtracted[i].channel.readout);
  return sum;
}

// As parts(): the residual of a length is l + M u, with u = -A y of the sensors y.
std::vector<CalibratedStrain::Sum> CalibratedStrain::part_sums() const {
  Sum held{read_, {{1.0, scale_.readout}}};
  for (std::size_t i = 0; i < channels_.size(); ++i)
    held.add(filters_[Eigen::Index(i)], channels_[i], model_.subtracted[i].channel.readout);
  for (std::size_t i = 0; i < lengths_.size(); ++i)
    held.add(-per_length_[Eigen::Index(i)], lengths_[i], model_.controlled[i].length);
  std::vector<Sum> all{std::move(held)};
  Eigen::MatrixXcd const moved = move_ * actuate_;
  for (std::size_t k = 0; k < lengths_.size(); ++k) {
    auto const i = Eigen::Index(k);
    Sum by{lengths_[k], {{1.0, model_.controlled[k].length}}};
    by.add(per_length_[i] - 1.0, lengths_[k], model_.controlled[k].length);
    for (std::size_t j = 0; j < sensors_.size(); ++j)
      by.add(-per_length_[i] * moved(i, Eigen::Index(j)) + (seen_[i] - kept_[i]) * actuate_(i, Eigen::Index(j)),
             sensors_[j], sensor(j));
    all.push_back(std::move(by));
  }
  return all;
}

Phasor CalibratedStrain::vacuum(Sum const& a, Sum const& b) const {
  Phasor sum = a.response.vacuum_correlation(b.response);
  for (auto const& [x, of_a] : a.of)
    for (auto const& [y, of_b] : b.of) sum += x * std::conj(y) * vacuum_beside_carriers(network_, field_, of_a, of_b);
  return sum;
}

Phasor CalibratedStrain::spectrum(Sum const& a, Sum const& b) const {
  Phasor sum = vacuum(a, b);
  for (NamedNoise const& n : model_.noises)
    sum += response_to(a.response, network_, n.cause, hz_) *
           std::conj(response_to(b.response, network_, n.cause, hz_)) * std::pow(n.asd(hz_), 2);
  return sum;
}

}  // namespace straytrace::ifo
