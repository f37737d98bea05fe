// SPDX-License-Identifier: BSD-3-Clause
// Several rays at once. Each first meets all but the meshes, which are noted; then the rays take turns in the meshes
// noted, so that one waits for memory while others go on. The hits are those of one ray after the other, bit by bit.
#pragma once

#include "geometry/mesh/triangle_mesh.hpp"
#include "world/model/world.hpp"

namespace straytrace {

// A mesh that a ray may hit, nearest first.
struct MeshAhead {
  std::uint32_t ray = 0;
  SurfaceRef ref;
};

class MeshesAhead {
 public:
  static constexpr int room = 256;
  MeshAhead list[room];
  int count = 0;

  STRAY_INLINE bool note(std::uint32_t ray, SurfaceRef ref) {
    if (count == room) return false;
    list[count++] = {ray, ref};
    return true;
  }
};

// Notes meshes for later while there is room, and asks `others` about everything else.
template <class Others>
struct CrossAllButMeshes {
  Others const& others;
  MeshesAhead* ahead;
  std::uint32_t number;  // of the ray
  STRAY_INLINE Crossing operator()(SurfaceRef ref, Ray const& ray, Departure const& from) const {
    if (ref.shape().kind == kind_of<TriangleMesh, ShapeTypes>() && ahead->note(number, ref)) return {};
    return others(ref, ray, from);
  }
};

// One of the rays that take turns, with the meshes that it still has to see.
template <int Width>
class RayAmongMeshes {
 public:
  // Takes the next ray from the list, or the next mesh of its ray; false: nothing is left.
  STRAY_INLINE bool begin(WorldView const& world, RayQuery const* queries, Hit const* hits, MeshesAhead const& ahead,
                          int& taken) {
    for (;;) {
      if (next_ == stop_) {
        if (taken == ahead.count) return false;
        next_ = taken;
        while (taken < ahead.count && ahead.list[taken].ray == ahead.list[next_].ray) ++taken;
        stop_ = taken;
      }
      now_ = ahead.list[next_++];
      RayQuery const& query = queries[now_.ray];
      Ray bounded = query.ray;
      bounded.t_max = just_beyond(hits[now_.ray].distance);
      auto const& mesh = std::get<View<TriangleMesh const>>(world.shapes.arrays)[now_.ref.shape().index];
      if (mesh_.begin(mesh, bounded, query.from.on(now_.ref.surface) ? query.from.piece : no_piece)) return true;
    }
  }
  STRAY_INLINE bool turn() { return mesh_.turn(); }
  STRAY_INLINE void finish(Hit* hits) const {
    Crossing const c = mesh_.result();
    Hit& best = hits[now_.ray];
    if (nearer(c.distance, now_.ref.surface, best.distance, best.surface.value))
      best = {{now_.ref.surface}, c.distance, c.piece};
  }

 private:
  MeshTurn<Width> mesh_;
  MeshAhead now_;
  int next_ = 0, stop_ = 0;
};

template <int Width>
STRAY_INLINE void take_turns(WorldView const& world, RayQuery const* queries, Hit* hits, MeshesAhead const& ahead) {
  constexpr int most = 16;
  RayAmongMeshes<Width> rays[most];
  int order[most], under_way = 0, taken = 0;
  while (under_way < most && rays[under_way].begin(world, queries, hits, ahead, taken)) {
    order[under_way] = under_way;
    ++under_way;
  }
  while (under_way > 0)
    for (int k = 0; k < under_way; ++k) {
      RayAmongMeshes<Width>& ray = rays[order[k]];
      if (ray.turn()) continue;
      ray.finish(hits);
      if (!ray.begin(world, queries, hits, ahead, taken)) order[k--] = order[--under_way];
    }
}

template <int Width, class Others>
STRAY_INLINE void closest_together(WorldView const& world, RayQuery const* queries, Hit* hits, std::uint32_t count,
                                   Others const& others) {
  MeshesAhead ahead;
  for (std::uint32_t i = 0; i < count; ++i) {
    CrossAllButMeshes<Others> const cross{others, &ahead, i};
    Ray const& ray = queries[i].ray;
    NearestQuery<CrossAllButMeshes<Others>> query(ray, queries[i].from, cross, {{}, ray.t_max});
    world.tree.traverse(ray, ray.t_max, query);
    hits[i] = query.best();
  }
  take_turns<Width>(world, queries, hits, ahead);
}

}  // namespace straytrace
