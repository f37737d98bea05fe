// SPDX-License-Identifier: BSD-3-Clause
// A world prepared for tracing: the only input of trace, replay and the drawing of rays, so none of them can run before
// the steering tables exist. Histories with other tables are other histories.
#pragma once

#include "world/model/world.hpp"

namespace straytrace::trace {

// Refers to a world, which must outlive it and stay unchanged. Made by steer() (trace/importance/importance.hpp).
class SteeredWorld {
 public:
  // With the tables of the world; without tables only the BSDF model chooses directions. For worlds that tests
  // and benchmarks build by hand, and for sums without histories.
  static SteeredWorld as_given(World const& world) { return SteeredWorld(world); }

  World const& world() const { return *world_; }
  World const* operator->() const { return world_; }
  operator World const&() const { return *world_; }
  WorldView view() const {
    WorldView all = world_->view();
    all.block_size = block_size;
    return all;
  }

  std::uint64_t block_size;  // histories, of the present run: at first that of the world

 private:
  friend SteeredWorld steer(World& world, unsigned threads);
  explicit SteeredWorld(World const& world) : block_size(world.block_size), world_(&world) {}
  World const* world_;
};

}  // namespace straytrace::trace
