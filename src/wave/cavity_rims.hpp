// SPDX-License-Identifier: BSD-3-Clause
// What the rims and mirrors of a cavity couple back into its mode when they move (docs/theory/wave.md, eq. W.11 to W.16
// and W.25 to W.27).
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "base/math/vec3.hpp"
#include "wave/cavity.hpp"
#include "wave/transform.hpp"

namespace straytrace::wave {

// The stray field that a rim couples back into the mode of a cavity, and its derivatives by the motion of the rim
// (docs/theory/wave.md, eq. W.11 to W.16).

// Frame of the cavity: z from mirror 1 to mirror 2, x and y across. `place` on the rim, `step` along it,
// counter-clockwise about +z. m
struct RimPoint {
  Vec3 place, step;
};
std::vector<RimPoint> round_rim(double radius, Vec3 centre, int count);

// Derivatives of s = d(gamma)/gamma, the stray field over that of the mode per round trip with both directions in it,
// by the displacement [1/m] and by the rotation about `reference` [1/rad] of the body of the rim along x, y, z.
struct RimLevers {
  Complex displacement[3], rotation[3];
};

// A field that arrives at the plane of the rim, before its mask, at a point of the rim.
using WaveAt = std::function<WaveValue(Vec3 const&)>;
// eq. W.14; `overlap` is B of eq. W.11. Throws NumericalError where the levers are not finite.
RimLevers rim_levers(std::vector<RimPoint> const&, WaveAt const& from_mirror1, WaveAt const& from_mirror2,
                     double wavelength, Complex overlap, Vec3 const& reference);

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
