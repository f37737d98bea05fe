// SPDX-License-Identifier: BSD-3-Clause
// Levers of edges whose light the grid does not hold, in the mean over random mirrors (docs/theory/wave.md, eq. W.22
// and W.28).
#pragma once

#include <array>
#include <vector>

#include "wave/arm/arm_cavity.hpp"
#include "wave/arm/speckled_rim.hpp"
#include "wave/cavity.hpp"

namespace straytrace::wave {

// Of one draw of the heights, what the grid holds of the light of mirrors 1 and 2 that meets edges beyond it.
struct LightOfMirrors {
  std::array<RingField, 2> outlines;              // leaving them on their outlines
  std::vector<std::array<RingField, 2>> at_rims;  // as arm.rims: on the rim (eq. W.63); empty: not held
};

// Collects it from the arrivals of one round trip.
class LightMeter {
 public:
  LightMeter(ArmCavity const&, WaveCavity const&);
  void operator()(Arrival const&);
  LightOfMirrors result() && { return std::move(light_); }

 private:
  ArmCavity const& arm_;
  WaveCavity const& cavity_;
  LightOfMirrors light_;
};

class ExpectedLevers {
 public:
  ExpectedLevers(World const&, ArmCavity const&);
  // Where the grid holds the light of one of the mirrors at the edge, and nothing of the mode itself is in it, with its
  // field there: it contains the waves of outlines and baffles and their shadows.
  SpeckleMeans operator()(std::size_t rim, LightOfMirrors const&) const;
  // The mean over draws of the heights.
  SpeckleMeans operator()(std::size_t rim, std::vector<LightOfMirrors> const&) const;

 private:
  SpeckledRim lit(std::size_t rim, LightOfMirrors const&) const;

  ArmCavity const& arm_;
  std::vector<MirrorBrdf> brdf_;
};

}  // namespace straytrace::wave
