// SPDX-License-Identifier: BSD-3-Clause
// Sequential tracing: one ray through surfaces in a given order, with the indices of a prescription. Nothing is
// searched for and nothing is sampled, so it checks the walk, which does both.
#pragma once

#include <span>
#include <vector>

#include "base/every_module.hpp"
#include "trace/coupling.hpp"
#include "world/model/world.hpp"

namespace straytrace::testing {

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

// Vector form of Snell's law: n_out t - n_in d is along the normal, d and t unit vectors. False: total reflection.
inline bool snell(Vec3 d, Vec3 normal, double n_in, double n_out, Vec3& t) {
  double const ratio = n_in / n_out, cos_in = -dot(d, normal);
  double const sine2 = ratio * ratio * length2(d + cos_in * normal);
  if (sine2 > 1) return false;
  t = unit(ratio * d + (ratio * cos_in - std::sqrt(1 - sine2)) * normal);
  return true;
}

// Surfaces that coincide (cemented, touching) are one boundary and are listed once. `index`: of the medium in which the
// ray starts; `from`: the surface it starts on, if any.
inline Sequence trace_sequence(WorldView const& world, Ray ray, std::span<SequenceStep const> steps, double index = 1,
                               Departure from = {}) {
  Sequence result;
  result.points.reserve(steps.size());
  double length = 0;
  for (SequenceStep const& step : steps) {
    Crossing const met = world.cross(step.surface.value, ray, from);
    if (!(met.distance < infinity)) {
      result.end = SequenceEnd::missed;
      return result;
    }
    length += index * met.distance;
    SequencePoint at;
    at.point = world.project(step.surface, ray.origin + met.distance * ray.dir, met.piece);
    at.piece = met.piece;
    at.path_length = length;
    at.n_in = index;
    at.n_out = step.event == Event::transmit ? step.index : index;
    Vec3 normal = world.normal(step.surface, at.point, met.piece);
    if (dot(ray.dir, normal) > 0) normal = -normal;
    if (step.event != Event::transmit) {
      at.dir = unit(reflected(ray.dir, normal));
    } else if (!snell(ray.dir, normal, at.n_in, at.n_out, at.dir)) {
      result.end = SequenceEnd::total_reflection;
      return result;
    }
    result.points.push_back(at);
    index = at.n_out;
    ray = {at.point, at.dir, infinity};
    from = {step.surface, met.piece};
  }
  return result;
}

}  // namespace straytrace::testing
