// SPDX-License-Identifier: BSD-3-Clause
// The yardstick: Embree 3 on the triangles of a scene in float, or on its analytic surfaces through double callbacks.
#pragma once

#include <embree3/rtcore.h>

#include <span>
#include <vector>

#include "scenes.hpp"

namespace straytrace::bench {

RTCDevice counting_device();  // of one thread; it counts the bytes that scenes take

class EmbreeScene {
 public:
  // robust, fast: trees with spatial splits (build quality high); robust_default: as Embree builds when it is not
  // asked.
  enum class Mode { robust, fast, robust_default };
  EmbreeScene(RTCDevice device, std::vector<Triangle> const& triangles, Mode mode);
  // Each surface is one user primitive; its callback calls the same double shapes as the engine.
  EmbreeScene(RTCDevice device, World const& world);
  ~EmbreeScene() { rtcReleaseScene(scene_); }
  EmbreeScene(EmbreeScene const&) = delete;
  EmbreeScene& operator=(EmbreeScene const&) = delete;

  std::size_t bytes() const { return bytes_; }  // of triangles and tree

  // Traces all rays; returns how many hit something.
  std::size_t single(std::span<BenchRay const> rays) const;
  std::size_t packets_of_8(std::span<BenchRay const> rays) const;
  std::size_t packets_of_16(std::span<BenchRay const> rays) const;
  std::size_t double_callbacks(std::span<BenchRay const> rays) const;

 private:
  RTCScene scene_;
  WorldView world_;
  std::size_t bytes_;
};

}  // namespace straytrace::bench
