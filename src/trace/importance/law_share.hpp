// SPDX-License-Identifier: BSD-3-Clause
// How much of the mixture the scatter law keeps at one side of a patch (alpha of docs/theory/sampling.md).
#pragma once

#include <vector>

#include "trace/importance/exchange.hpp"

namespace straytrace {

// What the choice is made for: one port or receiver.
struct Worth {
  std::vector<double> adjoint;  // by sides
  std::vector<double> hops;     // still to come from each side, on average over the score
};

// The share, at least `least`, that keeps the variance low, where `targets` are drawn otherwise and light goes where
// `arriving` says, of `emitted` in all. With F_j the share of it that arrives on side j, q_j the probability of the
// target, A_j the adjoint, the second moment of the score over its square is, for the whole and for every part of the
// scene,
//   R = sum_j F_j^2 A_j^2 / (alpha F_j + (1 - alpha) q_j) / (sum_j F_j A_j)^2        (within patches by quadrature)
// R - 1 of the whole is paid at every hop still to come, R of a part once: by a path through a part that the law would
// seldom find. The share chosen has the least
//   sum over goals of  ln(1 + hops (R - 1)) + 1/4 mean over parts of ln R_part
double best_law_share(Arriving const& arriving, double emitted, std::vector<Target> const& targets,
                      std::vector<Worth> const& worths, std::size_t side, std::vector<std::uint32_t> const& part_of,
                      double least);

}  // namespace straytrace
