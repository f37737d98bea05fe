// SPDX-License-Identifier: BSD-3-Clause
// Outlines of surfaces that are flat, or as good as flat at their rim, and where a straight line in their plane is
// within them.
#pragma once

#include "world/ghosts/beam_lines.hpp"
#include "world/model/world.hpp"

namespace straytrace {

struct PlanePoint {
  double x = 0, y = 0;
};

// Convex outline about the origin of a plane.
struct Outline {
  double semi_x = 0, semi_y = 0;  // m; of the ellipse, or half sizes of the rectangle
  double sides = 0;               // 0: ellipse; 4 with `rectangle`; otherwise a regular polygon
  double rotation = 0;            // rad, azimuth of the first corner
  double apothem = 0;             // m
  bool rectangle = false;
  // Of the points p + rho v, rho >= 0.
  Stripe inside(PlanePoint p, PlanePoint v) const;
};

struct FlatRim {
  Vec3 centre, e1, e2, axis;
  Outline outer, inner;
  bool hole = false;
  Stripes met(Vec3 start, Vec3 step, Vec3 travel) const;  // lines start + rho step along `travel` that meet it
};
// Of disks, plane figures and the faces of boxes; of caps and conics, taken as flat at the height of their hole, or of
// their rim. Empty: of no flat shape.
std::vector<FlatRim> flat_rims(WorldView const&, SurfaceId);

}  // namespace straytrace
