// SPDX-License-Identifier: BSD-3-Clause
#include "ifo/network.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace straytrace {

using network_detail::i_unit;

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
      if (end == s.from || end == s.to) throw std::invalid_argument("a port can have one space only");
  spaces_.push_back(s);
}

void Network::move(ComponentId id, double displacement) { components_.at(id.value).displacement = displacement; }

void Network::retune(NetworkPort p, double phase) {
  std::uint32_t const number = number_of(p);
  for (Space& s : spaces_)
    if (s.from == number || s.to == number) {
      s.phase = phase;
      return;
    }
  throw std::out_of_range("there is no space at this port");
}

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
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end(), [](double a, double b) { return b - a < 1e-3; }), all.end());
  return all;
}

using network_detail::Entries, network_detail::Sparse;

// Unknowns: what leaves every port, all ports of carrier 0 first. What enters a port is what left the other end of its
// space.
SteadyField::SteadyField(Network const& network) : carriers_(network.carriers()) {
  auto const ports = Eigen::Index(network.ports()), size = ports * Eigen::Index(carriers_.size());
  std::vector<std::pair<std::uint32_t, std::size_t>> other(network.ports(), {network.ports(), 0});
  for (std::size_t i = 0; i < network.spaces().size(); ++i) {
    Network::Space const& s = network.spaces()[i];
    other[s.from] = {s.to, i};
    other[s.to] = {s.from, i};
  }
  auto const arriving = [&](std::uint32_t port, std::size_t n) {
    return std::polar(1.0, network_detail::phase_along(network.spaces()[other[port].second], carriers_[n]));
  };
  Entries entries;
  Eigen::VectorXcd source = Eigen::VectorXcd::Zero(size);
  for (Eigen::Index i = 0; i < size; ++i) entries.emplace_back(i, i, 1.0);
  std::size_t const laser = *network_detail::carrier_at(carriers_, 0);
  for (Network::Component const& c : network.components()) {
    source[Eigen::Index(laser) * ports + c.first_port] += c.emits;
    network_detail::for_each_way(
        c, c.scattering_at_place(network.wavenumber()), carriers_,
        [&](std::uint32_t out, std::uint32_t in, std::size_t m, std::size_t n, Phasor amplitude) {
          auto const [from, space] = other[c.first_port + in];
          if (from == network.ports()) return;  // nothing comes in here
          entries.emplace_back(Eigen::Index(m) * ports + c.first_port + out, Eigen::Index(n) * ports + from,
                               -amplitude * arriving(c.first_port + in, n));
        });
  }
  Sparse matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXcd const left = network_detail::solved(matrix, source, "the light that stands in it");
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
  if (auto const n = network_detail::carrier_at(carriers_, hz)) return *n;
  throw std::out_of_range("no carrier at this frequency");
}

}  // namespace straytrace
