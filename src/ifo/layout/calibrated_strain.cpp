// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>

#include <utility>

#include "ifo/control_loops.hpp"
#include "ifo/layout/noise_budget.hpp"
#include "ifo/layout/signals.hpp"

namespace straytrace::ifo {
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
  if (size > 0) per_length_ = seen_ * move_.inverse();
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
  if (size > 0) actuate_ = equations.inverse() * sensed;
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
    Eigen::RowVectorXcd const solution = -own.transpose().partialPivLu().solve(cross.transpose()).transpose();
    for (Eigen::Index i = 0; i < size; ++i) filters[best[std::size_t(i)]] = solution[i];
  }
  channels_ = std::move(responses_of);
  filters_ = filters;
  seen_ += filters * seen;
  kept_ += filters * seen;
  weight_ = kept_ * actuate_;
  if (move_.size() > 0) per_length_ += filters * seen * move_.inverse();
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
