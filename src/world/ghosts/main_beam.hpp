// SPDX-License-Identifier: BSD-3-Clause
// Recoupling of ghosts into the main beam: which part of a ghost that leaves a surface of the main beam is in the mode
// of the main beam (docs/theory/ghosts.md, eq. 5.4), and with which phase sensitivities (eq. 2.3, 2.5).
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "beams/overlap.hpp"
#include "world/ghosts/beam_tree.hpp"

namespace straytrace::world {

// Chief rays of a beam when the bodies on its way move: first order, by rigid motion (docs/theory/ghosts.md, eq. N.27).

// Per metre or radian of a coordinate: of the point where the ray crosses a plane across it, and of its direction. Both
// lie across the ray.
struct RayShift {
  Vec3 shift, turn;  // m, rad
};

struct MovedRay {
  BodyId body;
  std::array<RayShift, 6> by{};  // coordinates as in PhaseSensitivity::d
};

// Of the ray that leaves the last surface of a way, at a point of it. Snell's law on the moved, turned and curved
// surface, n_in a - n_out b along its normal; elastic modes do not move the ray. Nothing without a way.
std::vector<MovedRay> moved_rays(World const&, std::span<BeamStep const> way, Vec3 at);

// Where the main beam meets a surface, and the beams in which it leaves: one or two, at a grating several.
struct MainNode {
  bool screen = false;  // beside the chief ray; without ways
  struct Way {
    LeavingBeam beam;
    Event event = Event::transmit;
    int diffracted = 0;                                 // order of a grating
    std::vector<PhaseSensitivity> phase_sensitivities;  // of the way to here including this surface, rad/m and rad
    std::vector<MovedRay> moved;                        // at the origin of the mode
  };
  BeamSpot spot;
  std::vector<BeamStep> way;                          // to here, without this surface
  std::vector<PhaseSensitivity> phase_sensitivities;  // of the way to here, without this surface
  std::vector<MovedRay> moved;                        // arriving, at the origin of the mode
  std::vector<Way> ways;
};

// Change of ln of the field of a ghost by the share that a rim takes of it.
struct RimSlope {
  SurfaceId by;
  Mode mode;  // that comes
  double taken = 0;
  std::complex<double> of_taken = 0;
};

// d(ln s)/d(coordinate) of a body [1/m, 1/rad] beyond i times its phase sensitivity (eq. N.27): the change of the
// overlap of a ghost with the main mode, and of what rims leave of it.
struct OverlapLever {
  BodyId body;
  std::array<std::complex<double>, 6> d{};
};

// A ghost that is aligned with the main beam.
struct Recoupling {
  // The plane is the surface itself. `against`: the ghost travels back along the main beam, and the share is that of
  // the light which reaches the plane of the launch in the reversed mode, over the launched power. Otherwise it travels
  // with the main beam, and the share is over the power of the main beam there.
  bool any = false, against = false;
  std::uint32_t node = 0, way = 0;              // of the main beam; way: not against
  std::size_t steps = 0;                        // of the ghost, up to that surface
  std::array<std::complex<double>, 2> field{};  // by state of polarisation; their squares sum to the share
  beams::OverlapSlope ghost{},
      main{};  // of ln of their overlap, with both chief rays; the modes along their own travel
  std::vector<RimSlope> rims{};
  double share() const { return std::norm(field[0]) + std::norm(field[1]); }
};

// Alignment of a ghost with the main beam at the last surface that both have left.
struct GhostAlignment {
  bool known = false, against = false;
  double angle = 0;       // rad, to the main beam that leaves that surface; against: to the one that arrives
  double difference = 0;  // of optical path: behind the main beam; against: from the launch and back to it; m
  Recoupling recoupled;   // the last time it was aligned: it counts once
};

class MainBeam {
 public:
  static constexpr std::size_t most_nodes = 4096;
  MainBeam(World const&, BeamLaunch const&, TreeLimits);

  std::vector<MainNode> const& nodes() const { return nodes_; }
  bool complete() const { return complete_; }  // false: it meets more surfaces than most_nodes
  // After the last step of `way`; `before`: at the surface before.
  GhostAlignment standing(GhostAlignment const& before, LeavingBeam const&, std::span<BeamStep const> way) const;
  // Phase sensitivities of a ghost relative to the main mode; empty without recoupling.
  std::vector<PhaseSensitivity> phase_sensitivities(Recoupling const&, std::span<BeamStep const> way) const;
  // The rest of the complex lever, by body; the launched mode is at rest.
  std::vector<OverlapLever> overlap_levers(Recoupling const&, std::span<BeamStep const> way) const;
  // Rims on bodies that cut it but have no round edge, so that their motion is not in its levers.
  std::vector<RimSlope> rims_without_lever(Recoupling const&) const;

 private:
  struct Candidate;
  World const& world_;
  BeamLaunch const& launch_;
  std::vector<MainNode> nodes_;
  std::multimap<std::uint32_t, std::uint32_t> on_surface_, on_screen_;
  bool complete_ = true;
};

// A beam of the tree from its last departure to its end.
struct Ghost {
  std::uint64_t number = 0;  // in the order of the tree, including the main beam
  BeamEnd end = BeamEnd::landed;
  std::uint32_t order = 0;
  GroupId where;           // landed, faint or longest: on this
  bool front = true;       // side of it
  Vec3 point, travel;      // m; its end, or where it leaves its last surface; direction there
  double power = 0;        // arriving there, over the launched power
  double clipped = 0;      // share beside the rim of the surface that it lands on
  Spot spot;               // across the beam, m
  double path_length = 0;  // optical, from the launch, m
  GhostAlignment standing;
  std::span<BeamStep const> way;  // all surfaces before the end; valid during the call
};

// Grows the tree and calls `each` for every beam that ends; order 0 is the main beam.
BeamEnergyBalance find_ghosts(World const&, BeamLaunch const&, TreeLimits const&, MainBeam const&,
                              std::function<void(Ghost const&)> const& each);

}  // namespace straytrace::world
