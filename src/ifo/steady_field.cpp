// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "ifo/network_system.hpp"

namespace straytrace {

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
