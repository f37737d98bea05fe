// SPDX-License-Identifier: BSD-3-Clause
// One coupling class turned into the spectrum of Im s at its port, with the replicas that give its error.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "noise/strength_nodes.hpp"
#include "trace/coupling.hpp"

namespace straytrace {

using Bins = std::vector<double>;

// PSD of Im s [1/Hz] per bin: all histories, and all but those of one replica (empty where a replica has none).
struct RouteSpectrum {
  Bins psd;
  Bins linear;  // part of psd, as in PhaseSpectrum
  std::array<Bins, replica_count> without;
  Bins drawn;  // variance of psd that drawn paths leave, StrengthNodes::add_variance; empty where all are computed
  bool exact = false;            // of a deterministic class: no replica changes it, so `without` is empty
  double mean_square_phase = 0;  // rad^2, mean over the paths, weighted by power
  // Kept paths, counted as equal ones, that carry the power and that carry the noise: (sum x)^2 / sum x^2. A row of
  // bright still light with a few faint moving paths in it knows its power well and its noise badly.
  double paths_of_power = 0, paths_of_noise = 0;
  bool rests_on_few() const { return paths_of_noise > 0 && paths_of_noise < std::min(30.0, 0.3 * paths_of_power); }
};

// psd = mean * sum over records of (their share) * (their spectrum); each class mean and the shares of its records are
// taken anew without each replica. `first`: number of its first record among the paths of `nodes`.
RouteSpectrum route_spectrum(CouplingTable const&, CouplingClass const&, std::size_t first, StrengthNodes const& nodes,
                             std::span<double const> mean_square_phase);

// Replica of a history: block of 4096 histories modulo their number.
std::size_t replica_of(std::uint64_t history);

// Squared standard error of a mean from its delete-one values; NaN with fewer than two.
double jackknife_variance(std::span<double const> without);

}  // namespace straytrace
