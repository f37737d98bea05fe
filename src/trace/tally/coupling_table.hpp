// SPDX-License-Identifier: BSD-3-Clause
// Sums of a trace -> coupling table, with named routes and replayed records; routes taken from their reverse.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "trace/coupling.hpp"
#include "trace/result.hpp"
#include "trace/steered_world.hpp"
#include "trace/tally/replay.hpp"

namespace straytrace::trace {

using ReplayScores = std::function<std::vector<ReplayedScore>(std::span<ScoreAddress const>)>;

// The same for any number of threads (0: all cores). `replay`: replay_scores(), by whomever.
CouplingTable make_coupling_table(SteeredWorld const&, BlockSums const& total, std::uint64_t seed, unsigned threads,
                                  ReplayScores const& replay);

// A route and its reverse have the same coupling, phase sensitivities and optical length (reciprocity,
// docs/theory/path_integral.md, eq. 1.2; case A25). Sampling is not symmetric: a connection ends a path on a lit
// surface, but cannot reflect into the mode of another one (`ITM·S > baffle·S > ITM·R > ETM·S`), while `ETM·S > ITM·R >
// baffle·S > ITM·S` is easy to sample.

// A row of the coupling table under construction.
struct MadeClass {
  CouplingClass row;
  Moments moments;
  std::uint32_t beam = 0;   // of the source
  PortId back;              // port of the source's footprint: where the reverse rejoins
  bool reversible = false;  // both ends belong to one beam and both emit and receive; not its own reverse
};

// Hash of a route of these steps, as in the trace.
std::uint64_t hash_of_route(std::vector<PathStep> const& steps, std::uint32_t beam, std::uint32_t end);
// Of the row `other` of an end and a C_rev: the same in every run, whatever routes it sums.
std::uint64_t hash_of_other(std::uint32_t end, double reverse);
std::vector<PathStep> backwards(std::vector<PathStep> steps);

// Replaces the numbers of every reversible route that is not trusted by those of its reverse if that has more scores;
// adds routes that were never sampled. Two trusted routes stay unchanged. The choice uses the number of histories that
// scored, never their value, so it causes no bias.
void mirror_poorly_sampled(std::vector<MadeClass>& classes);

// A deterministic class: light that the walk cannot sample, computed once (docs/theory/diffraction.md), without a
// Monte-Carlo error. The weights of the records, all positive, sum to its coupling, which counts the
// ordered path alone; `reverse` is C_rev (docs/theory/path_integral.md, eq. 1.5). The hash names kind, steps and port.
CouplingClass deterministic_class(ClassKind, std::vector<PathStep> steps, PortId, double reverse,
                                  std::vector<PathRecord>, std::string statement);

// Adds deterministic classes to the table, in the order of hashes. Throws NumericalError if two classes share a hash.
void add_deterministic(CouplingTable&, std::vector<CouplingClass> const&);

}  // namespace straytrace::trace
