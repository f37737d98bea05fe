// SPDX-License-Identifier: BSD-3-Clause
// The view of a camera with its own flash: scattered light and glints, as in photographs taken to find retro-reflecting
// surfaces (R3.36). Page: docs/reference/render.md.
#pragma once

#include "trace/camera/camera.hpp"

namespace straytrace::trace {

// A small sphere around the eye shines equally in all directions, with the radiant intensity I [W/sr].
struct Flash {
  double radius = 5e-3;    // m, of the sphere; its radiance is I/(pi radius^2)
  int most_mirrors = 6;    // reflections and transmissions on a path
  double faintest = 1e-7;  // remaining share of the light, below which a path is not followed
};

// Radiance towards the eye over I, 1/m^2, along one ray. Of a surface at the distance d, seen by way of mirrors and
// glass that pass the share T one way: T^2 BRDF cos(theta)/d^2 with the BRDF [1/sr] for light that goes back where it
// came from. d is the length of the way: what is seen in a curved mirror or through a lens has the brightness of a flat
// one. A way that comes back to the sphere sees it: T/(pi radius^2), exact for mirrors of any shape.
struct FlashLight {
  double scattered = 0, glint = 0;
  SurfaceId first;  // what the ray meets first; invalid: nothing
  double both() const { return scattered + glint; }
};
// `open`: two flags per surface, front and back, of transparent sides (Look::open); empty: none.
FlashLight flash_along(WorldView const&, Ray, Departure from, Vec3 eye, Flash const&, std::vector<Look> const& looks);

// One per pixel, row by row: mean of 3 x 3 rays.
std::vector<FlashLight> flash_picture(WorldView const&, Camera const&, Flash const&, LookSettings const&);

// Solid angle of a pixel, sr: what its radiance is multiplied with to give the irradiance at the eye.
double solid_angle(Camera const&, std::uint32_t column, std::uint32_t row);

}  // namespace straytrace::trace
