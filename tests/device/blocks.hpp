// SPDX-License-Identifier: BSD-3-Clause
// Sums of blocks as one string of bytes, and the emulation of a device.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "base/every_module.hpp"
#include "scene/scene.hpp"
#include "trace/backend/device/device_backend.hpp"
#include "trace/deterministic/halo_source.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::testing {

// The emulation, or the engine that STRAYTRACE_TEST_ENGINE names.
inline std::string engine_tested() {
  char const* const named = std::getenv("STRAYTRACE_TEST_ENGINE");
  return named ? named : STRAY_EMULATION;
}

// One of examples/, ready to be traced.
inline World example(std::string const& name) {
  Scene const scene = read_scene(STRAY_SOURCE_DIR "/examples/" + name + ".yaml", {});
  World world = build_world(scene);
  scene.throw_if_problems();
  steer(world);
  return world;
}

// A cavity whose baffles lie in light below the crossover angle, ready to be traced.
inline World arm_in_halo() {
  Scene const scene = read_scene(STRAY_SOURCE_DIR "/tests/scenes/crossover_arm.yaml", {});
  World world = build_world(scene);
  scene.throw_if_problems();
  ArmCavity const arm = planned_arm(world, world.wave);
  begin_rays_at_crossover(world);
  PolarIrradiance const even{2e-3, 80, 32, std::vector<float>(80 * 32, 1e-4f), std::vector<float>(80 * 32, 2e-8f)};
  std::vector<PolarIrradiance> const planes(arm.rims.size() + 2, even);
  world.light_halo(halo_source(world, arm, {planes, planes}));
  steer(world);
  return world;
}

class Bytes {
 public:
  template <class T>
  void put(T const& x) {
    if constexpr (std::is_arithmetic_v<T>) {
      char raw[sizeof x];
      std::memcpy(raw, &x, sizeof x);
      text.append(raw, sizeof x);
    } else {
      put(std::uint64_t(x.size()));
      for (auto const& element : x) put(element);
    }
  }
  template <class Key, class T>
  void put(std::pair<Key const, T> const& x) {
    put(x.first);
    put(x.second);
  }
  void put(Moments const& m) {
    for (double const x : {m.sum, m.sum2, m.sum3, m.sum4, m.block_sum2, m.largest, m.first_sum}) put(x);
    put(m.largest_history);
    put(m.scored);
    put(m.tail);
  }
  void put(ScoreAddress const& s) {
    put(s.history);
    put(s.event);
    put(s.connection);
    put(s.coupling);
    put(s.priority);
  }
  void put(ClassSums const& c) {
    put(c.port);
    put(c.moments);
    put(c.replica_sum);
    put(c.kept);
    put(c.off_list);
    put(c.threshold);
  }
  void put(MapSums const& m) {
    put(m.sum);
    put(m.sum2);
  }
  void put(FieldSums const& f) {
    put(f.power);
    put(f.real);
    put(f.imaginary);
  }
  void put(ReceiverSums const& r) {
    put(r.power);
    put(r.image);
    put(r.angles);
    put(r.quadrants);
    put(r.fields);
  }
  void put(BlockSums const& b) {
    for (std::uint64_t const x : {b.histories, b.blocks, b.bounces, b.rays, b.lost}) put(x);
    put(b.classes);
    put(b.emitted);
    put(b.energy_balance);
    put(b.window_variance);
    put(b.receivers);
    put(b.arrived);
    put(b.absorbed);
  }

  std::string text;
};

inline std::string bytes_of(BlockSums const& sums) {
  Bytes bytes;
  bytes.put(sums);
  return bytes.text;
}

}  // namespace straytrace::testing
