// SPDX-License-Identifier: BSD-3-Clause
// A surface in the path of a beam: the lines parallel to the chief ray that meet it, where, and the share of the power
// that passes its rim (docs/theory/beams.md, eq. 5.5, 5.6, for any rim at any angle).
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "base/math/functions.hpp"
#include "beams/mode.hpp"
#include "world/ghosts/screens.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {

// Coordinates in which the beam is round: the share exp(-2 rho^2) of its power lies beyond rho.
class BeamLines {
 public:
  static constexpr double farthest = 4.5;  // rho: 3e-18 of the power lie beyond
  explicit BeamLines(Mode const&);         // across the beam, at the origin of the mode
  Vec3 towards(SinCos azimuth) const;      // from the chief ray, m per unit of rho
  Vec3 origin, travel;

 private:
  Vec3 across_, up_;
};

// Lines of one azimuth, from rho to rho.
struct Stripe {
  double from = 0, to = infinity;
  bool empty() const { return !(from < to); }
  double share() const { return std::exp(-2 * from * from) - std::exp(-2 * to * to); }
};
using Stripes = std::vector<Stripe>;  // disjoint, in order
Stripes without(Stripes const&, Stripes const& gone);
Stripes together(Stripes const&, Stripes const&);
double share_of(Stripes const&);

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
  // The part of the line p + rho v, rho >= 0, inside the outline.
  Stripe inside(PlanePoint p, PlanePoint v) const;
};

struct FlatRim {
  Vec3 centre, e1, e2, axis;
  Outline outer, inner;
  bool hole = false;
  Stripes met(Vec3 start, Vec3 step, Vec3 travel) const;  // lines start + rho step along `travel` that meet it
};
// Of disks, plane figures and the faces of boxes; of caps and conics, taken as flat at the height of their hole, or of
// their rim. Empty for all other shapes.
std::vector<FlatRim> flat_rims(WorldView const&, SurfaceId);

// Inner rim of a disk, cap or cone with a hole: it cuts a beam that passes through.
struct InnerRim {
  SurfaceId surface;
  Vec3 centre, axis, e1, e2;  // of the circle of the tips; unit vectors
  double radius = 0;          // m, of the tips
  double tooth_depth = 0;     // m, from tip to valley across the axis; the teeth are triangular
  double slope = 0;           // m along `axis` per m of radius, in the teeth
  double teeth = 0, phase = 0;
};
std::optional<InnerRim> rim_of(World const&, SurfaceId);  // empty: the surface has no hole
double rim_radius(InnerRim const&, double azimuth);       // m
Vec3 rim_point(InnerRim const&, double azimuth);          // from e1 towards e2

// Share of a beam that passes beside the surface which its chief ray meets.
double beside_rim(WorldView const&, SurfaceId, Mode const&);

// Where lines start and end: distance along the travel from the start of the flight over the offset, m.
struct Slant {
  double at = 0;
  Vec3 slope;
  double over(Vec3 offset) const { return at + dot(slope, offset); }
};
struct Stretch {
  Slant from, to;
};

// Lines of one azimuth, m per unit of rho: across the beam at the middle of an obstacle and at its two ends.
struct Fan {
  Vec3 middle, low, high;
};

// Spacing of the lines, and resolution of the search for the edges of stripes.
struct Fineness {
  int azimuths, most_azimuths, rings, halvings;
};

double reach_of(BeamFlight const&);  // rho that leaves the smallest share of interest beyond it

Box bounds_of(WorldView const&, SurfaceId);
double diagonal(Box const&);  // m
// Least and largest distance of the surface along the lines, m, from the plane across the beam at their origin.
std::array<double, 2> heights(WorldView const&, SurfaceId, BeamLines const&);

// Along a surface that is not flat the lines run straight from the width of the beam at its one end to the width at its
// other; along flat ones they are parallel to the chief ray.
class Obstacle {
 public:
  Obstacle(WorldView const&, SurfaceId, BeamFlight const&, double along, Stretch const&);
  SurfaceId id() const { return id_; }
  double along() const { return along_; }  // m, of the plane across the beam in which offsets are taken
  int azimuths() const;                    // enough for a small surface far from the chief ray
  bool possible(double reach) const;       // whether lines to `reach` may meet it on the stretch at all
  Fan fan(SinCos azimuth) const;
  Stripes met(Fan const&) const;  // lines that meet it on the stretch
  // Where a line meets it first, and how far from the start of the flight.
  struct Meeting {
    Vec3 point;
    double along = infinity;  // m
    std::uint32_t piece = 0;
  };
  Meeting meeting(Fan const&, double rho) const;

 private:
  Stripes off_stretch(FlatRim const&, Vec3 direction) const;
  bool passes(Vec3 direction) const;
  Stripes searched(Fan const&) const;
  bool spreads() const { return rims_.empty() && to_ > from_; }

  WorldView const* view_;
  SurfaceId id_;
  double along_;
  BeamLines lines_;
  Stretch const* stretch_;
  Fineness fine_;
  int rings_;                  // out to the smallest share of interest
  std::vector<FlatRim> rims_;  // empty: the surface is not flat
  BeamLines low_, high_;       // at its two ends, when the lines spread
  double from_ = 0, to_ = 0;   // m, from the start of the flight to these
  Vec3 aside_;                 // m, of the ball around it from the chief ray
  double size_ = 0;            // m, its radius
};

}  // namespace straytrace::world
