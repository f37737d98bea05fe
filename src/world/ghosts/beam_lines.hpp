// SPDX-License-Identifier: BSD-3-Clause
// A beam as lines parallel to its chief ray (docs/theory/beams.md, eq. 5.5, 5.6 for any rim at any angle).
#pragma once

#include <cmath>
#include <vector>

#include "base/math/functions.hpp"
#include "beams/mode.hpp"

namespace straytrace {

// Coordinates in which the beam is round: beyond rho lies the share exp(-2 rho^2) of its power.
class BeamLines {
 public:
  static constexpr double farthest = 4.5;  // rho: beyond lie 3e-18 of the power
  explicit BeamLines(Mode const&);         // across the beam, at the origin of the mode
  Vec3 towards(SinCos azimuth) const;      // from the chief ray, m per unit of rho
  Vec3 origin, travel;

 private:
  Vec3 across_, up_;
};

// Lines of one azimuth, from rho to rho.
struct Stripe {
  double from = 0, to = infinity;
  bool empty() const { return !(from < to); }
  double share() const { return std::exp(-2 * from * from) - std::exp(-2 * to * to); }
};
using Stripes = std::vector<Stripe>;  // disjoint, in order
Stripes without(Stripes const&, Stripes const& gone);
Stripes together(Stripes const&, Stripes const&);
double share_of(Stripes const&);

}  // namespace straytrace
