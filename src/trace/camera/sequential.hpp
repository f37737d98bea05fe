// SPDX-License-Identifier: BSD-3-Clause
// Sequential tracing: one ray through surfaces in an order that is given, with the indices of a prescription. Nothing
// is searched for and nothing is drawn, so it checks the walk, which has to find both by itself.
#pragma once

#include <span>
#include <vector>

#include "trace/coupling.hpp"
#include "world/model/view.hpp"

namespace straytrace {

struct SequenceStep {
  SurfaceId surface;
  Event event = Event::transmit;  // or Event::reflect
  double index = 1;               // of the medium behind the surface, as the light travels; unused by a reflection
};

// What happened at one surface of the list.
struct SequencePoint {
  Vec3 point, dir;             // m; direction in which the light leaves
  double n_in = 1, n_out = 1;  // of the media the light comes from and leaves into
  double path_length = 0;      // optical, from the start of the ray, m
  std::uint32_t piece = 0;
};

enum class SequenceEnd : std::uint8_t { complete, missed, total_reflection };

struct Sequence {
  std::vector<SequencePoint> points;  // as far as the ray came
  SequenceEnd end = SequenceEnd::complete;
};

// Surfaces that coincide (cemented, touching) are one boundary and are listed once. `index`: of the medium in which the
// ray starts; `from`: the surface it starts on, if any.
Sequence trace_sequence(WorldView const&, Ray start, std::span<SequenceStep const>, double index = 1,
                        Departure from = {});

}  // namespace straytrace
