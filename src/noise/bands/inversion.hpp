// SPDX-License-Identifier: BSD-3-Clause
// Requirement inversion: the largest scatter or motion that keeps the total under a line (docs/theory/errors.md).
#pragma once

#include <functional>

#include "noise/bands/elasticity.hpp"

namespace straytrace::noise {

// Result for one frequency or for all of them.
struct Allowed {
  enum class Verdict {
    found,     // `scale` meets the line, larger ones do not
    always,    // every scale tested meets it: no limit
    never,     // none does: other noise alone exceeds it
    unknown,   // light could decide of which it is not known how often it scatters on the material
    no_answer  // no line here
  };
  Verdict verdict = Verdict::no_answer;
  double scale = not_a_number;  // factor on the BRDF, or on the ASD of the motion
  double sigma = not_a_number;  // Monte Carlo, one standard error
  double rest = not_a_number;   // ASD of the total at scale 0, over the line
};

struct Inversion {
  std::vector<Allowed> bins;  // each frequency alone
  Allowed all;                // every frequency at once
  std::size_t decides = 0;    // bin that determines `all`
  double touched = 0;         // largest share of the PSD, over the bins, of routes that are or may be affected
  double mixed = 0;           // largest share of the PSD, over the bins, of routes whose scatters are not counted
  bool first_order = false;   // they scale as the named routes of their row do
};

// Largest factor on the BRDF of the material, the only one of the composition: total(s) = sum over n of s^n A_n, A_n
// the routes with n scatters on it. `line`: ASD per bin, NaN: not compared. Monte-Carlo errors of routes are taken as
// common to a route and its reverse. Unknown where routes of unknown composition exceed composition_limit or, without a
// limit by the others, carry noise.
Inversion invert_scatter(NoiseBudget const&, Composition const&, std::vector<double> const& line);

// The ASD of the total, with its standard error, with the motion of a body multiplied by `scale`.
using Projected = std::function<NoiseTrace(double scale)>;
// Largest factor below which ALL factors meet the line, up to 100: fringe-wrapped noise is not monotonic in the motion.
// The fewer projections the weaker the motion (docs/theory/errors.md).
// Without `every_bin` only the first bin to exceed its line is looked for; the others may say `always`.
Inversion invert_motion(Projected const&, std::vector<double> const& line, bool every_bin = true);

// Motion with the gains of one body times `scale`: both its own motion and that of its carrier.
MotionSet with_scaled_body(MotionSet const&, BodyId, double scale);

}  // namespace straytrace::noise
