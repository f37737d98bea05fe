// SPDX-License-Identifier: BSD-3-Clause
// What the beams of a scene pass through or meet: holes around their chief rays, edges beside them, and the rims of the
// mirrors and lenses on their way. Main beams only.
#pragma once

#include <string>
#include <vector>

#include "beams/aperture.hpp"
#include "beams/mode.hpp"
#include "world/model/world.hpp"

namespace straytrace {

struct BeamAperture {
  std::uint32_t beam = 0;
  GroupId group;
  SurfaceId surface;
  bool reflected = false;  // the rim of a mirror: what goes on is reflected
  double along = 0;        // m, optical, from where the beam starts; of a cavity, from its first mirror
  double clipped = 0;      // share of the power (eq. 5.5, 5.6), of beams and rims at any angle
  // Change of the intensity on the axis, as factor far behind (eq. 5.7), and at most at any distance, to first order in
  // the wave from the rim; NaN: the rim is not round.
  double axis_far = 0, ripple = 0;
  double tilt = 0;                  // rad, between the normal of the rim and the beam
  double w_major = 0, w_minor = 0;  // m, 1/e^2 radii
  // For the field behind: a round beam and a round rim across it. x runs from the axis of the beam to its centre.
  bool across = false;
  BeamInPlane at;   // as it leaves the plane of the rim; curvature only where `across`
  Opening opening;  // radius NaN: the rim is not round
};

// In the order of the beams, along each.
std::vector<BeamAperture> apertures_of(World const&);

// Where the main beam loses more than `least` of what it still has, and how much; until it has a tenth of what is
// launched, or of what the mirror of a cavity lets through.
struct MainLoss {
  std::uint32_t beam = 0;
  SurfaceId surface;
  double share = 0;
  bool beside = false;  // beside what it meets; otherwise on a screen
};
std::vector<MainLoss> main_losses(World const&, double least = 0.01);

}  // namespace straytrace
