// SPDX-License-Identifier: BSD-3-Clause
// The kept paths of a run traced again, for the laws at their vertices: what other BSDFs and coatings make of their
// light (docs/theory/decisions.md, eq. D.7).
#pragma once

#include <vector>

#include "trace/coupling.hpp"
#include "trace/steered_world.hpp"
#include "trace/tally/replay.hpp"

namespace straytrace::trace {

// ln of the factor on the light of each kept path, by class and record, with that of the beams that it leaves and joins
// (their shares of the main mode, eq. 1.1); NaN: the path is not known. Empty: a class that is computed, not traced.
using PathFactors = std::vector<std::vector<double>>;

// Refers to the world, which must outlive it.
class PathLaws {
 public:
  PathLaws(SteeredWorld const&, CouplingTable const&);

  // With the BSDFs and coatings of another world of the same geometry. Minus infinity: a BSDF is zero there.
  PathFactors factors(World const& other) const;
  // By material: the largest ratio of its BSDF at a vertex of a kept path; 0: none scatters there.
  std::vector<double> largest_ratios(World const& other) const;

 private:
  struct Path {
    std::vector<PassedVertex> vertices;  // empty: not known
    std::uint32_t source = 0, goal = 0;  // footprints, or a receiver
  };
  double log_factor(WorldView const& before, WorldView const& after, Path const&) const;

  World const& world_;
  std::vector<std::vector<Path>> paths_;  // by class and record
};

}  // namespace straytrace::trace
