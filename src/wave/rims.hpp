// SPDX-License-Identifier: BSD-3-Clause
// The stray field that a rim couples back into the mode of a cavity, and its derivatives by the motion of the rim
// (docs/theory/wave.md, eq. W.11 to W.16, W.22).
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

// eq. W.22: means over speckle of a round rim between two mirrors that scatter, and whose outlines diffract the mode.
// The offset d of the rim from the line between the spots plays no part while k a d (1/distance1 + 1/distance2) is
// small against sqrt(kappa).
struct SpeckledRim {
  double wavelength = 0, radius = 0;    // m
  double distance1 = 0, distance2 = 0;  // to the mirrors, m
  double spot1 = 0, spot2 = 0;          // 1/e^2 radii on the mirrors, m
  double brdf1 = 0, brdf2 = 0;          // 1/sr, at the angle of the rim
  double edge1 = 0, edge2 = 0;          // of the waves from the outlines, as `brdf` (eq. W.28). 1/sr
  double outline1 = 0, outline2 = 0;    // radii of the mirrors, m
  double kappa() const;                 // 1; its root is the number of patches of speckle, up to sqrt(2 pi)
};
// eq. W.28: irradiance times distance squared, 1/sr, of the wave from the outline of a mirror, by the mean over its
// fringes. Curvature: 1/RoC, positive when concave. 1/m
double outline_wave(SpeckledRim const&, double distance, double spot, double outline, double curvature);
struct SpeckleMeans {
  double field = 0;         // <|s|^2>
  double transverse = 0;    // <|A_x|^2> = <|A_y|^2>, 1/m^2
  double longitudinal = 0;  // <|A_z|^2>, 1/m^2; with the slopes of speckle, which remain where distances are equal
};
SpeckleMeans speckle_means(SpeckledRim const&);

}  // namespace straytrace::wave
