// SPDX-License-Identifier: BSD-3-Clause
// Surfaces off the chief ray of a beam that clip it between one surface and the next: the
// screen around a hole, the edge of something beside the beam (docs/theory/beams.md, eq. 5.5, 5.6).
// docs/theory/ghosts.md.
#pragma once

#include <cstdint>
#include <vector>

#include "beams/mode.hpp"
#include "world/model/view.hpp"

namespace straytrace {

// From the surface left (invalid: from space) to the next one (invalid: the beam leaves the scene).
struct Flight {
  Mode mode;  // at its start
  Departure from;
  Hit to;
  std::uint32_t volume = Surface::none;  // that it lies in: inside glass, nothing but the walls of it counts
  double least = 1e-17;                  // smaller shares are not looked for
};

struct Screened {
  SurfaceId surface;
  double share = 0;    // of the power that starts, which this surface takes and none before it
  double alone = 0;    // and if it stood alone
  double nearest = 0;  // rho (BeamLines) within which it takes nothing
  double along = 0;    // m, from the start
  Mode mode;           // there; its origin is on the chief ray
  Vec3 point;          // of the surface, in the light
  std::uint32_t piece = 0;
};

struct FlightLoss {
  std::vector<Screened> screens;  // in the order in which the beam passes them
  double beside = -1;             // share of what arrives that passes beside the next surface; < 0: not known
  double taken() const {
    double sum = 0;
    for (Screened const& s : screens) sum += s.share;
    return sum;
  }
};

// Bounds of all surfaces, in a tree of balls.
class Screens {
 public:
  explicit Screens(WorldView const&);
  // Each line of the beam is taken by the first screen that it meets; at the next surface the beam is a whole Gaussian
  // again. Features narrower than 0.14 radii of the beam may be missed on surfaces that are not flat.
  FlightLoss loss(Flight const&) const;
  // Surfaces that beams of this flight may meet within `reach` radii.
  std::vector<SurfaceId> near(Flight const&, double reach) const;

 private:
  struct Bounds {
    SurfaceId surface;
    Vec3 centre, reference, axis;  // m
    double radius = 0, low = 0, high = 0, r_min = 0, r_max = 0;
    std::uint32_t volume = Surface::none;
  };
  struct Node {
    Vec3 centre;
    double radius = 0;
    std::uint32_t first = 0, count = 0, right = 0;  // count 0: the left one follows, `right` is the other
  };
  struct Tube;
  std::uint32_t build(std::uint32_t first, std::uint32_t count);
  void collect(Tube const&, std::uint32_t node, std::vector<SurfaceId>&) const;
  bool clear(Tube const&, Bounds const&, double low, double high) const;

  WorldView view_;
  std::vector<Bounds> bounds_;
  std::vector<Node> nodes_;
};

}  // namespace straytrace
