// SPDX-License-Identifier: BSD-3-Clause
#include "world/search/search_kernels.hpp"

#include <cstdlib>

#include "geometry/mesh/triangle_mesh.hpp"
#include "world/model/view.hpp"

namespace straytrace::world {
namespace {

// Several rays at once. Each first searches everything but the meshes, which it notes; then the rays take turns in the
// meshes noted, so that some proceed while one waits for memory. The hits equal those of one ray after the other, bit
// by bit.

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

// Notes meshes for later while there is space, and passes all other surfaces to `others`.
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

// One of the interleaved rays, with its pending meshes.
template <int Width>
class RayAmongMeshes {
 public:
  // Takes the next ray from the list, or the next mesh of its ray; false: none remains.
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

// The kernels.

template <class Shape>
STRAY_INLINE Crossing meet(WorldView const& world, SurfaceRef ref, Ray const& ray, Departure const& from) {
  return {std::get<View<Shape const>>(world.shapes.arrays)[ref.shape().index].distance(ray, from.on(ref.surface)), 0};
}

using CrossOne = Crossing (*)(WorldView const&, std::uint32_t, Ray const&, Departure const&);

// Common shapes are tested in place, all others by a call: code that stays in the cache.
template <CrossOne others>
struct CrossHere {
  WorldView const& world;
  STRAY_INLINE Crossing operator()(SurfaceRef ref, Ray const& ray, Departure const& from) const {
    switch (ref.shape().kind) {
      case kind_of<Disk, ShapeTypes>():
        return meet<Disk>(world, ref, ray, from);
      case kind_of<Cylinder, ShapeTypes>():
        return meet<Cylinder>(world, ref, ray, from);
      case kind_of<Cap, ShapeTypes>():
        return meet<Cap>(world, ref, ray, from);
      default: {
        Ray const copy = ray;  // the caller's own numbers stay in registers
        return others(world, ref.surface, copy, from);
      }
    }
  }
};
// In tubes most is plain, and mirrors end them: the rest by a call, with copies, so that the caller's own numbers stay
// in registers.
template <CrossOne others>
struct CrossCalled {
  WorldView const& world;
  STRAY_INLINE Crossing operator()(SurfaceRef ref, Ray const& ray, Departure const& from) const {
    if (ref.shape().kind == kind_of<Cap, ShapeTypes>()) return meet<Cap>(world, ref, ray, from);
    Ray const copy = ray;
    return others(world, ref.surface, copy, from);
  }
};

template <CrossOne others>
STRAY_INLINE Hit closest_of_trees(WorldView const& world, Ray const& ray, Departure const& from, Hit const& known) {
  CrossHere<others> const cross{world};
  NearestQuery<CrossHere<others>> query(ray, from, cross, known);
  double limit = known.distance;
  if (world.limits.brute_force)
    world.search_all(ray, query);
  else
    world.tree.traverse_trees(ray, limit, query);
  return query.best();
}

using Tubes = Hit (*)(WorldView const&, Ray const&, Departure const&);
using Trees = Hit (*)(WorldView const&, Ray const&, Departure const&, Hit const&);

// Several tubes, or a ray from outside.
template <CrossOne others, Trees trees>
STRAY_INLINE Hit closest_of_tubes(WorldView const& world, Ray const& ray, Departure const& from) {
  CrossCalled<others> const cross{world};
  NearestQuery<CrossCalled<others>> query(ray, from, cross, {{}, ray.t_max});
  double limit = ray.t_max;
  world.tree.traverse_tubes(ray, limit, query);
  if (world.tree.clusters.size > 0) return trees(world, ray, from, query.best());
  return {{query.surface}, query.distance, query.piece};  // not best(): a copy would wait for its parts
}

// The usual case: one tube, and the ray starts inside.
template <CrossOne others, Tubes tubes, Trees trees>
STRAY_INLINE Hit closest_of_tube(WorldView const& world, Ray const& ray, Departure const& from) {
  TubeArrays const& known = world.tree.tubes;
  TubeProbe p;
  if (known.tubes.size > 1 || !TubeArrays::starts_inside(known.tubes[0], ray, p)) return tubes(world, ray, from);
  CrossCalled<others> const cross{world};
  NearestQuery<CrossCalled<others>> query(ray, from, cross, {{}, ray.t_max});
  double limit = ray.t_max;
  known.follow<false>(known.tubes[0], ray, p, limit, query);
  if (world.tree.clusters.size > 0) return trees(world, ray, from, query.best());
  return {{query.surface}, query.distance, query.piece};
}

// From the wall of a tube to itself in a few steps, everything else by a call: little to save and restore.
template <Tubes tube, Trees trees>
STRAY_INLINE Hit closest_of_all(WorldView const& world, Ray const& ray, Departure const& from) {
  TubeArrays const& known = world.tree.tubes;
  if (world.limits.brute_force || known.tubes.size == 0) return trees(world, ray, from, {{}, ray.t_max});
  if (from.surface.value == known.tubes[0].sole_wall && known.tubes.size == 1) {
    double const t = known.along_wall(known.tubes[0], ray);
    if (t < infinity)
      return world.tree.clusters.size > 0 ? trees(world, ray, from, {from.surface, t, 0}) : Hit{from.surface, t, 0};
  }
  return tube(world, ray, from);
}

using Closest = Hit (*)(WorldView const&, Ray const&, Departure const&);

// Without meshes no search waits long for memory.
template <int width, CrossOne others, Closest closest>
STRAY_INLINE void together(WorldView const& world, RayQuery const* queries, Hit* hits, std::uint32_t count) {
  bool const meshes = std::get<View<TriangleMesh const>>(world.shapes.arrays).size > 0;
  if (meshes && !world.limits.brute_force) {
    closest_together<width>(world, queries, hits, count, CrossHere<others>{world});
    return;
  }
  for (std::uint32_t i = 0; i < count; ++i) hits[i] = closest(world, queries[i].ray, queries[i].from);
}

template <CrossOne others>
STRAY_INLINE bool any(WorldView const& world, Ray const& ray, Departure const& from, bool to_itself) {
  CrossHere<others> const cross{world};
  return world.search(ray, AnyQuery<CrossHere<others>>{cross, from, ray, to_itself});
}

// Functions that carry the instruction set; all above is inlined into them. Tubes in one, all else in others: each loop
// keeps its numbers in registers.
#define STRAY_KERNELS(isa, width, ...)                                                                               \
  __VA_ARGS__ __attribute__((noinline))                                                                              \
  Crossing cross_##isa(WorldView const& world, std::uint32_t id, Ray const& ray, Departure const& from) {            \
    return world.cross(id, ray, from);                                                                               \
  }                                                                                                                  \
  __VA_ARGS__ __attribute__((noinline))                                                                              \
  Hit trees_##isa(WorldView const& world, Ray const& ray, Departure const& from, Hit const& known) {                 \
    return closest_of_trees<cross_##isa>(world, ray, from, known);                                                   \
  }                                                                                                                  \
  __VA_ARGS__ __attribute__((noinline))                                                                              \
  Hit tubes_##isa(WorldView const& world, Ray const& ray, Departure const& from) {                                   \
    return closest_of_tubes<cross_##isa, trees_##isa>(world, ray, from);                                             \
  }                                                                                                                  \
  __VA_ARGS__ __attribute__((noinline))                                                                              \
  Hit tube_##isa(WorldView const& world, Ray const& ray, Departure const& from) {                                    \
    return closest_of_tube<cross_##isa, tubes_##isa, trees_##isa>(world, ray, from);                                 \
  }                                                                                                                  \
  __VA_ARGS__ Hit closest_##isa(WorldView const& world, Ray const& ray, Departure const& from) {                     \
    return closest_of_all<tube_##isa, trees_##isa>(world, ray, from);                                                \
  }                                                                                                                  \
  __VA_ARGS__ bool occluded_##isa(WorldView const& world, Ray const& ray, Departure const& from, bool to_itself) {   \
    return any<cross_##isa>(world, ray, from, to_itself);                                                            \
  }                                                                                                                  \
  __VA_ARGS__ void together_##isa(WorldView const& world, RayQuery const* queries, Hit* hits, std::uint32_t count) { \
    together<width, cross_##isa, closest_##isa>(world, queries, hits, count);                                        \
  }                                                                                                                  \
  constexpr SearchKernels isa##_kernels{#isa, closest_##isa, together_##isa, occluded_##isa};

STRAY_KERNELS(portable, 2, __attribute__((flatten)))
#if STRAY_VECTORS && defined(__x86_64__)
STRAY_KERNELS(avx2, 4, __attribute__((flatten, target("avx2,bmi,bmi2,lzcnt"))))
STRAY_KERNELS(avx512, 8, __attribute__((flatten, target("avx512f,avx512vl,avx512dq,avx512bw,bmi,bmi2,lzcnt"))))
#endif
#undef STRAY_KERNELS

SearchKernels const* choose() {
  if (char const* const wanted = std::getenv("STRAYTRACE_ISA"))
    if (SearchKernels const* const found = find_search_kernels(wanted)) return found;
  for (std::string_view const name : {"avx512", "avx2"})
    if (SearchKernels const* const found = find_search_kernels(name)) return found;
  return &portable_kernels;
}

}  // namespace

SearchKernels const* find_search_kernels(std::string_view name) {
  if (name == "portable") return &portable_kernels;
#if STRAY_VECTORS && defined(__x86_64__)
  __builtin_cpu_init();
  bool const bits = __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  if (name == "avx2" && bits && __builtin_cpu_supports("avx2")) return &avx2_kernels;
  if (name == "avx512" && bits && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
    return &avx512_kernels;
#endif
  return nullptr;
}

SearchKernels const* search_kernels = choose();

}  // namespace straytrace::world
