// SPDX-License-Identifier: BSD-3-Clause
// Pairs of surfaces that share space: coincident faces and intersecting faces. Found by points drawn on every surface,
// so that a contact smaller than about 1 % of both surfaces may be missed.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "optics/media_stack.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {

struct FacePair {
  SurfaceId first, second;  // first < second
  Vec3 at;                  // m, a place where it is seen
  double depth = 0;         // m, depth of the intersection; 0: they coincide
};

// Surfaces within a nanometre of each other, over an area that light can reach: rounding or their order in the scene
// decides which of them it meets. Excluded are boundaries of two filled volumes (a cemented lens, which the
// walk passes as one boundary) and contacts that light cannot reach (inside closed bodies, or black on all sides).
std::vector<FacePair> coincident_faces(World const&);

// Surfaces of which each reaches past the other by more than `least_depth`, m. A surface that ends on another one
// (a baffle in its tube) is no crossing.
std::vector<FacePair> crossing_faces(World const&, double least_depth);

// Points on a regular lattice over every surface, and all surfaces near such a point. Inside the room.

// Collects every surface that a ray meets, except the one it starts on.
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
  if (!view.occluded(ray, from, true)) return found;  // by the fast search, as nearly always
  view.search(ray, AllHitsQuery{view, ray, from, found});
  return found;
}

struct FaceSample {
  SurfaceId surface;
  std::uint32_t piece = 0;
  Vec3 point, normal;
};

// Number of points per surface: 256, fewer where there are many surfaces, so that the total stays near a million.
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

// Integrals over the faces of a body, summed over samples. By the divergence theorem a closed body has
//   integral n dA = 0   and   integral x_i n_j dA = V delta_ij   with V > 0
// for normals n that point out.
struct BodyIntegrals {
  double normals[3] = {}, moments[3][3] = {}, magnitudes[3][3] = {}, area = 0;  // magnitudes: of |x_i n_j|

  // `share`: area of this sample; x in m from any point.
  void add(Vec3 x, Vec3 n, double share) {
    double const at[3] = {x.x, x.y, x.z}, along[3] = {n.x, n.y, n.z};
    area += share;
    for (int j = 0; j < 3; ++j) {
      normals[j] += share * along[j];
      for (int i = 0; i < 3; ++i) {
        moments[i][j] += share * at[i] * along[j];
        magnitudes[i][j] += share * std::fabs(at[i] * along[j]);
      }
    }
  }
  double enclosed() const { return (moments[0][0] + moments[1][1] + moments[2][2]) / 3; }
  // Within this share of the integrals of the magnitudes.
  bool closed(double tolerance) const {
    for (int j = 0; j < 3; ++j) {
      if (std::fabs(normals[j]) > tolerance * area) return false;
      for (int i = 0; i < 3; ++i)
        if (std::fabs(moments[i][j] - (i == j ? enclosed() : 0)) > tolerance * magnitudes[i][j]) return false;
    }
    return true;
  }
};

}  // namespace straytrace::world
