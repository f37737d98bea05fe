// SPDX-License-Identifier: BSD-3-Clause
// Points on a regular lattice over every surface, and all surfaces near such a point. Inside the room.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "optics/media_stack.hpp"
#include "world/world.hpp"

namespace straytrace {

// Asks for every surface that a ray meets, but the one it starts on.
struct AllHitsQuery {
  struct Found {
    std::uint32_t surface;
    Crossing crossing;
  };
  WorldView const& view;
  Ray const& ray;
  Departure from;
  std::vector<Found>& found;
  bool leaves(std::uint32_t id) const { return from.on(id); }
  double end() const { return ray.t_max; }
  bool cross(SurfaceRef ref, double&) {
    if (from.on(ref.surface)) return false;
    Crossing const c = view.cross(ref.surface, ray, from);
    if (c.distance < infinity) found.push_back({ref.surface, c});
    return false;
  }
  bool offer(std::uint32_t id, double t, double&) {
    if (t < infinity && !from.on(id)) found.push_back({id, {t, 0}});
    return false;
  }
};

inline std::vector<AllHitsQuery::Found> surfaces_along(WorldView const& view, Ray const& ray, Departure from) {
  std::vector<AllHitsQuery::Found> found;
  view.search(ray, AllHitsQuery{view, ray, from, found});
  return found;
}

struct FaceSample {
  SurfaceId surface;
  std::uint32_t piece = 0;
  Vec3 point, normal;
};

// How many points each surface gets: 256, fewer where there are many surfaces, so that all together stay near a
// million.
inline int samples_per_face(std::size_t surfaces) {
  return int(std::clamp<std::size_t>(1'000'000 / std::max<std::size_t>(surfaces, 1), 16, 256));
}

inline std::vector<FaceSample> face_samples(WorldView const& view, std::uint32_t id, int count) {
  std::vector<FaceSample> all;
  view.shapes.visit(view.surfaces[id].shape, [&](auto const& shape) {
    if (!(shape.area() > 0)) return;
    for (int i = 0; i < count; ++i) {
      double const turns = (i + 0.5) * 0.6180339887498949;  // golden ratio: points fill the unit square evenly
      SurfacePoint const drawn = sample_of(shape, (i + 0.5) / count, turns - std::floor(turns));
      Vec3 const point = projected_on(shape, drawn.point, drawn.piece);
      all.push_back({{id}, drawn.piece, point, normal_of(shape, point, drawn.piece)});
    }
  });
  return all;
}

}  // namespace straytrace
