// SPDX-License-Identifier: BSD-3-Clause
// All ways of light through the components and spaces of a network, and sparse linear systems. Inside the module.
#pragma once

#include <Eigen/SparseLU>

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/math/constants.hpp"
#include "ifo/mode_bases.hpp"
#include "ifo/network.hpp"

namespace straytrace::ifo {

inline constexpr Phasor i_unit{0, 1};

// Number of the carrier at this frequency, if it is included.
inline std::optional<std::size_t> carrier_at(std::span<double const> carriers, double hz) {
  for (std::size_t n = 0; n < carriers.size(); ++n)
    if (std::fabs(carriers[n] - hz) < 1e-3) return n;
  return {};
}

// The band s of a modulator that leads from one carrier to another; 0: none but for the carrier itself.
inline bool makes(Network::Component const& modulator, double from, int s) {
  if (s == 0 || !modulator.carrier_alone) return true;
  double const order = double(modulator.bands.size() / 2), band = from / modulator.modulation;
  double const whole = std::round(band);
  return std::fabs(from - whole * modulator.modulation) < 1e-3 && std::fabs(whole) <= order &&
         std::fabs(whole + s) <= order;
}

// Calls way(out, in, m, n, amplitude) for every way through the component, from carrier n at port `in` of it to carrier
// m at port `out`. `scattering`: by carrier.
template <class Way>
void for_each_way(Network::Component const& c, std::span<Eigen::MatrixXcd const> scattering,
                  std::vector<double> const& carriers, Way const& way) {
  int const order = int(c.bands.size()) / 2;
  for (std::uint32_t out = 0; out < c.ports; ++out)
    for (std::uint32_t in = 0; in < c.ports; ++in)
      for (std::size_t n = 0; n < carriers.size(); ++n) {
        Phasor const amplitude = scattering[n](out, in);
        if (amplitude == 0.0) continue;
        if (c.bands.empty()) {
          way(out, in, n, n, amplitude);
          continue;
        }
        for (int s = -order; s <= order; ++s)
          if (!makes(c, carriers[n], s))
            continue;
          else if (auto const m = carrier_at(carriers, carriers[n] + s * c.modulation))
            way(out, in, *m, n, amplitude * c.bands[std::size_t(s + order)]);
      }
}

// Calls use(row, column, amplitude) for every pair of modes that a way couples: the mode that leaves at port `out` of
// the component, and the one that enters at `in`. Plane waves: once.
template <class Use>
void for_each_mode_pair(ModeBases const* bases, Network::Component const& c, std::uint32_t out, std::uint32_t in,
                        Phasor amplitude, Use const& use) {
  if (!bases) {
    use(std::size_t(0), std::size_t(0), amplitude);
    return;
  }
  Eigen::MatrixXcd const& k = bases->coupling(c.first_port + out, in);
  for (Eigen::Index column = 0; column < k.cols(); ++column)
    for (Eigen::Index row = 0; row < k.rows(); ++row)
      if (k(row, column) != 0.0) use(std::size_t(row), std::size_t(column), amplitude * k(row, column));
}

std::vector<Eigen::MatrixXcd> scattering_by_carrier(Network const&, Network::Component const&,
                                                    std::vector<double> const& carriers);

// Amplitude of the carrier from a port of a component to another, by their numbers there.
inline Phasor carrier_way(Network const& n, Network::Component const& c, std::uint32_t out, std::uint32_t in) {
  return n.scattering(c, 0)(out, in) * (c.bands.empty() ? 1.0 : c.bands[c.bands.size() / 2]);
}

// Phase along a space, rad, of light at `hz` from the laser.
inline double phase_along(Network::Space const& s, double hz) {
  return s.phase + 2 * pi * hz * s.length / speed_of_light;
}

// Factor of a mode along a space, of light at `hz` from the laser.
inline Phasor turn_along(Network const& n, ModeBases const* bases, std::size_t space, double hz, std::size_t mode) {
  Phasor const turn = std::polar(1.0, phase_along(n.spaces()[space], hz));
  return bases ? turn * bases->turn(space, mode) : turn;
}

// The port at the other end of the space of each port, and the number of that space; the number of ports without one.
std::vector<std::pair<std::uint32_t, std::size_t>> neighbours(Network const&);

// Pairs of carriers whose beat is at `hz`: calls beat(higher, lower).
template <class Beat>
void for_each_beat(std::span<double const> carriers, double hz, Beat const& beat) {
  for (std::size_t n = 0; n < carriers.size(); ++n)
    if (auto const m = carrier_at(carriers, carriers[n] + hz)) beat(*m, n);
}

using Sparse = Eigen::SparseMatrix<Phasor>;
using Entries = std::vector<Eigen::Triplet<Phasor>>;

// A factored matrix. solve() checks the residual (a backward error); NumericalError names `what` has no solution.
class SparseSolver {
 public:
  SparseSolver(Sparse matrix, char const* what);
  Eigen::VectorXcd solve(Eigen::VectorXcd const& right) const;

 private:
  Sparse matrix_;
  char const* what_;
  Eigen::SparseLU<Sparse> factors_;
};
inline Eigen::VectorXcd solved(Sparse matrix, Eigen::VectorXcd const& right, char const* what) {
  return SparseSolver(std::move(matrix), what).solve(right);
}

}  // namespace straytrace::ifo
