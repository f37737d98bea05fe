// SPDX-License-Identifier: BSD-3-Clause
// The view of a world for light: surfaces, optics, footprints of the beams, and the fast search for the closest hit, as
// pointers and sizes that are passed by value to the trace. World (world.hpp) owns the arrays.
#pragma once

#include "base/math/vec3.hpp"
#include "base/memory/ids.hpp"
#include "base/memory/storage.hpp"
#include "beams/footprint.hpp"
#include "geometry/shape_types.hpp"
#include "optics/coating/specular.hpp"
#include "optics/scatter/mixture.hpp"
#include "world/model/halo.hpp"
#include "world/model/receiver.hpp"
#include "world/model/steering.hpp"
#include "world/search/search.hpp"
#include "world/search/search_kernels.hpp"

namespace straytrace::world {

using ShapePool = Pool<ShapeTypes>;

struct Surface {
  PoolRef shape;
  static constexpr std::uint32_t none = 0xffffffffu;
  std::uint32_t front = 0, back = 0;  // optic on the side the normal points to, and on the other
  BodyId body;
  GroupId group;
  std::uint32_t volume = none;  // filled volume behind it: the normal points out of it
  bool clear = false;           // a measuring plane or a small defect: light passes, and it hides nothing
  bool smooth = false;          // a mesh with normals at its corners
  double scale = 0;             // m, the largest length in the computation of hits on it
};

// A filled volume: the glass of one lens. Volumes of instances of one part are different.
struct Volume {
  std::uint32_t medium = 0;
};

struct Medium {
  double index = 1;
  double absorption = 0;  // of power, 1/m
};

// Limits of the walk, and whether it uses the search structure. They are part of what determines a result.
struct WalkLimits {
  std::uint32_t max_order = 64;      // surface events after the source; light beyond counts as `truncated`
  double roulette_below = 0.1;       // of the power first scattered: below it paths survive by chance (unbiased)
  std::uint32_t route_vertices = 5;  // routes with more vertices than this are summed in the class `other`
  bool targets = true;               // aim at patches that the adjoint tables rate important (docs/theory/sampling.md)
  double law_share = 0.25;           // least share of directions from the BSDF, the others go to the targets (alpha)
  bool window = true;                // split and kill paths by power x adjoint (docs/theory/sampling.md)
  std::uint32_t children = 1;        // paths that leave the first vertex
  bool brute_force = false;          // test every surface: must give the same bits
};

struct WorldView {
  ShapePool shapes;
  LawPool laws;
  SpecularPool interfaces;
  View<Volume const> volumes;
  View<Medium const> media;
  View<Surface const> surfaces;
  View<Optic const> optics;
  View<Footprint const> lit;                 // all footprints
  View<std::uint32_t const> lit_of_surface;  // first receiving footprint on this surface, or none
  View<std::uint32_t const> emitters;        // footprints that emit
  View<Receiver const> receivers;
  View<std::uint32_t const> receiver_of_surface;  // the first, or none; measuring planes are not listed
  bool both_ends = false;                         // sub-paths start on receivers or in modes
  bool polarised = false;                         // the walk carries the state of polarisation
  SearchView tree;
  Steering steering;  // empty: sample the BSDF alone
  Halo halo;          // light of a cavity below the crossover angle; empty: none
  WalkLimits limits;
  double wavelength = 0;  // m
  std::uint64_t block_size = largest_block;
  static constexpr std::uint32_t none = 0xffffffffu;

  // 1 over the probability with which a history starts at one of the emitters.
  STRAY_HD double draws() const { return double(emitters.size) / (1 - halo.share); }

  // The smallest positive double distance, ties to the lower SurfaceId; `from` is the surface the ray starts on.
  STRAY_HD Hit closest(Ray const& ray, Departure from) const {
#if defined(__CUDA_ARCH__)
    auto const cross_one = [this](SurfaceRef r, Ray const& bounded, Departure const& f) {
      return cross(r.surface, bounded, f);
    };
    NearestQuery<decltype(cross_one)> query(ray, from, cross_one, {{}, ray.t_max});
    search(ray, query);
    return query.best();
#else
    return search_kernels->closest(*this, ray, from);
#endif
  }
  // The same for several rays at once: in meshes they take turns, which hides the latency of the memory.
  void closest_together(RayQuery const* queries, Hit* hits, std::uint32_t count) const {
    search_kernels->closest_together(*this, queries, hits, count);
  }
  // Whether anything lies between the origin and ray.t_max. `to_itself`: the ray ends on the surface it starts on; a
  // quadric has nothing in between.
  STRAY_HD bool occluded(Ray const& ray, Departure from, bool to_itself = false) const {
#if defined(__CUDA_ARCH__)
    auto const cross_one = [this](SurfaceRef r, Ray const& bounded, Departure const& f) {
      return cross(r.surface, bounded, f);
    };
    return search(ray, AnyQuery<decltype(cross_one)>{cross_one, from, ray, to_itself});
#else
    return search_kernels->occluded(*this, ray, from, to_itself);
#endif
  }
  STRAY_HD Crossing cross(std::uint32_t id, Ray const& ray, Departure from) const {
    return shapes.visit(surfaces[id].shape,
                        [&](auto const& s) { return crossing_of(s, ray, from.on(id), from.piece); });
  }
  // Tolerance of visibility: how much before a sampled point, `way` m away, a line may meet its surface, m (eq. 1.14).
  STRAY_HD double slack(SurfaceId id, double way, double cosine) const {
    return hit_slack(surfaces[id.value].scale, way, cosine);
  }
  STRAY_HD Vec3 normal(SurfaceId id, Vec3 p, std::uint32_t piece = 0) const {
    return shapes.visit(surfaces[id.value].shape, [&](auto const& s) { return normal_of(s, p, piece); });
  }
  STRAY_HD bool smooth(SurfaceId id) const { return surfaces[id.value].smooth; }
  // Between the normals at the corners of a mesh that has them; otherwise that of the surface.
  STRAY_HD Vec3 smooth_normal(SurfaceId id, Vec3 p, std::uint32_t piece) const {
    return shapes.visit(surfaces[id.value].shape, [&](auto const& s) { return smooth_normal_of(s, p, piece); });
  }
  STRAY_HD Vec3 project(SurfaceId id, Vec3 p, std::uint32_t piece = 0) const {
    return shapes.visit(surfaces[id.value].shape, [&](auto const& s) { return projected_on(s, p, piece); });
  }

  STRAY_HD Landing landing(SurfaceId id, Vec3 p, std::uint32_t piece = 0) const {
    return shapes.visit(surfaces[id.value].shape, [&](auto const& s) { return landing_on(s, p, piece); });
  }

  // Calls the query for every surface that the ray may hit until it returns true; returns whether it did.
  template <class Query>
  STRAY_INLINE bool search(Ray const& ray, Query&& query) const {
    return limits.brute_force ? search_all(ray, query) : tree.traverse(ray, ray.t_max, query);
  }
  template <class Query>
  STRAY_INLINE bool search_all(Ray const& ray, Query&& query) const {
    double limit = ray.t_max;
    for (std::uint32_t id = 0; id < surfaces.size; ++id)
      if (!surfaces[id].clear && query.cross(SurfaceRef::of(id, surfaces[id].shape), limit)) return true;
    return false;
  }
};

}  // namespace straytrace::world
