// SPDX-License-Identifier: BSD-3-Clause
// A route and the same route run backwards couple alike (reciprocity, docs/theory/path_integral.md, eq. 1.2; case A25):
// same power, same phase sensitivities, same optical length. Sampling is not symmetric: a connection can end a path on
// a lit surface, but not one that reflects into the mode of another (`ITM·S > baffle·S > ITM·R > ETM·S`), while `ETM·S
// > ITM·R > baffle·S > ITM·S` is easy.
#pragma once

#include <vector>

#include "trace/result.hpp"

namespace straytrace {

// A row of the coupling table while it is made.
struct MadeClass {
  CouplingClass row;
  Moments moments;
  std::uint32_t beam = 0;   // of the source
  PortId back;              // port of the source's footprint: where the reverse rejoins
  bool reversible = false;  // both ends belong to one beam and both emit and receive; not its own reverse
};

// Hash that the trace gives to a route of these steps.
std::uint64_t hash_of_route(std::vector<PathStep> const& steps, std::uint32_t beam, std::uint32_t end);
std::vector<PathStep> backwards(std::vector<PathStep> steps);

// Gives every reversible route that is not trusted the numbers of its reverse, when those stand on more scores; adds
// routes that were never met. Two trusted ones stay as they are. The choice looks at how many histories scored, never
// at how much, so it favours no value.
void mirror_poorly_sampled(std::vector<MadeClass>& classes);

}  // namespace straytrace
