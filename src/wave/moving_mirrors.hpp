// SPDX-License-Identifier: BSD-3-Clause
// What moving mirrors of a cavity do to its mode (docs/theory/wave.md, eq. W.25 to W.27).
#pragma once

#include <array>

#include "wave/cavity.hpp"
#include "wave/rims.hpp"

namespace straytrace::wave {

struct MirrorLevers {
  // Derivatives of s by the displacement and by the rotation about the vertex. The phase 2k per displacement along the
  // axis with which the mode itself is reflected (eq. 2.5) is left out.
  RimLevers whole{};
  // Of the outline and the heights alone, while the curvature of the mirror rests: by a displacement along x and y
  // [1/m], and by a rotation about z [1/rad].
  std::array<Complex, 3> figure{};
};
// Of the mirror at which the field of a mode arrives.
MirrorLevers mirror_levers(CavityWaves const&, Arrival const&);

// The axis of a cavity is the line through the centres of curvature of both mirrors. Its place and slope, across the
// axis that it had, by the motion of one mirror: its displacement across times its curvature, plus the slope of its
// normal for mirror 1 or less it for mirror 2.
struct AxisShift {
  double at_mirror1;  // m
  double slope;       // rad
  double at(double z) const { return at_mirror1 + slope * z; }
};
// eq. W.23; the cavity is stable.
std::array<AxisShift, 2> axis_shifts(double curvature1, double curvature2, double length);

}  // namespace straytrace::wave
