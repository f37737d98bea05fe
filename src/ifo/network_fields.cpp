// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
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
                   auto const add = [&, from = from, space = space](std::size_t p, std::size_t q, Phasor a) {
                     entries.emplace_back(at(m, c.first_port + out, p), at(n, from, q),
                                          -a * turn_along(network, bases, space, carriers[n], q));
                   };
                   for_each_mode_pair(bases, c, out, in, amplitude, add);
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

namespace {

QuadratureCovariance rotation(double angle) {
  QuadratureCovariance m;
  m << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return m;
}

// An operation on both sidebands, the lower one conjugated, expressed for the quadratures.
Eigen::Matrix2cd in_quadratures(Phasor upper, Phasor lower) {
  Phasor const sum = (upper + lower) / 2.0, difference = i_unit * (upper - lower) / 2.0;
  Eigen::Matrix2cd m;
  m << sum, difference, -difference, sum;
  return m;
}

// Reflected light, and the vacuum that enters through the end mirror and the losses.
QuadratureCovariance after(FilterCavity const& c, double hz, QuadratureCovariance const& before) {
  double const r1 = std::sqrt(1 - c.input_transmission), r2 = std::sqrt(1 - c.end_transmission),
               round = r1 * r2 * std::sqrt(1 - c.loss);
  struct Answer {
    Phasor reflected, from_end, from_loss;
  };
  auto const answer = [&](double sideband) {
    double const phase = 4 * pi * (sideband - c.detuning) * c.length / speed_of_light;
    Phasor const turn = std::polar(1.0, phase), gain = 1.0 / (1.0 - round * turn), half = std::polar(1.0, phase / 2);
    return Answer{r1 - r2 * c.input_transmission * turn * gain,
                  std::sqrt(c.input_transmission * c.end_transmission) * half * gain,
                  std::sqrt(c.input_transmission * c.loss) * half * gain};
  };
  Answer const u = answer(hz), l = answer(-hz);
  Eigen::Matrix2cd const f = in_quadratures(u.reflected, std::conj(l.reflected)),
                         e = in_quadratures(u.from_end, std::conj(l.from_end)),
                         s = in_quadratures(u.from_loss, std::conj(l.from_loss)), turned = rotation(c.rotation);
  return turned * (f * before * f.adjoint() + e * e.adjoint() + s * s.adjoint()) * turned.adjoint();
}

}  // namespace

QuadratureCovariance squeezed_vacuum(double least, double most, double angle) {
  Eigen::Vector2cd const powers(least, most);
  return rotation(angle) * powers.asDiagonal() * rotation(angle).adjoint();
}

QuadratureCovariance Squeezer::covariance(double hz) const {
  double const decibel = std::log(10) / 10, anti = std::isfinite(anti_decibels) ? anti_decibels : decibels,
               least = std::exp(-decibel * decibels), most = std::exp(decibel * anti),
               steady = std::pow(std::cos(phase_noise), 2);
  QuadratureCovariance v =
      steady * squeezed_vacuum(least, most, angle) + (1 - steady) * squeezed_vacuum(least, most, angle + pi / 2);
  v = (1 - loss) * v + loss * QuadratureCovariance::Identity();
  for (FilterCavity const& c : cavities) v = after(c, hz, v);
  return v;
}

// Places of unknowns, and of the equations that define them: for both sidebands (0: upper; 1: the complex conjugate of
// the lower) of every carrier what enters and what leaves each port, all modes of a port together; then the
// displacement of each component.
struct SignalLayout {
  Eigen::Index ports, carriers, modes;
  explicit SignalLayout(Network const& n, SteadyField const& f)
      : ports(n.ports()), carriers(Eigen::Index(f.carriers().size())), modes(Eigen::Index(f.modes())) {}
  Eigen::Index field(bool leaves, int side, std::size_t carrier, std::uint32_t port, std::size_t mode) const {
    return (((Eigen::Index(leaves) * 2 + side) * carriers + Eigen::Index(carrier)) * ports + port) * modes +
           Eigen::Index(mode);
  }
  Eigen::Index displacement(std::size_t component) const {
    return 4 * carriers * ports * modes + Eigen::Index(component);
  }
};

namespace {

Phasor sided(int side, Phasor z) { return side == 0 ? z : std::conj(z); }

}  // namespace

// The equations, transposed: one solution gives the response to all causes. What enters a port is what leaves the other
// end of its space, times a phase, so that only what leaves and the displacements are unknown.
class SmallSignals::Equations {
 public:
  Equations(Network const& network, SteadyField const& field, double hz)
      : network_(network),
        field_(field),
        hz_(hz),
        at_(network, field),
        entering_(at_.field(true, 0, 0, 0, 0)),
        size_(at_.displacement(network.components().size())),
        source_(std::size_t(entering_), {-1, 0.0}) {
    for (std::size_t s = 0; s < network.spaces().size(); ++s) {
      add_space(s, network.spaces()[s].from, network.spaces()[s].to);
      add_space(s, network.spaces()[s].to, network.spaces()[s].from);
    }
    for (Eigen::Index i = entering_; i < size_; ++i) add(i, i, 1.0);
    for (std::size_t c = 0; c < network.components().size(); ++c) add_component(c);
  }
  Sparse matrix() const {
    Sparse matrix(size_ - entering_, size_ - entering_);
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    return matrix;
  }
  Eigen::VectorXcd weights(SparseSolver const& solver, Eigen::VectorXcd all) const {
    for (std::size_t i = 0; i < source_.size(); ++i)
      if (auto const [from, turn] = source_[i]; from >= 0) all[from] += turn * all[Eigen::Index(i)];
    all.tail(size_ - entering_) = solver.solve(all.tail(size_ - entering_));
    for (auto const& e : onward_) all[e.row()] += e.value() * all[e.col()];
    return all;
  }

 private:
  void add(Eigen::Index row, Eigen::Index column, Phasor value) {
    entries_.emplace_back(row - entering_, column - entering_, value);
  }
  void depends(Eigen::Index what, Eigen::Index on, Phasor factor) {
    if (on >= entering_) return add(on, what, -factor);
    onward_.emplace_back(on, what, factor);
    if (auto const [from, turn] = source_[std::size_t(on)]; from >= 0) add(from, what, -turn * factor);
  }

  // a leaves with S a; a displacement x adds i k_n g x/2 times the carrier that leaves, with the sign of the sideband.
  void add_component(std::size_t number) {
    Network::Component const& c = network_.components()[number];
    for_each_way(
        c, scattering_by_carrier(network_, c, field_.carriers()), field_.carriers(),
        [&](std::uint32_t out, std::uint32_t in, std::size_t m, std::size_t n, Phasor amplitude) {
          double const k = network_.wavenumber(field_.carriers()[n]);
          for_each_mode_pair(field_.bases(), c, out, in, amplitude, [&](std::size_t p, std::size_t q, Phasor a) {
            Phasor const carrier = a * field_.in(c.first_port + in, n, q);
            for (int side : {0, 1}) {
              Eigen::Index const leaving = at_.field(true, side, m, c.first_port + out, p);
              depends(leaving, at_.field(false, side, n, c.first_port + in, q), sided(side, a));
              if (c.path(out, in) != 0)
                depends(leaving, at_.displacement(number), sided(side, i_unit * k * c.path(out, in) / 2.0 * carrier));
            }
          });
        });
    if (c.suspension.mass < infinity) add_push(number, c);
  }
  // Force along the displacement: power that comes and goes at the front, less that at the back; P = |E|^2 changes by
  // 2 (E* a + E b), summed over modes.
  void add_push(std::size_t number, Network::Component const& c) {
    Phasor const yields = c.suspension.compliance(hz_) * 2.0 / speed_of_light;
    for (std::uint32_t p = 0; p < c.ports; ++p)
      for (std::size_t n = 0; n < field_.carriers().size(); ++n)
        for (bool const leaves : {false, true})
          for (std::size_t mode = 0; mode < field_.modes(); ++mode) {
            Phasor const e = leaves ? field_.out(c.first_port + p, n, mode) : field_.in(c.first_port + p, n, mode);
            for (int side : {0, 1})
              depends(at_.displacement(number), at_.field(leaves, side, n, c.first_port + p, mode),
                      yields * c.push[p] * sided(side, std::conj(e)));
          }
  }
  void add_space(std::size_t space, std::uint32_t from, std::uint32_t to) {
    for (std::size_t n = 0; n < field_.carriers().size(); ++n)
      for (int side : {0, 1}) {
        double const hz = field_.carriers()[n] + (side == 0 ? hz_ : -hz_);
        for (std::size_t mode = 0; mode < field_.modes(); ++mode)
          source_[std::size_t(at_.field(false, side, n, to, mode))] = {
              at_.field(true, side, n, from, mode), sided(side, turn_along(network_, field_.bases(), space, hz, mode))};
      }
  }

  Network const& network_;
  SteadyField const& field_;
  double hz_;
  SignalLayout at_;
  Eigen::Index entering_, size_;                         // number of fields that enter, which come first; of all
  std::vector<std::pair<Eigen::Index, Phasor>> source_;  // of what enters: what leaves there; -1: the port is open
  Entries entries_, onward_;                             // of the matrix; of what depends on fields that enter
};

namespace {

// Detectors of power add the modes; a homodyne one sees the fundamental mode alone.
void add_mode(Readout const& r, SteadyField const& field, SignalLayout const& at, std::size_t mode,
              Eigen::VectorXcd& row) {
  auto const add = [&](int side, std::size_t n, Phasor factor) {
    row[at.field(r.leaving, side, n, r.port, mode)] += factor;
  };
  auto const light = [&](std::size_t n) { return r.leaving ? field.out(r.port, n, mode) : field.in(r.port, n, mode); };
  if (r.kind == Readout::Kind::power) {
    for (std::size_t n = 0; n < field.carriers().size(); ++n) {
      add(0, n, 2.0 * std::conj(light(n)));
      add(1, n, 2.0 * light(n));
    }
  } else if (r.kind == Readout::Kind::homodyne) {
    if (mode > 0) return;
    std::size_t const n = field.carrier(0);
    add(0, n, std::polar(1.0, -r.angle));
    add(1, n, std::polar(1.0, r.angle));
  } else {
    // The beat of carriers m above n is 2 Re(E_m E_n* e^{-i w t}); times cos(w t + phase), averaged:
    // Re(E_m E_n* e^{i phase}).
    Phasor const turn = std::polar(1.0, r.angle);
    for_each_beat(field.carriers(), r.hz, [&](std::size_t m, std::size_t n) {
      Phasor const em = light(m), en = light(n);
      add(0, m, std::conj(en) * turn);
      add(1, n, em * turn);
      add(0, n, std::conj(em) * std::conj(turn));
      add(1, m, en * std::conj(turn));
    });
  }
}

Eigen::VectorXcd row_of(Readout const& r, SteadyField const& field, SignalLayout const& at, Eigen::Index size) {
  Eigen::VectorXcd row = Eigen::VectorXcd::Zero(size);
  if (r.kind == Readout::Kind::motion)
    for (auto const& [id, factor] : r.moving) row[at.displacement(id.value)] += factor;
  else
    for (std::size_t mode = 0; mode < field.modes(); ++mode) add_mode(r, field, at, mode, row);
  return row;
}

// The scattering matrix of all modes of all ports.
Eigen::MatrixXcd with_modes(Eigen::MatrixXcd const& ports, Network::Component const& c, ModeBases const* bases) {
  if (!bases) return ports;
  auto const modes = Eigen::Index(bases->count());
  Eigen::MatrixXcd all = Eigen::MatrixXcd::Zero(modes * c.ports, modes * c.ports);
  for (std::uint32_t out = 0; out < c.ports; ++out)
    for (std::uint32_t in = 0; in < c.ports; ++in)
      if (ports(out, in) != 0.0)
        all.block(out * modes, in * modes, modes, modes) = ports(out, in) * bases->coupling(c.first_port + out, in);
  return all;
}

}  // namespace

SmallSignals::SmallSignals(Network const& network, SteadyField const& field, double hz)
    : network_(network),
      field_(field),
      equations_(std::make_shared<Equations>(network, field, hz)),
      solver_(std::make_shared<SparseSolver>(equations_->matrix(), "small signals")) {}

Eigen::VectorXcd SmallSignals::weights(Readout const& r) const {
  SignalLayout const at(network_, field_);
  return equations_->weights(*solver_, row_of(r, field_, at, at.displacement(network_.components().size())));
}

Phasor LinearResponse::to_displacement(ComponentId id) const {
  return weight_[SignalLayout(network_, field_).displacement(id.value)];
}

Phasor LinearResponse::injected(Injection const& i, Phasor upper, Phasor lower) const {
  SignalLayout const at(network_, field_);
  Phasor sum = 0;
  for (std::size_t n = 0; n < field_.carriers().size(); ++n)
    for (std::size_t mode = 0; mode < field_.modes(); ++mode) {
      Phasor const e =
          std::polar(1.0, i.turn) * (i.of_leaving ? field_.out(i.port, n, mode) : field_.in(i.port, n, mode));
      sum += weight_[at.field(i.joins_leaving, 0, n, i.port, mode)] * upper * e +
             weight_[at.field(i.joins_leaving, 1, n, i.port, mode)] * lower * std::conj(e);
    }
  return sum;
}
// s = i Re(e exp(-iwt)): sidebands i e/2 above and, conjugated, -i e/2 below.
Phasor LinearResponse::to_phase(Injection const& i) const { return injected(i, 0.5 * i_unit, -0.5 * i_unit); }
Phasor LinearResponse::to_amplitude(Injection const& i) const { return injected(i, 0.5, 0.5); }

Phasor LinearResponse::weight(std::uint32_t port, bool leaving, int side, std::size_t carrier, std::size_t mode) const {
  return weight_[SignalLayout(network_, field_).field(leaving, side, carrier, port, mode)];
}

Phasor LinearResponse::of_leaving(std::uint32_t port, int side) const {
  return weight(port, true, side, field_.carrier(0));
}
double LinearResponse::seen_quadrature(std::uint32_t port) const {
  return -std::arg(of_leaving(port, 0) * std::conj(of_leaving(port, 1))) / 2;
}

// Calls port(start, size) of the weights at every open port, and loss(start, size, missing) where losses of a component
// add vacuum: 1 - S S*.
template <class Port, class Loss>
void LinearResponse::each_vacuum(Port const& port, Loss const& loss) const {
  SignalLayout const at(network_, field_);
  std::vector<bool> open(network_.ports(), true);
  for (Network::Space const& s : network_.spaces()) open[s.from] = open[s.to] = false;
  for (int side : {0, 1})
    for (std::size_t n = 0; n < field_.carriers().size(); ++n) {
      for (std::uint32_t p = 0; p < network_.ports(); ++p)
        if (open[p]) port(at.field(false, side, n, p, 0), at.modes);
      for (Network::Component const& c : network_.components()) {
        if (!c.bands.empty()) continue;
        Eigen::MatrixXcd const s = with_modes(network_.scattering(c, field_.carriers()[n]), c, field_.bases());
        Eigen::MatrixXcd const missing = Eigen::MatrixXcd::Identity(s.rows(), s.rows()) - s * s.adjoint();
        loss(at.field(true, side, n, c.first_port, 0), s.rows(),
             Eigen::MatrixXcd(side == 0 ? missing : missing.conjugate()));
      }
    }
}

double LinearResponse::quantum_noise(std::span<Squeezing const> squeezed) const {
  double sum = 0;
  each_vacuum([&](Eigen::Index start, Eigen::Index size) { sum += weight_.segment(start, size).squaredNorm(); },
              [&](Eigen::Index start, Eigen::Index size, Eigen::MatrixXcd const& missing) {
                Eigen::VectorXcd const y = weight_.segment(start, size).conjugate();
                sum += std::real(y.dot(missing * y));
              });
  for (Squeezing const& s : squeezed) {
    Phasor const upper = of_leaving(s.port, 0) * std::polar(1.0, s.angle),
                 lower = of_leaving(s.port, 1) * std::polar(1.0, -s.angle);
    Eigen::RowVector2cd const quadratures = Eigen::RowVector2cd(upper + lower, i_unit * (upper - lower)) / std::sqrt(2);
    sum += std::real(Phasor(quadratures * s.covariance * quadratures.adjoint())) - quadratures.squaredNorm();
  }
  // Each sideband of the vacuum has half a quantum per Hz; a read-out D has the one-sided PSD |D|^2/2.
  return hbar * network_.wavenumber() * speed_of_light / 4 * sum;
}

Phasor LinearResponse::vacuum_correlation(LinearResponse const& other) const {
  Phasor sum = 0;
  each_vacuum([&](Eigen::Index start,
                  Eigen::Index size) { sum += other.weight_.segment(start, size).dot(weight_.segment(start, size)); },
              [&](Eigen::Index start, Eigen::Index size, Eigen::MatrixXcd const& missing) {
                Eigen::VectorXcd const a = weight_.segment(start, size).conjugate(),
                                       b = other.weight_.segment(start, size).conjugate();
                sum += a.dot(missing * b);
              });
  return hbar * network_.wavenumber() * speed_of_light / 4 * sum;
}

}  // namespace straytrace::ifo
