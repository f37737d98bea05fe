// SPDX-License-Identifier: BSD-3-Clause
// The hit and the start of a ray, and the queries of a search.
#pragma once

#include "geometry/shape_types.hpp"
#include "world/search/tube.hpp"

namespace straytrace::world {

struct Hit {
  SurfaceId surface;
  double distance = infinity;  // m
  std::uint32_t piece = 0;     // of a surface made of pieces
};

// The start surface of a ray: the root at zero is not a hit there.
struct Departure {
  SurfaceId surface;
  std::uint32_t piece = 0;
  SurfaceId contact;  // a second surface in contact with the first at this point (cemented, touching lenses)
  STRAY_HD Departure() = default;
  STRAY_HD Departure(SurfaceId s, std::uint32_t p = 0, SurfaceId c = {}) : surface(s), piece(p), contact(c) {}
  STRAY_HD bool on(std::uint32_t id) const { return id == surface.value || id == contact.value; }
};

struct RayQuery {
  Ray ray;
  Departure from;
};

// Whether a hit at t on surface `id` is nearer than the best so far (invalid surface: none); ties to the lower id.
STRAY_HD bool nearer(double t, std::uint32_t id, double distance, std::uint32_t surface) {
  return t < distance || (t == distance && surface != SurfaceId{}.value && id < surface);
}
// The least limit that still admits ties with t.
STRAY_HD double just_beyond(double t) { return t * (1 + 0x1p-52); }

// Query for the nearest hit, ties to the lower surface. `Cross` computes where a ray crosses one surface. Holds plain
// numbers only, which stay in registers.
template <class Cross>
struct NearestQuery {
  Cross const& cross_one;
  Departure const& from;
  Ray const& ray;
  double distance, reach;  // m: of the best hit; just beyond it, to admit ties
  std::uint32_t surface, piece = 0;
  STRAY_HD NearestQuery(Ray const& r, Departure const& f, Cross const& c, Hit const& known)
      : cross_one(c),
        from(f),
        ray(r),
        distance(known.distance),
        reach(just_beyond(distance)),
        surface(known.surface.value),
        piece(known.piece) {}
  STRAY_HD Hit best() const {
    Hit hit;
    hit.surface.value = surface;
    hit.distance = distance;
    hit.piece = piece;
    return hit;
  }
  STRAY_HD bool leaves(std::uint32_t id) const { return from.on(id); }
  STRAY_HD double end() const { return reach; }
  STRAY_INLINE bool cross(SurfaceRef ref, double& limit) {
    Ray bounded = ray;
    bounded.t_max = reach;
    Crossing const c = cross_one(ref, bounded, from);
    return offer(ref.surface, c.distance, limit, c.piece);
  }
  STRAY_INLINE bool offer(std::uint32_t id, double t, double& limit, std::uint32_t at_piece = 0) {
    if (nearer(t, id, distance, surface)) {
      distance = t;
      surface = id;
      piece = at_piece;
      reach = just_beyond(t);
      limit = t;
    }
    return false;
  }
};

// Query whether the ray hits anything.
template <class Cross>
struct AnyQuery {
  Cross const& cross_one;
  Departure const& from;
  Ray const& ray;
  bool to_itself;  // the ray ends on the surface it starts on; a quadric cannot hide itself
  STRAY_HD bool leaves(std::uint32_t surface) const { return from.on(surface); }
  STRAY_HD double end() const { return ray.t_max; }
  STRAY_INLINE bool cross(SurfaceRef ref, double&) {
    Ray bounded = ray;
    if (to_itself && from.on(ref.surface) && !kind_may_hide_itself(ref.shape().kind)) return false;
    return cross_one(ref, bounded, from).distance < infinity;
  }
  STRAY_INLINE bool offer(std::uint32_t surface, double t, double&) {
    return t < infinity && !(to_itself && from.on(surface));
  }
};

}  // namespace straytrace::world
