// SPDX-License-Identifier: BSD-3-Clause
// All ways of light through the components and spaces of a network, and sparse linear systems. Inside the module.
#pragma once

#include <Eigen/SparseCore>

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/math/constants.hpp"
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

std::vector<Eigen::MatrixXcd> scattering_by_carrier(Network const&, Network::Component const&,
                                                    std::vector<double> const& carriers);

// Phase along a space, rad, of light at `hz` from the laser.
inline double phase_along(Network::Space const& s, double hz) {
  return s.phase + 2 * pi * hz * s.length / speed_of_light;
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

// Solves for one right-hand side; checks the residual (a backward error).
Eigen::VectorXcd solved(Sparse const& matrix, Eigen::VectorXcd const& right, char const* what);

}  // namespace straytrace::ifo
