// SPDX-License-Identifier: BSD-3-Clause
// One surface in the way of a beam: which of the lines of the beam meet it, and where.
#pragma once

#include <array>

#include "world/ghosts/rim.hpp"
#include "world/ghosts/screens.hpp"

namespace straytrace {

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

// How closely the lines lie, and how closely the edges of stripes are found where they are searched for.
struct Fineness {
  int azimuths, most_azimuths, rings, halvings;
};

// rho beyond which lies the least share that is looked for.
double reach_of(Flight const&);

Box bounds_of(WorldView const&, SurfaceId);
double diagonal(Box const&);  // m
// Least and largest distance of it along the lines, m, from the plane across the beam in which they are given.
std::array<double, 2> heights(WorldView const&, SurfaceId, BeamLines const&);

// Beside it the lines run straight from where the beam has the width of its one end to the width of its other; parallel
// to the chief ray for flat ones.
class Obstacle {
 public:
  Obstacle(WorldView const&, SurfaceId, Flight const&, double along, Stretch const&);
  SurfaceId id() const { return id_; }
  double along() const { return along_; }  // m, of the plane across the beam in which offsets are taken
  int azimuths() const;                    // enough for what is small and beside the chief ray
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
  int rings_;                  // as far as there is light of account
  std::vector<FlatRim> rims_;  // empty: it is not flat
  BeamLines low_, high_;       // at its two ends, when the lines spread
  double from_ = 0, to_ = 0;   // m, from the start of the flight to these
  Vec3 aside_;                 // m, of the ball around it from the chief ray
  double size_ = 0;            // m, its radius
};

}  // namespace straytrace
