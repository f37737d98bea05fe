// SPDX-License-Identifier: BSD-3-Clause
#include "trace/camera/sequential.hpp"

namespace straytrace {
namespace {

// Vector form of Snell's law: n_out t - n_in d is along the normal, d and t unit vectors. False: total reflection.
bool snell(Vec3 d, Vec3 normal, double n_in, double n_out, Vec3& t) {
  double const ratio = n_in / n_out, cos_in = -dot(d, normal);
  double const sine2 = ratio * ratio * length2(d + cos_in * normal);
  if (sine2 > 1) return false;
  t = unit(ratio * d + (ratio * cos_in - std::sqrt(1 - sine2)) * normal);
  return true;
}

}  // namespace

Sequence trace_sequence(WorldView const& world, Ray ray, std::span<SequenceStep const> steps, double index,
                        Departure from) {
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

}  // namespace straytrace
