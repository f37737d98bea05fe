// SPDX-License-Identifier: BSD-3-Clause
// The motion of each body as the light felt it, some time before it rejoins (docs/theory/time_domain.md, eq. N.29).
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "motion/motion.hpp"
#include "noise/noise.hpp"
#include "trace/coupling.hpp"

namespace straytrace::noise {

// Equidistant delays from 0 to the longest, between which exp(i omega tau) is interpolated, for each omega up to a
// highest: a delay is a sum of weights of up to twelve of them.
class DelayLattice {
 public:
  static constexpr double accuracy = 1e-7;  // of exp(i omega tau), absolute
  static constexpr std::size_t most = 64;   // nodes
  // Throws InputError when more nodes are needed.
  DelayLattice(double longest, double highest_hz);

  std::size_t size() const { return nodes_; }
  double delay(std::size_t node) const { return nodes_ > 1 ? longest_ * double(node) / double(nodes_ - 1) : 0; }  // s
  using Weights = std::vector<std::pair<std::size_t, double>>;  // node, weight
  // For the part d of a phase sensitivity with this moment: all of it at moment/d; where that is no delay of the
  // lattice, because hits of different sign nearly cancel, the parts at 0 and at the longest that have this sum and
  // moment.
  Weights parts(double d, double moment) const;

 private:
  Weights at(double delay) const;
  double error(double highest_hz) const;

  double longest_;
  std::size_t nodes_ = 1;
};

// A coupling table and a motion in which delayed copies of the bodies follow the inputs as much later: projected like
// any others, they give eq. N.29. Bodies keep their numbers, and copies come after them; second moments of the phase
// sensitivities are those without delays. `highest_hz`: of the noise. Throws InputError where the table has no delays.
struct DelayedPaths {
  CouplingTable table;
  MotionSet motion;
};
DelayedPaths with_delays(CouplingTable const&, MotionSet const&, double highest_hz);

// What a budget without delays neglects (eq. 2.6), where it is largest: ASD of h with delays over that without, to
// first order in the motion of the frequency; slower motion that wraps the fringes is taken as it is. No frequency:
// nothing moves, or the table has no delays.
struct DelayEffect {
  double hz = 0, factor = 1;
  bool matters() const { return factor < 0.99 || factor > 1.01; }
};
DelayEffect delay_effect(CouplingTable const&, MotionSet const&, Interferometer const&, NoiseBudget const&);

}  // namespace straytrace::noise
