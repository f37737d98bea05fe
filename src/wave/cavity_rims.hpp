// SPDX-License-Identifier: BSD-3-Clause
// What the rims and mirrors of a cavity couple back into its mode when they move (docs/theory/wave.md, eq. W.11 to W.16
// and W.25 to W.27).
#pragma once

#include <array>
#include <vector>

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

// A closed curve, counter-clockwise about +z, about `reference`.
struct RimCurve {
  std::vector<RimPoint> points;
  Vec3 reference;                // m
  std::array<double, 2> roll{};  // by which the light from mirror 1 and from mirror 2 is turned about the axis, rad
};
// Of a round hole, fine enough for the fields on this grid.
RimCurve round_curve(WaveBaffle const&, WaveCavity const&);
// The points that a curve of this length [m] needs for fields on the grid: 2.5 for each period of their product.
int points_along(double length, double pitch);

struct RimResponse {
  RimLevers levers;
  Complex widening;  // derivative of s by the radius of the rim, 1/m
};
struct CavityRims {
  Complex overlap;                                  // B of eq. W.11
  std::vector<std::vector<RimResponse>> responses;  // [baffle][curve]
  std::vector<Complex> clipped;  // s of the light that each baffle with curves takes (eq. W.12 with its screen)
  std::array<MirrorLevers, 2> mirrors;
};
// For several curves in the plane of each baffle: as built, and with its tolerances. One round trip, whose arrivals
// `also` is shown.
CavityRims rim_responses(CavityWaves const&, WaveMode const&, std::vector<std::vector<RimCurve>> const&,
                         Observer const& also = {});

}  // namespace straytrace::wave
