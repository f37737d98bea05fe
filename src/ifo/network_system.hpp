// SPDX-License-Identifier: BSD-3-Clause
// What the solvers of a network share: every way of light through components and spaces, and sparse linear systems.
#pragma once

#include <Eigen/SparseLU>

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "base/message.hpp"
#include "ifo/network.hpp"

namespace straytrace::network_detail {

inline Phasor const i_unit{0, 1};

// Number of the carrier at this frequency, when it is one that is kept.
inline std::optional<std::size_t> carrier_at(std::span<double const> carriers, double hz) {
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
inline double phase_along(Network::Space const& s, double hz) {
  return s.phase + 2 * pi * hz * s.length / speed_of_light;
}

using Sparse = Eigen::SparseMatrix<Phasor>;
using Entries = std::vector<Eigen::Triplet<Phasor>>;

// Solves for one right-hand side; checks the residual (a backward error).
inline Eigen::VectorXcd solved(Sparse const& matrix, Eigen::VectorXcd const& right, char const* what) {
  Eigen::SparseLU<Sparse> solver;
  solver.compute(matrix);
  Eigen::VectorXcd x;
  if (solver.info() == Eigen::Success) x = solver.solve(right);
  bool const good = solver.info() == Eigen::Success && x.allFinite() &&
                    (matrix * x - right).norm() <= 1e-12 * (matrix.norm() * x.norm() + right.norm());
  if (!good) throw NumericalError(std::string("the network has no single answer for ") + what);
  return x;
}

}  // namespace straytrace::network_detail
