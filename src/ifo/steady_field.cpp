// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "ifo/network.hpp"
#include "ifo/network_ways.hpp"

namespace straytrace::ifo {
namespace {

// Unknowns: the fields leaving every port, all ports of carrier 0 first, all modes of a port together. The field
// entering a port left the other end of its space.
class Places {
 public:
  Places(std::size_t ports, std::size_t modes) : ports_(ports), modes_(modes) {}
  Eigen::Index operator()(std::size_t carrier, std::size_t port, std::size_t mode) const {
    return Eigen::Index((carrier * ports_ + port) * modes_ + mode);
  }
  Eigen::Index size(std::size_t carriers) const { return Eigen::Index(carriers * ports_ * modes_); }

 private:
  std::size_t ports_, modes_;
};

Sparse steady_matrix(Network const& network, std::vector<double> const& carriers, ModeBases const* bases) {
  Places const at(network.ports(), bases ? bases->count() : 1);
  Eigen::Index const size = at.size(carriers.size());
  auto const other = neighbours(network);
  Entries entries;
  for (Eigen::Index i = 0; i < size; ++i) entries.emplace_back(i, i, 1.0);
  for (Network::Component const& c : network.components())
    for_each_way(c, scattering_by_carrier(network, c, carriers), carriers,
                 [&](std::uint32_t out, std::uint32_t in, std::size_t m, std::size_t n, Phasor amplitude) {
                   auto const [from, space] = other[c.first_port + in];
                   if (from == network.ports()) return;  // no light enters here
                   for_each_mode_pair(bases, c, out, in, amplitude, [&](std::size_t p, std::size_t q, Phasor a) {
                     entries.emplace_back(at(m, c.first_port + out, p), at(n, from, q),
                                          -a * turn_along(network, bases, space, carriers[n], q));
                   });
                 });
  Sparse matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Phasor field_at(SteadyField const& field, Readout const& r, std::size_t carrier, std::size_t mode) {
  return r.leaving ? field.out(r.port, carrier, mode) : field.in(r.port, carrier, mode);
}

// Pi E of a read-out e = E* Pi E, of one mode by carrier: detectors add the powers of modes.
Eigen::VectorXcd gradient(Readout const& r, SteadyField const& field, std::size_t mode) {
  auto const size = Eigen::Index(field.carriers().size());
  Eigen::VectorXcd g = Eigen::VectorXcd::Zero(size);
  if (r.kind == Readout::Kind::power) {
    for (Eigen::Index n = 0; n < size; ++n) g[n] = field_at(field, r, std::size_t(n), mode);
  } else if (r.kind == Readout::Kind::demodulated) {
    for_each_beat(field.carriers(), r.hz, [&](std::size_t m, std::size_t n) {
      g[Eigen::Index(n)] += 0.5 * field_at(field, r, m, mode) * std::polar(1.0, r.angle);
      g[Eigen::Index(m)] += 0.5 * field_at(field, r, n, mode) * std::polar(1.0, -r.angle);
    });
  } else {
    throw std::invalid_argument("a slope needs a read-out of power");
  }
  return g;
}

}  // namespace

std::vector<std::pair<std::uint32_t, std::size_t>> neighbours(Network const& network) {
  std::vector<std::pair<std::uint32_t, std::size_t>> other(network.ports(), {network.ports(), 0});
  for (std::size_t i = 0; i < network.spaces().size(); ++i) {
    Network::Space const& s = network.spaces()[i];
    other[s.from] = {s.to, i};
    other[s.to] = {s.from, i};
  }
  return other;
}

std::vector<Eigen::MatrixXcd> scattering_by_carrier(Network const& network, Network::Component const& c,
                                                    std::vector<double> const& carriers) {
  std::vector<Eigen::MatrixXcd> all;
  for (double const hz : carriers) all.push_back(network.scattering(c, hz));
  return all;
}

SteadyField::SteadyField(Network const& network) : carriers_(network.carriers()) {
  if (network.modes()) bases_ = std::make_shared<ModeBases const>(network);
  if (bases_) modes_ = bases_->count();
  std::size_t const ports = network.ports();
  Places const at(ports, modes_);
  auto const other = neighbours(network);
  Eigen::VectorXcd source = Eigen::VectorXcd::Zero(at.size(carriers_.size()));
  std::size_t const laser = *carrier_at(carriers_, 0);
  for (Network::Component const& c : network.components()) {
    if (c.emits == 0.0) continue;
    Eigen::Index const first = at(laser, c.first_port, 0);
    if (bases_)
      source.segment(first, Eigen::Index(modes_)) += c.emits * bases_->emitted(c);
    else
      source[first] += c.emits;
  }
  Eigen::VectorXcd const left = solved(steady_matrix(network, carriers_, bases()), source, "the steady light");
  for (std::size_t n = 0; n < carriers_.size(); ++n) {
    out_.push_back(left.segment(at(n, 0, 0), at.size(1)));
    in_.push_back(Eigen::VectorXcd::Zero(at.size(1)));
    for (std::uint32_t p = 0; p < ports; ++p)
      if (auto const [from, space] = other[p]; from < ports)
        for (std::size_t mode = 0; mode < modes_; ++mode)
          in_[n][at(0, p, mode)] = turn_along(network, bases(), space, carriers_[n], mode) * out(from, n, mode);
  }
}

double SteadyField::power_in(std::uint32_t port) const {
  double sum = 0;
  for (Eigen::VectorXcd const& field : in_)
    for (std::size_t mode = 0; mode < modes_; ++mode) sum += std::norm(field[Eigen::Index(port * modes_ + mode)]);
  return sum;
}
double SteadyField::power_out(std::uint32_t port) const {
  double sum = 0;
  for (Eigen::VectorXcd const& field : out_)
    for (std::size_t mode = 0; mode < modes_; ++mode) sum += std::norm(field[Eigen::Index(port * modes_ + mode)]);
  return sum;
}

std::size_t SteadyField::carrier(double hz) const {
  if (auto const n = carrier_at(carriers_, hz)) return *n;
  throw std::out_of_range("no carrier at this frequency");
}

double value_of(Readout const& r, SteadyField const& field) {
  double sum = 0;
  if (r.kind == Readout::Kind::homodyne)
    return std::real(field_at(field, r, field.carrier(0), 0) * std::polar(1.0, -r.angle));
  for (std::size_t mode = 0; mode < field.modes(); ++mode) {
    auto const at = [&](std::size_t n) { return field_at(field, r, n, mode); };
    if (r.kind == Readout::Kind::power)
      for (std::size_t n = 0; n < field.carriers().size(); ++n) sum += std::norm(at(n));
    else if (r.kind == Readout::Kind::demodulated)
      for_each_beat(field.carriers(), r.hz, [&](std::size_t m, std::size_t n) {
        sum += std::real(at(m) * std::conj(at(n)) * std::polar(1.0, r.angle));
      });
  }
  return sum;
}

// M* lambda = Pi E. What enters a port left the other end of its space with the conjugate of its phase.
AdjointSlope::AdjointSlope(Network const& network, SteadyField const& field, Readout const& readout)
    : network_(network), field_(field), readout_(readout) {
  std::vector<double> const& carriers = field.carriers();
  Places const at(network.ports(), field.modes());
  Eigen::VectorXcd right = Eigen::VectorXcd::Zero(at.size(carriers.size()));
  auto const [from, space] = neighbours(network)[readout.port];
  for (std::size_t mode = 0; mode < field.modes(); ++mode) {
    Eigen::VectorXcd const g = gradient(readout, field, mode);
    for (std::size_t n = 0; n < carriers.size(); ++n)
      if (readout.leaving)
        right[at(n, readout.port, mode)] = g[Eigen::Index(n)];
      else if (from < network.ports())
        right[at(n, from, mode)] =
            g[Eigen::Index(n)] * std::conj(turn_along(network, field.bases(), space, carriers[n], mode));
  }
  lambda_ = solved(steady_matrix(network, carriers, field.bases()).adjoint(), right, "the slope of a read-out");
}

Phasor AdjointSlope::weighted(std::uint32_t port, std::size_t carrier, std::size_t mode) const {
  return std::conj(lambda_[Places(network_.ports(), field_.modes())(carrier, port, mode)]);
}

// Sum over the ways of a component of what d(amplitude) adds to the light that leaves: the amplitude times
// `relative` + i k_n `path`.
double AdjointSlope::along_ways(ComponentId id, Eigen::MatrixXd const& relative, Eigen::MatrixXd const& path) const {
  Network::Component const& c = network_.at(id);
  Phasor sum = 0;
  for_each_way(c, scattering_by_carrier(network_, c, field_.carriers()), field_.carriers(),
               [&](std::uint32_t out, std::uint32_t in, std::size_t m, std::size_t n, Phasor amplitude) {
                 Phasor const change(relative(out, in), network_.wavenumber(field_.carriers()[n]) * path(out, in));
                 if (change == 0.0) return;
                 for_each_mode_pair(field_.bases(), c, out, in, amplitude, [&](std::size_t p, std::size_t q, Phasor a) {
                   sum += weighted(c.first_port + out, m, p) * a * change * field_.in(c.first_port + in, n, q);
                 });
               });
  return 2 * std::real(sum);
}

double AdjointSlope::to_displacement(ComponentId id) const {
  Network::Component const& c = network_.at(id);
  return along_ways(id, Eigen::MatrixXd::Zero(c.ports, c.ports), c.path);
}

// dr/dT = -r/2R and dt/dT = t/2T, at constant loss.
double AdjointSlope::to_transmission(ComponentId id) const {
  Network::Component const& c = network_.at(id);
  MirrorParameters const& p = std::get<MirrorParameters>(c.stated);
  double const reflected = -0.5 / (1 - p.transmission - p.loss), transmitted = 0.5 / p.transmission;
  Eigen::MatrixXd relative(c.ports, c.ports);
  for (std::uint32_t out = 0; out < c.ports; ++out)
    for (std::uint32_t in = 0; in < c.ports; ++in) relative(out, in) = c.reflects(out, in) ? reflected : transmitted;
  if (!std::isfinite(reflected) || !std::isfinite(transmitted)) return not_a_number;
  return along_ways(id, relative, Eigen::MatrixXd::Zero(c.ports, c.ports));
}

double AdjointSlope::to_loss(ComponentId id) const {
  Network::Component const& c = network_.at(id);
  MirrorParameters const& p = std::get<MirrorParameters>(c.stated);
  double const reflected = -0.5 / (1 - p.transmission - p.loss);
  Eigen::MatrixXd relative(c.ports, c.ports);
  for (std::uint32_t out = 0; out < c.ports; ++out)
    for (std::uint32_t in = 0; in < c.ports; ++in) relative(out, in) = c.reflects(out, in) ? reflected : 0;
  if (!std::isfinite(reflected)) return not_a_number;
  return along_ways(id, relative, Eigen::MatrixXd::Zero(c.ports, c.ports));
}

double AdjointSlope::to_power(ComponentId id) const {
  Network::Component const& c = network_.at(id);
  double const power = std::norm(c.emits);
  if (!(power > 0)) return not_a_number;
  std::size_t const carrier = field_.carrier(0);
  if (!field_.bases()) return 2 * std::real(weighted(c.first_port, carrier, 0) * c.emits / (2 * power));
  Eigen::VectorXcd const emitted = field_.bases()->emitted(c);
  Phasor sum = 0;
  for (std::size_t mode = 0; mode < field_.modes(); ++mode)
    sum += weighted(c.first_port, carrier, mode) * c.emits * emitted[Eigen::Index(mode)];
  return std::real(sum) / power;
}

// Light that enters at either end turns; where the read-out is one of these ends, it turns there too.
double AdjointSlope::along_space(std::size_t number, bool of_length) const {
  Network::Space const& s = network_.spaces().at(number);
  std::vector<double> const& carriers = field_.carriers();
  auto const turned = [&](std::uint32_t port, std::size_t n, std::size_t mode) {
    return i_unit * (of_length ? 2 * pi * carriers[n] / speed_of_light : 1.0) * field_.in(port, n, mode);
  };
  Phasor sum = 0;
  for (std::uint32_t const port : {s.from, s.to}) {
    Network::Component const& c = network_.at(network_.owner_of(port));
    for_each_way(c, scattering_by_carrier(network_, c, carriers), carriers,
                 [&](std::uint32_t out, std::uint32_t in, std::size_t m, std::size_t n, Phasor amplitude) {
                   if (c.first_port + in != port) return;
                   for_each_mode_pair(field_.bases(), c, out, in, amplitude,
                                      [&](std::size_t p, std::size_t q, Phasor a) {
                                        sum += weighted(c.first_port + out, m, p) * a * turned(port, n, q);
                                      });
                 });
    if (readout_.leaving || readout_.port != port) continue;
    for (std::size_t mode = 0; mode < field_.modes(); ++mode) {
      Eigen::VectorXcd const g = gradient(readout_, field_, mode);
      for (Eigen::Index n = 0; n < g.size(); ++n) sum += std::conj(g[n]) * turned(port, std::size_t(n), mode);
    }
  }
  return 2 * std::real(sum);
}
double AdjointSlope::to_length(std::size_t space) const { return along_space(space, true); }
double AdjointSlope::to_phase(std::size_t space) const { return along_space(space, false); }

}  // namespace straytrace::ifo
