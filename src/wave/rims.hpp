// SPDX-License-Identifier: BSD-3-Clause
// The stray field that a rim couples back into the mode of a cavity, and its derivatives by the motion of the rim
// (docs/theory/wave.md, eq. W.11 to W.16).
#pragma once

#include <functional>
#include <vector>

#include "base/math/vec3.hpp"
#include "wave/sampler.hpp"

namespace straytrace::wave {

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

}  // namespace straytrace::wave
