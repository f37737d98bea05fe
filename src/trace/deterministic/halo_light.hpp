// SPDX-License-Identifier: BSD-3-Clause
// Where the light of a cavity at angles below the crossover meets surfaces between the mirrors (docs/theory/wave.md,
// "Light that baffles scatter back").
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "trace/step/scatter.hpp"
#include "wave/arm/arm_cavity.hpp"
#include "wave/arm/irradiance.hpp"

namespace straytrace::trace {

// A surface in a cell of a plane: the part of the cell that it covers, between two radii [m], and a point there.
struct LitPart {
  Vertex vertex;
  double share = 1, inner = 0, outer = 0;
};

// The light that travels one way, in the plane of a baffle. Surfaces meet it along the axis, halfway to the planes on
// both sides. World, plan and irradiance must outlive it.
class HaloPlane {
 public:
  HaloPlane(World const&, ArmCavity const&, PlaneIrradiance const&, std::size_t rim, Travel);
  PolarIrradiance const& light() const { return *light_; }
  Travel travel() const { return travel_; }
  double place() const { return place_; }        // m from mirror 1
  double distance() const { return distance_; }  // m from the mirror that the light comes from
  double from() const { return from_; }          // of the part of the axis that it holds, m from mirror 1
  double to() const { return to_; }
  bool holds(double place) const { return from_ <= place && place < to_; }
  // None: the light passes, or the point lies behind a wall.
  std::optional<Vertex> at(double radius, double azimuth) const;
  // Edges of surfaces are resolved to an eighth of a ring.
  std::vector<LitPart> parts(int ring, int sector) const;

 private:
  WorldView view_;
  CavityFrame const* frame_;
  PolarIrradiance const* light_;
  Travel travel_;
  Vec3 direction_, start_;
  double place_, distance_, from_, to_;  // m
};

// A patch of a surface between two radii in a sector, with both ends along the axis; m in the frame of the cavity.
struct HaloPatch {
  int sector = 0;
  double inner = 0, outer = 0, inner_place = 0, outer_place = 0;
  double irradiance = 0;  // over the power of the mode, per area of the surface, 1/m^2
};
// A surface in the light that travels one way.
struct HaloSurface {
  SurfaceId surface;
  Travel travel = Travel::towards_mirror2;
  double share = 0;  // of the power of the mode that it takes
  std::vector<HaloPatch> patches = {};
};

// The light at small angles on the surfaces of a scene, for pictures.
class HaloLight {
 public:
  HaloLight(World const&, ArmCavity const&, PlaneIrradiance const&);
  // On the front or the back of a surface, over the power of the mode, per area of the surface, 1/m^2.
  double on(SurfaceId, Vec3 point, bool front) const;
  // With as many patches between the edges of each as `rings` allows.
  std::vector<HaloSurface> surfaces(int rings) const;

 private:
  CavityFrame const* frame_;
  std::vector<HaloPlane> planes_;
};

}  // namespace straytrace::trace
