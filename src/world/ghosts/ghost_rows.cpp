// SPDX-License-Identifier: BSD-3-Clause
#include "world/ghosts/ghost_rows.hpp"

namespace straytrace {
namespace {

class Rows final : public BeamSink {
 public:
  Rows(World const& world, MainBeam const& main, std::function<void(Ghost const&)> const& each)
      : world_(world), main_(main), each_(each) {}

  void left(LeavingBeam const& beam, std::span<BeamStep const> way) override {
    standing_.resize(way.size() + 1);
    if (!way.empty()) standing_.back() = main_.standing(standing_[way.size() - 1], beam, way);
  }
  void ended(BeamEnd how, BeamSpot const* spot, LeavingBeam const& beam, std::span<BeamStep const> way) override {
    Ghost ghost;
    ghost.number = ++count_;
    ghost.end = how;
    ghost.order = beam.order;
    if (spot) {
      ghost.where = world_.surfaces()[spot->surface.value].group;
      ghost.front = spot->front;
      ghost.clipped = spot->clipped;
    }
    ghost.point = beam.mode.origin;
    ghost.travel = beam.mode.travel;
    ghost.power = beam.field.power();
    ghost.spot = straytrace::spot(beam.mode);
    ghost.path_length = beam.path_length;
    if (way.size() < standing_.size()) ghost.standing = standing_[way.size()];
    ghost.way = way;
    each_(ghost);
  }

 private:
  World const& world_;
  MainBeam const& main_;
  std::function<void(Ghost const&)> const& each_;
  std::vector<GhostAlignment> standing_;  // behind each surface of the way; the first: as launched
  std::uint64_t count_ = 0;
};

}  // namespace

BeamEnergyBalance find_ghosts(World const& world, BeamLaunch const& launch, TreeLimits const& limits,
                              MainBeam const& main, std::function<void(Ghost const&)> const& each) {
  Rows rows(world, main, each);
  return grow_tree(world, launch, limits, rows);
}

}  // namespace straytrace
