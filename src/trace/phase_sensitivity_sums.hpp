// SPDX-License-Identifier: BSD-3-Clause
// Second moments of the phase sensitivities of a route, as sums over histories: they need no kept paths, so their error
// falls with the number of histories without end (docs/theory/errors.md, Second moments of the phase sensitivities).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "trace/coupling.hpp"

namespace straytrace {

class World;
struct BlockSums;

// Of a sample of paths whose weights are without bias: the sums over many blocks are those of all paths in the mean.
struct PhaseSensitivitySums {
  // More pairs of bodies than that in one replica are too many to be summed; part of the run-file schema.
  static constexpr std::size_t most_pairs = 32;

  std::uint64_t paths = 0;                        // drawn
  std::array<double, replica_count> weight = {};  // sum of their weights, by replica
  std::vector<PhaseSensitivityProduct> products;  // ascending by replica, first and second body
  bool given_up = false;                          // too many pairs, or blocks that did not sum them: all else is empty

  void add(std::size_t replica, double weight,
           std::vector<PhaseSensitivity> const& phase_sensitivities);  // a path, phase sensitivities ascending by body
  void add(PhaseSensitivitySums const& other, double factor = 1);
  void give_up();
};

// Draws paths of a block that was traced, at most 32 on all routes to ports together (part of the run-file schema), and
// adds their phase sensitivities to the sums. A route is drawn as often as the root of its light says, and within it a
// path with the chance of its coupling: priority sampling (docs/theory/errors.md) of coupling over the root of that of
// the route in the block. `replica`: of the block. What is drawn is a function of the scores of the block.
void sum_phase_sensitivities(World const&, std::uint64_t seed, std::size_t replica, BlockSums& block);

// What a row of the coupling table holds of them, `drawn` and kept paths taken together by their numbers. Where all
// scores were kept, they alone. T_r: what replica r adds to the mean; with A_r and B_r its sums of weights and
// products, its contribution is T_r B/A + T (B_r - A_r B/A)/A: the ratio to first order.
std::vector<PhaseSensitivityProduct> phase_sensitivity_moments(CouplingClass const&, PhaseSensitivitySums const& drawn,
                                                               bool all_kept, std::uint64_t histories,
                                                               std::uint64_t block_size);

// Adds rows as lever_moments() makes them; false when the pairs of bodies are too many, and `into` is then empty.
bool add_moments(std::vector<PhaseSensitivityProduct>& into, std::vector<PhaseSensitivityProduct> const& from);

}  // namespace straytrace
