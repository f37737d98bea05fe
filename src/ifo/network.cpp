// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/network.hpp"

#include <Eigen/SparseLU>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "base/errors.hpp"

namespace straytrace::ifo {
namespace {

// Shared by the solvers of a network: all paths of light through components and spaces, and sparse linear systems.

Phasor const i_unit{0, 1};

// Number of the carrier at this frequency, if it is included.
std::optional<std::size_t> carrier_at(std::span<double const> carriers, double hz) {
  for (std::size_t n = 0; n < carriers.size(); ++n)
    if (std::fabs(carriers[n] - hz) < 1e-3) return n;
  return {};
}

// Calls way(out, in, m, n, amplitude) for every way through the component, from carrier n at port `in` of it to carrier
// m at port `out`.
template <class Way>
void for_each_way(Network::Component const& c, Eigen::MatrixXcd const& scattering, std::vector<double> const& carriers,
                  Way const& way) {
  int const order = int(c.bands.size()) / 2;
  for (std::uint32_t out = 0; out < c.ports; ++out)
    for (std::uint32_t in = 0; in < c.ports; ++in) {
      Phasor const amplitude = scattering(out, in);
      if (amplitude == 0.0) continue;
      for (std::size_t n = 0; n < carriers.size(); ++n) {
        if (c.bands.empty()) {
          way(out, in, n, n, amplitude);
          continue;
        }
        for (int s = -order; s <= order; ++s)
          if (auto const m = carrier_at(carriers, carriers[n] + s * c.modulation))
            way(out, in, *m, n, amplitude * c.bands[std::size_t(s + order)]);
      }
    }
}

// Phase along a space, rad, of light at `hz` from the laser.
double phase_along(Network::Space const& s, double hz) { return s.phase + 2 * pi * hz * s.length / speed_of_light; }

using Sparse = Eigen::SparseMatrix<Phasor>;
using Entries = std::vector<Eigen::Triplet<Phasor>>;

// Solves for one right-hand side; checks the residual (a backward error).
Eigen::VectorXcd solved(Sparse const& matrix, Eigen::VectorXcd const& right, char const* what) {
  Eigen::SparseLU<Sparse> solver;
  solver.compute(matrix);
  Eigen::VectorXcd x;
  if (solver.info() == Eigen::Success) x = solver.solve(right);
  bool const good = solver.info() == Eigen::Success && x.allFinite() &&
                    (matrix * x - right).norm() <= 1e-12 * (matrix.norm() * x.norm() + right.norm());
  if (!good) throw NumericalError(std::string("the network has no unique solution for ") + what);
  return x;
}

}  // namespace

Phasor Suspension::compliance(double hz) const {
  double const w = 2 * pi * hz, w0 = 2 * pi * resonance;
  return mass < infinity ? 1.0 / (mass * Phasor(w0 * w0 - w * w, -w0 * w0 * loss)) : 0.0;
}

Eigen::MatrixXcd Network::Component::scattering_at_place(double wavenumber) const {
  if (displacement == 0) return scattering;
  Eigen::MatrixXcd const phases = (i_unit * wavenumber * displacement * path.cast<Phasor>()).array().exp();
  return scattering.cwiseProduct(phases);
}

ComponentId Network::add(Component component) {
  component.first_port = ports_;
  component.ports = std::uint32_t(component.scattering.rows());
  if (component.path.size() == 0) component.path = Eigen::MatrixXd::Zero(component.ports, component.ports);
  component.push.resize(component.ports);
  ports_ += component.ports;
  components_.push_back(std::move(component));
  return {std::uint32_t(components_.size() - 1)};
}

ComponentId Network::add_interface(std::string name, MirrorParameters const& p, bool splitter) {
  double const reflection = 1 - p.transmission - p.loss;
  if (!(p.transmission >= 0 && p.loss >= 0 && reflection >= 0))
    throw std::invalid_argument("transmission and loss of '" + name + "' must not be negative nor exceed 1 together");
  Phasor const r = i_unit * std::sqrt(reflection), t = std::sqrt(p.transmission);
  double const cosine = std::cos(p.incidence);
  Component c;
  c.name = std::move(name);
  c.displacement = p.displacement;
  c.suspension = p.suspension;
  int const n = splitter ? 4 : 2, side = n / 2;  // ports of one side
  c.scattering = Eigen::MatrixXcd::Zero(n, n);
  c.path = Eigen::MatrixXd::Zero(n, n);
  for (int in = 0; in < n; ++in) {
    bool const front = in < side;
    int const reflected = splitter ? (in ^ 1) : in, transmitted = splitter ? (in ^ 2) : 1 - in;
    c.scattering(reflected, in) = r;
    c.scattering(transmitted, in) = t;
    c.path(reflected, in) = front ? 2 * cosine : -2 * cosine;
    c.push.push_back(front ? cosine : -cosine);
  }
  return add(std::move(c));
}
ComponentId Network::add_mirror(std::string name, MirrorParameters const& p) {
  return add_interface(std::move(name), p, false);
}
ComponentId Network::add_splitter(std::string name, MirrorParameters const& p) {
  return add_interface(std::move(name), p, true);
}

ComponentId Network::add_dump(std::string name) { return add_laser(std::move(name), 0); }

ComponentId Network::add_laser(std::string name, double power, double phase) {
  Component c;
  c.name = std::move(name);
  c.scattering = Eigen::MatrixXcd::Zero(1, 1);
  c.emits = std::polar(std::sqrt(power), phase);
  return add(std::move(c));
}

ComponentId Network::add_isolator(std::string name, double isolation, double transmission) {
  Component c;
  c.name = std::move(name);
  c.scattering = Eigen::MatrixXcd::Zero(2, 2);
  c.scattering(1, 0) = std::sqrt(transmission);
  c.scattering(0, 1) = std::sqrt(isolation);
  return add(std::move(c));
}

ComponentId Network::add_modulator(std::string name, double index, double hz, int order) {
  Component c;
  c.name = std::move(name);
  c.scattering = Eigen::MatrixXcd::Zero(2, 2);
  c.scattering(1, 0) = c.scattering(0, 1) = 1;  // of the bands below
  c.modulation = hz;
  for (int s = -order; s <= order; ++s) {  // exp(i m sin): i^s J_s for a cosine drive
    double const sign = s < 0 && s % 2 != 0 ? -1 : 1;
    c.bands.push_back(std::pow(i_unit, s) * sign * std::cyl_bessel_j(std::abs(s), index));
  }
  return add(std::move(c));
}

std::uint32_t Network::number_of(NetworkPort p) const {
  Component const& c = at(p.component);
  if (p.number >= c.ports) throw std::out_of_range("'" + c.name + "' has no such port");
  return c.first_port + p.number;
}

void Network::link(NetworkPort a, NetworkPort b, double length, double phase) {
  Space const s{number_of(a), number_of(b), length, phase};
  for (Space const& other : spaces_)
    for (std::uint32_t end : {other.from, other.to})
      if (end == s.from || end == s.to) throw std::invalid_argument("a port can have only one space");
  spaces_.push_back(s);
}

void Network::move(ComponentId id, double displacement) { components_.at(id.value).displacement = displacement; }

ComponentId Network::find(std::string const& name) const {
  for (std::size_t i = 0; i < components_.size(); ++i)
    if (components_[i].name == name) return {std::uint32_t(i)};
  throw std::out_of_range("there is no component '" + name + "'");
}

std::vector<double> Network::carriers() const {
  std::vector<double> all{0};
  for (Component const& c : components_) {
    std::vector<double> const before = all;
    int const order = int(c.bands.size()) / 2;
    for (int s = -order; s <= order; ++s)
      for (double const f : before) all.push_back(f + s * c.modulation);
  }
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end(), [](double a, double b) { return b - a < 1e-3; }), all.end());
  return all;
}

// Unknowns: the fields leaving every port, all ports of carrier 0 first. The field entering a port left the other end
// of its space.
SteadyField::SteadyField(Network const& network) : carriers_(network.carriers()) {
  auto const ports = Eigen::Index(network.ports()), size = ports * Eigen::Index(carriers_.size());
  std::vector<std::pair<std::uint32_t, std::size_t>> other(network.ports(), {network.ports(), 0});
  for (std::size_t i = 0; i < network.spaces().size(); ++i) {
    Network::Space const& s = network.spaces()[i];
    other[s.from] = {s.to, i};
    other[s.to] = {s.from, i};
  }
  auto const arriving = [&](std::uint32_t port, std::size_t n) {
    return std::polar(1.0, phase_along(network.spaces()[other[port].second], carriers_[n]));
  };
  Entries entries;
  Eigen::VectorXcd source = Eigen::VectorXcd::Zero(size);
  for (Eigen::Index i = 0; i < size; ++i) entries.emplace_back(i, i, 1.0);
  std::size_t const laser = *carrier_at(carriers_, 0);
  for (Network::Component const& c : network.components()) {
    source[Eigen::Index(laser) * ports + c.first_port] += c.emits;
    for_each_way(c, c.scattering_at_place(network.wavenumber()), carriers_,
                 [&](std::uint32_t out, std::uint32_t in, std::size_t m, std::size_t n, Phasor amplitude) {
                   auto const [from, space] = other[c.first_port + in];
                   if (from == network.ports()) return;  // no light enters here
                   entries.emplace_back(Eigen::Index(m) * ports + c.first_port + out, Eigen::Index(n) * ports + from,
                                        -amplitude * arriving(c.first_port + in, n));
                 });
  }
  Sparse matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXcd const left = solved(matrix, source, "the steady light");
  for (std::size_t n = 0; n < carriers_.size(); ++n) {
    out_.push_back(left.segment(Eigen::Index(n) * ports, ports));
    in_.push_back(Eigen::VectorXcd::Zero(ports));
    for (std::uint32_t p = 0; p < network.ports(); ++p)
      if (other[p].first < network.ports()) in_[n][p] = arriving(p, n) * out_[n][other[p].first];
  }
}

double SteadyField::power_in(std::uint32_t port) const {
  double sum = 0;
  for (Eigen::VectorXcd const& field : in_) sum += std::norm(field[port]);
  return sum;
}
double SteadyField::power_out(std::uint32_t port) const {
  double sum = 0;
  for (Eigen::VectorXcd const& field : out_) sum += std::norm(field[port]);
  return sum;
}

std::size_t SteadyField::carrier(double hz) const {
  if (auto const n = carrier_at(carriers_, hz)) return *n;
  throw std::out_of_range("no carrier at this frequency");
}

namespace {

using Phasor = std::complex<double>;

QuadratureCovariance rotation(double angle) {
  QuadratureCovariance m;
  m << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return m;
}

// An operation on both sidebands, the lower one conjugated, expressed for the quadratures.
Eigen::Matrix2cd in_quadratures(Phasor upper, Phasor lower) {
  Phasor const i{0, 1};
  Phasor const sum = (upper + lower) / 2.0, difference = i * (upper - lower) / 2.0;
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

namespace {

// Places of unknowns, and of the equations that define them: for both sidebands (0: upper; 1: the complex conjugate of
// the lower) of every carrier what enters and what leaves each port; then the displacement of each component.
struct Layout {
  Eigen::Index ports, carriers;
  explicit Layout(Network const& n, SteadyField const& f)
      : ports(n.ports()), carriers(Eigen::Index(f.carriers().size())) {}
  Eigen::Index field(bool leaves, int side, std::size_t carrier, std::uint32_t port) const {
    return ((Eigen::Index(leaves) * 2 + side) * carriers + Eigen::Index(carrier)) * ports + port;
  }
  Eigen::Index displacement(std::size_t component) const { return 4 * carriers * ports + Eigen::Index(component); }
};

Phasor sided(int side, Phasor z) { return side == 0 ? z : std::conj(z); }

// The equations, transposed: one solution gives the response to all causes.
class System {
 public:
  System(Network const& network, SteadyField const& field, double hz)
      : network_(network), field_(field), hz_(hz), at_(network, field) {
    size_ = at_.displacement(network.components().size());
    for (Eigen::Index i = 0; i < size_; ++i) entries_.emplace_back(i, i, 1.0);
    for (std::size_t c = 0; c < network.components().size(); ++c) add_component(c);
    for (Network::Space const& s : network.spaces()) {
      add_space(s, s.from, s.to);
      add_space(s, s.to, s.from);
    }
  }
  Layout const& layout() const { return at_; }
  Eigen::VectorXcd weights(Eigen::VectorXcd const& readout) const {
    Sparse matrix(size_, size_);
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    return solved(matrix, readout, "small signals");
  }
  Eigen::Index size() const { return size_; }

 private:
  void depends(Eigen::Index what, Eigen::Index on, Phasor factor) { entries_.emplace_back(on, what, -factor); }

  // a leaves with S a; a displacement x adds i k g x/2 times the carrier that leaves, with the sign of the sideband.
  void add_component(std::size_t number) {
    Network::Component const& c = network_.components()[number];
    double const k = network_.wavenumber();
    Eigen::MatrixXcd const scattering = c.scattering_at_place(k);
    for_each_way(c, scattering, field_.carriers(),
                 [&](std::uint32_t out, std::uint32_t in, std::size_t m, std::size_t n, Phasor amplitude) {
                   Phasor const carrier = amplitude * field_.in(c.first_port + in, n);
                   for (int side : {0, 1}) {
                     Eigen::Index const leaving = at_.field(true, side, m, c.first_port + out);
                     depends(leaving, at_.field(false, side, n, c.first_port + in), sided(side, amplitude));
                     if (c.path(out, in) != 0)
                       depends(leaving, at_.displacement(number),
                               sided(side, i_unit * k * c.path(out, in) / 2.0 * carrier));
                   }
                 });
    if (c.suspension.mass < infinity) add_push(number, c);
  }
  // Force along the displacement: power that comes and goes at the front, less that at the back; P = |E|^2 changes by
  // 2 (E* a + E b).
  void add_push(std::size_t number, Network::Component const& c) {
    Phasor const yields = c.suspension.compliance(hz_) * 2.0 / speed_of_light;
    for (std::uint32_t p = 0; p < c.ports; ++p)
      for (std::size_t n = 0; n < field_.carriers().size(); ++n)
        for (bool const leaves : {false, true}) {
          Phasor const e = leaves ? field_.out(c.first_port + p, n) : field_.in(c.first_port + p, n);
          for (int side : {0, 1})
            depends(at_.displacement(number), at_.field(leaves, side, n, c.first_port + p),
                    yields * c.push[p] * sided(side, std::conj(e)));
        }
  }
  void add_space(Network::Space const& s, std::uint32_t from, std::uint32_t to) {
    for (std::size_t n = 0; n < field_.carriers().size(); ++n)
      for (int side : {0, 1}) {
        double const hz = field_.carriers()[n] + (side == 0 ? hz_ : -hz_);
        depends(at_.field(false, side, n, to), at_.field(true, side, n, from),
                sided(side, std::polar(1.0, phase_along(s, hz))));
      }
  }

  Network const& network_;
  SteadyField const& field_;
  double hz_;
  Layout at_;
  Eigen::Index size_ = 0;
  Entries entries_;
};

// Pairs of carriers whose beat is at `hz`: calls beat(higher, lower).
template <class Beat>
void for_each_beat(std::span<double const> carriers, double hz, Beat const& beat) {
  for (std::size_t n = 0; n < carriers.size(); ++n)
    if (auto const m = carrier_at(carriers, carriers[n] + hz)) beat(*m, n);
}

Eigen::VectorXcd row_of(Readout const& r, SteadyField const& field, Layout const& at, Eigen::Index size) {
  Eigen::VectorXcd row = Eigen::VectorXcd::Zero(size);
  auto const add = [&](int side, std::size_t n, Phasor factor) { row[at.field(false, side, n, r.port)] += factor; };
  if (r.kind == Readout::Kind::motion) {
    for (auto const& [id, factor] : r.moving) row[at.displacement(id.value)] += factor;
  } else if (r.kind == Readout::Kind::homodyne) {
    std::size_t const n = field.carrier(0);
    add(0, n, std::polar(1.0, -r.angle));
    add(1, n, std::polar(1.0, r.angle));
  } else if (r.kind == Readout::Kind::power) {
    for (std::size_t n = 0; n < field.carriers().size(); ++n) {
      add(0, n, 2.0 * std::conj(field.in(r.port, n)));
      add(1, n, 2.0 * field.in(r.port, n));
    }
  } else {
    // The beat of carriers m above n is 2 Re(E_m E_n* e^{-i w t}); times cos(w t + phase), averaged:
    // Re(E_m E_n* e^{i phase}).
    Phasor const turn = std::polar(1.0, r.angle);
    for_each_beat(field.carriers(), r.hz, [&](std::size_t m, std::size_t n) {
      Phasor const em = field.in(r.port, m), en = field.in(r.port, n);
      add(0, m, std::conj(en) * turn);
      add(1, n, em * turn);
      add(0, n, std::conj(em) * std::conj(turn));
      add(1, m, en * std::conj(turn));
    });
  }
  return row;
}

}  // namespace

LinearResponse::LinearResponse(Network const& network, SteadyField const& field, Readout const& readout, double hz)
    : network_(network), field_(field) {
  System const system(network, field, hz);
  weight_ = system.weights(row_of(readout, field, system.layout(), system.size()));
}

Phasor LinearResponse::to_displacement(ComponentId id) const {
  return weight_[Layout(network_, field_).displacement(id.value)];
}

Phasor LinearResponse::injected(Injection const& i, Phasor upper, Phasor lower) const {
  Layout const at(network_, field_);
  Phasor sum = 0;
  for (std::size_t n = 0; n < field_.carriers().size(); ++n) {
    Phasor const e = std::polar(1.0, i.turn) * (i.of_leaving ? field_.out(i.port, n) : field_.in(i.port, n));
    sum += weight_[at.field(i.joins_leaving, 0, n, i.port)] * upper * e +
           weight_[at.field(i.joins_leaving, 1, n, i.port)] * lower * std::conj(e);
  }
  return sum;
}
// s = i Re(e exp(-iwt)): sidebands i e/2 above and, conjugated, -i e/2 below.
Phasor LinearResponse::to_phase(Injection const& i) const { return injected(i, 0.5 * i_unit, -0.5 * i_unit); }
Phasor LinearResponse::to_amplitude(Injection const& i) const { return injected(i, 0.5, 0.5); }

Phasor LinearResponse::of_leaving(std::uint32_t port, int side) const {
  return weight_[Layout(network_, field_).field(true, side, field_.carrier(0), port)];
}
double LinearResponse::seen_quadrature(std::uint32_t port) const {
  return -std::arg(of_leaving(port, 0) * std::conj(of_leaving(port, 1))) / 2;
}

double LinearResponse::quantum_noise(std::span<Squeezing const> squeezed) const {
  Layout const at(network_, field_);
  std::vector<bool> open(network_.ports(), true);
  for (Network::Space const& s : network_.spaces()) open[s.from] = open[s.to] = false;
  double sum = 0;
  for (int side : {0, 1})
    for (std::size_t n = 0; n < field_.carriers().size(); ++n) {
      for (std::uint32_t p = 0; p < network_.ports(); ++p)
        if (open[p]) sum += std::norm(weight_[at.field(false, side, n, p)]);
      for (Network::Component const& c : network_.components()) {  // losses add vacuum: 1 - S S*
        if (!c.bands.empty()) continue;
        Eigen::MatrixXcd const s = c.scattering_at_place(network_.wavenumber());
        Eigen::MatrixXcd const missing = Eigen::MatrixXcd::Identity(c.ports, c.ports) - s * s.adjoint();
        Eigen::VectorXcd const y = weight_.segment(at.field(true, side, n, c.first_port), c.ports).conjugate();
        sum += std::real(y.dot((side == 0 ? missing : missing.conjugate()) * y));
      }
    }
  for (Squeezing const& s : squeezed) {
    Phasor const upper = of_leaving(s.port, 0) * std::polar(1.0, s.angle),
                 lower = of_leaving(s.port, 1) * std::polar(1.0, -s.angle);
    Eigen::RowVector2cd const quadratures = Eigen::RowVector2cd(upper + lower, i_unit * (upper - lower)) / std::sqrt(2);
    sum += std::real(Phasor(quadratures * s.covariance * quadratures.adjoint())) - quadratures.squaredNorm();
  }
  // Each sideband of the vacuum has half a quantum per Hz; a read-out D has the one-sided PSD |D|^2/2.
  return hbar * network_.wavenumber() * speed_of_light / 4 * sum;
}

}  // namespace straytrace::ifo
