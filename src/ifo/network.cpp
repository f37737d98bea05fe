// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/network.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "base/errors.hpp"
#include "ifo/network_ways.hpp"

namespace straytrace::ifo {

SparseSolver::SparseSolver(Sparse matrix, char const* what) : matrix_(std::move(matrix)), what_(what) {
  factors_.compute(matrix_);
}

Eigen::VectorXcd SparseSolver::solve(Eigen::VectorXcd const& right) const {
  Eigen::VectorXcd x;
  if (factors_.info() == Eigen::Success) x = factors_.solve(right);
  bool const good = factors_.info() == Eigen::Success && x.allFinite() &&
                    (matrix_ * x - right).norm() <= 1e-12 * (matrix_.norm() * x.norm() + right.norm());
  if (!good) throw NumericalError(std::string("the network has no unique solution for ") + what_);
  return x;
}

Phasor Suspension::compliance(double hz) const {
  double const w = 2 * pi * hz, w0 = 2 * pi * resonance;
  return mass < infinity ? 1.0 / (mass * Phasor(w0 * w0 - w * w, -w0 * w0 * loss)) : 0.0;
}

bool Network::Component::reflects(std::uint32_t out, std::uint32_t in) const {
  return kind == Kind::mirror ? out == in : kind == Kind::splitter && (out ^ 1) == in;
}

std::string Network::Component::port_name(std::uint32_t number) const {
  switch (kind) {
    case Kind::mirror:
      return name + (number == 0 ? ".front" : ".back");
    case Kind::splitter:
      return name + "." + std::to_string(number + 1);
    case Kind::laser:
    case Kind::dump:
      return name;
    default:
      return name + (number == 0 ? ".in" : ".out");
  }
}

Eigen::MatrixXcd Network::scattering(Component const& c, double hz) const {
  Eigen::MatrixXcd s = c.scattering;
  if (polarisation_ == LinearPolarisation::p)
    for (std::uint32_t out = 0; out < c.ports; ++out)
      for (std::uint32_t in = 0; in < c.ports; ++in)
        if (c.reflects(out, in)) s(out, in) = -s(out, in);
  if (c.displacement == 0) return s;
  Eigen::MatrixXcd const phases = (i_unit * wavenumber(hz) * c.displacement * c.path.cast<Phasor>()).array().exp();
  return s.cwiseProduct(phases);
}

ComponentId Network::add(Component component) {
  component.first_port = ports_;
  ports_ += component.ports;
  components_.push_back(std::move(component));
  return {std::uint32_t(components_.size() - 1)};
}

void Network::replace(ComponentId id, Component component) {
  Component& old = components_.at(id.value);
  if (old.ports != component.ports) throw std::invalid_argument("'" + old.name + "' has another number of ports");
  component.first_port = old.first_port;
  old = std::move(component);
}

namespace {

// Fills in what all components have.
Network::Component finished(Network::Component c, std::string name, Network::Component::Kind kind) {
  c.name = std::move(name);
  c.kind = kind;
  c.ports = std::uint32_t(c.scattering.rows());
  if (c.path.size() == 0) c.path = Eigen::MatrixXd::Zero(c.ports, c.ports);
  c.push.resize(c.ports);
  return c;
}

Network::Component interface_of(std::string name, MirrorParameters const& p, bool splitter) {
  double const reflection = 1 - p.transmission - p.loss;
  if (!(p.transmission >= 0 && p.loss >= 0 && reflection >= 0))
    throw std::invalid_argument("transmission and loss of '" + name + "' must not be negative nor exceed 1 together");
  Phasor const r = i_unit * std::sqrt(reflection), t = std::sqrt(p.transmission);
  double const cosine = std::cos(p.incidence);
  Network::Component c;
  c.stated = p;
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
  using Kind = Network::Component::Kind;
  return finished(std::move(c), std::move(name), splitter ? Kind::splitter : Kind::mirror);
}

// Bands of exp(i m cos(wt + phase)), upper ones exp(-iwt): i^s J_s e^{-i s phase}.
std::vector<Phasor> phase_bands(ModulatorParameters const& p) {
  std::vector<Phasor> bands;
  for (int s = -p.order; s <= p.order; ++s) {
    double const sign = (s < 0) != (p.index < 0) && s % 2 != 0 ? -1 : 1;  // J_s of -s and of -index
    Phasor const turn = p.phase == 0 ? 1.0 : std::polar(1.0, -s * p.phase);
    bands.push_back(std::pow(i_unit, s) * sign * std::cyl_bessel_j(std::abs(s), std::fabs(p.index)) * turn);
  }
  return bands;
}

// All light passes, both ways.
Eigen::MatrixXcd straight() {
  Eigen::MatrixXcd s = Eigen::MatrixXcd::Zero(2, 2);
  s(1, 0) = s(0, 1) = 1;
  return s;
}

}  // namespace

Network::Component Network::mirror(std::string name, MirrorParameters const& p) {
  return interface_of(std::move(name), p, false);
}
Network::Component Network::splitter(std::string name, MirrorParameters const& p) {
  return interface_of(std::move(name), p, true);
}

Network::Component Network::dump(std::string name) {
  Component c;
  c.scattering = Eigen::MatrixXcd::Zero(1, 1);
  return finished(std::move(c), std::move(name), Component::Kind::dump);
}

Network::Component Network::laser(std::string name, LaserParameters const& p) {
  Component c;
  c.stated = p;
  c.scattering = Eigen::MatrixXcd::Zero(1, 1);
  c.emits = std::polar(std::sqrt(p.power), p.phase);
  return finished(std::move(c), std::move(name), Component::Kind::laser);
}

Network::Component Network::isolator(std::string name, IsolatorParameters const& p) {
  Component c;
  c.stated = p;
  c.scattering = Eigen::MatrixXcd::Zero(2, 2);
  c.scattering(1, 0) = std::sqrt(p.transmission);
  c.scattering(0, 1) = std::sqrt(p.isolation);
  return finished(std::move(c), std::move(name), Component::Kind::isolator);
}

Network::Component Network::lens(std::string name, LensParameters const& p) {
  Component c;
  c.stated = p;
  c.scattering = straight();
  return finished(std::move(c), std::move(name), Component::Kind::lens);
}

Network::Component Network::aperture(std::string name, ApertureParameters const& p) {
  Component c;
  c.stated = p;
  c.scattering = straight();
  return finished(std::move(c), std::move(name), Component::Kind::aperture);
}

Network::Component Network::modulator(std::string name, ModulatorParameters const& p) {
  Component c;
  c.stated = p;
  c.scattering = straight();  // of the bands below
  c.modulation = p.hz;
  c.carrier_alone = p.of == ModulatorParameters::Of::carrier;
  if (p.kind == ModulatorParameters::Kind::phase) {
    c.bands = phase_bands(p);
  } else {
    Phasor const side = std::polar(p.index / 4, p.phase);
    c.bands = {side, 1 - p.index / 2, std::conj(side)};
  }
  return finished(std::move(c), std::move(name), Component::Kind::modulator);
}

std::uint32_t Network::number_of(NetworkPort p) const {
  Component const& c = at(p.component);
  if (p.number >= c.ports) throw std::out_of_range("'" + c.name + "' has no such port");
  return c.first_port + p.number;
}

ComponentId Network::owner_of(std::uint32_t port) const {
  for (std::size_t i = 0; i < components_.size(); ++i)
    if (port - components_[i].first_port < components_[i].ports) return {std::uint32_t(i)};
  throw std::out_of_range("the network has no such port");
}

std::string Network::port_name(std::uint32_t port) const {
  Component const& c = at(owner_of(port));
  return c.port_name(port - c.first_port);
}
std::string Network::space_name(std::size_t space) const {
  return port_name(spaces_.at(space).from) + ">" + port_name(spaces_.at(space).to);
}

void Network::link(NetworkPort a, NetworkPort b, double length, double phase, std::string origin) {
  Space const s{number_of(a), number_of(b), length, phase, std::move(origin)};
  for (Space const& other : spaces_)
    for (std::uint32_t end : {other.from, other.to})
      if (end == s.from || end == s.to) throw std::invalid_argument("a port can have only one space");
  spaces_.push_back(s);
}

void Network::unlink(std::uint32_t port) {
  std::erase_if(spaces_, [&](Space const& s) { return s.from == port || s.to == port; });
}
void Network::change(std::size_t space, double length, double phase) {
  spaces_.at(space).length = length;
  spaces_.at(space).phase = phase;
}

void Network::move(ComponentId id, double displacement) {
  Component& c = components_.at(id.value);
  c.displacement = displacement;
  if (auto* p = std::get_if<MirrorParameters>(&c.stated)) p->displacement = displacement;
}

void Network::shape(ComponentId id, std::optional<double> curvature, std::optional<std::array<double, 2>> tilt,
                    std::optional<double> curvature_across, std::string const& origin) {
  auto& p = std::get<MirrorParameters>(components_.at(id.value).stated);
  if (curvature) p.curvature_across = curvature_across;
  p.curvature = curvature.value_or(p.curvature);
  p.tilt = tilt.value_or(p.tilt);
  if (!origin.empty()) p.origin = origin;
}

void Network::hold() {
  for (Component& c : components_) {
    c.suspension = {};
    if (auto* p = std::get_if<MirrorParameters>(&c.stated)) p->suspension = {};
  }
}

std::optional<ComponentId> Network::search(std::string const& name) const {
  for (std::size_t i = 0; i < components_.size(); ++i)
    if (components_[i].name == name) return ComponentId{std::uint32_t(i)};
  return {};
}
ComponentId Network::find(std::string const& name) const {
  if (auto const id = search(name)) return *id;
  throw std::out_of_range("there is no component '" + name + "'");
}

std::vector<double> Network::carriers() const {
  std::vector<double> all{0};
  for (Component const& c : components_) {
    std::vector<double> const before = c.carrier_alone ? std::vector<double>{0} : all;
    int const order = int(c.bands.size()) / 2;
    for (int s = -order; s <= order; ++s)
      for (double const f : before) all.push_back(f + s * c.modulation);
  }
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end(), [](double a, double b) { return b - a < 1e-3; }), all.end());
  return all;
}

}  // namespace straytrace::ifo
