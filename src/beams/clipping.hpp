// SPDX-License-Identifier: BSD-3-Clause
// Power that a Gaussian beam loses at an aperture (docs/theory/beams.md). All shares are of the power of the beam and
// keep their relative accuracy however small they are.
#pragma once

#include <array>

#include "beams/mode.hpp"

namespace straytrace {

// Circular aperture of radius a, beam of 1/e^2 intensity radius w, centred (eq. 5.5) or a distance off (eq. 5.6). m
double clipped_share(double aperture, double w);
double clipped_share(double aperture, double w, double offset);
// Elliptic beam of radii w along x and y, its middle at `offset` from the middle of the aperture.
double clipped_share(double aperture, std::array<double, 2> w, std::array<double, 2> offset);

// A round hole in a screen, met by a beam at any angle that is not grazing.
struct Aperture {
  Vec3 centre, normal;  // m; unit normal, either side
  double radius = 0;    // m
};
double clipped_share(Aperture const&, Mode const&);

}  // namespace straytrace
