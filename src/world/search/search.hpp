// SPDX-License-Identifier: BSD-3-Clause
// Search structure: tubes (tube.hpp) for long coaxial surfaces, eight-wide trees (geometry/mesh/bvh8.hpp) for all
// others. Trees are local: each holds surfaces of one size class from one neighbourhood, which keeps float boxes tight;
// a tree over the trees is searched in order of distance. The structure only proposes surfaces; their shapes decide
// about hits, in double, so it cannot change a result.
#pragma once

#include <cstdint>
#include <vector>

#include "base/math/simd.hpp"
#include "base/memory/ids.hpp"
#include "geometry/mesh/bvh8.hpp"
#include "geometry/shape_types.hpp"
#include "world/search/tube.hpp"

namespace straytrace::world {

// The hit and the start of a ray, and the queries of a search.

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

// The surfaces of one leaf, side by side, each in a ring about its own axis: between two heights and two radii. A box
// along x, y, z is much larger than a tilted disc or barrel; the ring fits closely, and the test of eight rings takes
// about as long as that of one shape. Floats are widened: the ray certainly misses a surface that the test rejects.

// Bounds of a surface: a box, and heights along its axis and distances from it that contain it.
struct SearchItem {
  SurfaceRef ref;
  Box box;
  Vec3 reference, axis{0, 0, 1};  // heights are measured from the reference point
  Extent extent;
  std::uint32_t plain_kind = 0;  // see TubePart
  TubePlain plain = {};
};

struct alignas(64) SurfacePack {
  float centre[3][simd::lanes], axis[3][simd::lanes];  // m from the origin of the tree
  float low[simd::lanes], high[simd::lanes];           // m along the axis
  float inner2[simd::lanes], outer2[simd::lanes];      // m^2
  SurfaceRef ref[simd::lanes];

  // `largest`: m, local coordinate of the tree. Rounding of the ray, of its direction over lengths up to four times
  // `largest` and of some forty operations moves a point by less than 2^-18 of the coordinates, if `widen` is 1.
  void set(int lane, SearchItem const&, Vec3 origin, double largest, double widen = 1);

  // Bit i: surface i may be hit before `limit`, m from the start of the probe.
  STRAY_INLINE unsigned may_be_hit(bvh8_detail::Probe const& probe, float limit) const;

 private:
  // For one lane or for all: F is a float or eight of them, M the result of comparing two F.
  template <class F, class M>
  STRAY_INLINE static void test(F const (&c)[3], F const (&n)[3], F const& low, F const& high, F const& inner2,
                                F const& outer2, bvh8_detail::Probe const& p, float limit, M& missed);
};
static_assert(sizeof(SurfacePack) == 384);

template <class F, class M>
STRAY_INLINE void SurfacePack::test(F const (&c)[3], F const (&n)[3], F const& low, F const& high, F const& inner2,
                                    F const& outer2, bvh8_detail::Probe const& p, float limit, M& missed) {
  F const ox = p.origin[0] - c[0], oy = p.origin[1] - c[1], oz = p.origin[2] - c[2];
  F const height = ox * n[0] + oy * n[1] + oz * n[2], slope = p.dir[0] * n[0] + p.dir[1] * n[1] + p.dir[2] * n[2];
  F const inverse = 1 / slope;  // zero: infinity with its sign
  F const a = (low - height) * inverse, b = (high - height) * inverse;
  F const first = inverse < 0 ? b : a, second = inverse < 0 ? a : b;
  F near = F{}, far = limit - F{};
  near = first > near ? first : near;  // NaN: no bound
  far = second < far ? second : far;
  // Squared distance from the axis, a convex function of the length.
  F const px = ox - height * n[0], py = oy - height * n[1], pz = oz - height * n[2];
  F const dx = p.dir[0] - slope * n[0], dy = p.dir[1] - slope * n[1], dz = p.dir[2] - slope * n[2];
  auto const radius2 = [&](F const& t, F& out) STRAY_INLINE_LAMBDA {
    F const x = px + t * dx, y = py + t * dy, z = pz + t * dz;
    out = x * x + y * y + z * z;
  };
  F lowest = (px * dx + py * dy + pz * dz) / -(dx * dx + dy * dy + dz * dz);
  lowest = lowest > near ? lowest : near;
  lowest = lowest < far ? lowest : far;
  F least, begin, end;
  radius2(lowest, least);
  radius2(near, begin);
  radius2(far, end);
  missed = (near > far * (1 + 6 * 0x1p-23f)) | (least > outer2) | ((begin < inner2) & (end < inner2));
}

STRAY_INLINE unsigned SurfacePack::may_be_hit(bvh8_detail::Probe const& probe, float limit) const {
#if STRAY_VECTORS
  using simd::loaded;
  simd::Floats const c[3] = {loaded(centre[0]), loaded(centre[1]), loaded(centre[2])};
  simd::Floats const n[3] = {loaded(axis[0]), loaded(axis[1]), loaded(axis[2])};
  simd::Ints missed;
  test(c, n, loaded(low), loaded(high), loaded(inner2), loaded(outer2), probe, limit, missed);
  return ~simd::bits_set(missed);
#else
  unsigned bits = 0;
  for (int i = 0; i < simd::lanes; ++i) {
    float const c[3] = {centre[0][i], centre[1][i], centre[2][i]}, n[3] = {axis[0][i], axis[1][i], axis[2][i]};
    bool missed;
    test(c, n, low[i], high[i], inner2[i], outer2[i], probe, limit, missed);
    bits |= unsigned(!missed) << i;
  }
  return bits;
#endif
}

// Properties of a shape for the search structure.

namespace search_item_detail {

inline bool is_z_axis(Vec3 at, Vec3 axis) {
  return at.x == 0 && at.y == 0 && axis.x == 0 && axis.y == 0 && std::fabs(axis.z) == 1;
}
inline void set_plain(Disk const& s, SearchItem& item) {
  if (!is_z_axis(s.centre, s.axis)) return;
  item.plain_kind = TubeArrays::plain_disk;
  item.plain = {s.centre.z, s.inner_radius * s.inner_radius, s.outer_radius * s.outer_radius, 0};
}
inline void set_plain(Cylinder const& s, SearchItem& item) {
  if (!is_z_axis(s.origin, s.axis) || s.axis.z < 0) return;
  item.plain_kind = TubeArrays::plain_wall;
  item.plain = {s.origin.z, s.radius * s.radius, s.from, s.to};
}

}  // namespace search_item_detail

// All but `ref`.
template <class Shape>
SearchItem search_item(Shape const& shape) {
  SearchItem item;
  item.box = shape.bounds();
  item.reference = shape.reference();
  item.axis = shape.axis;
  item.extent = shape.extent();
  using search_item_detail::set_plain;
  if constexpr (requires { set_plain(shape, item); }) set_plain(shape, item);
  return item;
}

// One local tree: a slice of the flat array of nodes. Its leaves are packs; those of the tree over the trees are
// clusters.
struct ClusterRecord {
  Vec3 origin;
  double largest = 0;
  Box root;
  std::uint32_t first_node = 0, nodes = 0;
};

struct SearchView {
  TubeArrays tubes;
  View<ClusterRecord const> clusters;  // the last one, when there are several, is the tree over the others
  View<Bvh8::Node const> nodes;
  View<SurfacePack const> packs;

  // Calls query.cross(ref, limit) for every surface that may be hit before `limit` (m), and the other functions that
  // TubeArrays needs. A call may lower the limit and returns true to end the search; so do these functions.
  template <class Query>
  STRAY_INLINE bool traverse(Ray const& ray, double limit, Query&& query) const {
    return traverse_tubes(ray, limit, query) || traverse_trees(ray, limit, query);
  }
  template <class Query>
  STRAY_INLINE bool traverse_tubes(Ray const& ray, double& limit, Query&& query) const {
    for (std::size_t i = 0; i < tubes.tubes.size; ++i)
      if (tubes.traverse(tubes.tubes[i], ray, limit, query)) return true;
    return false;
  }
  template <class Query>
  STRAY_INLINE bool traverse_trees(Ray const& ray, double& limit, Query&& query) const {
    if (clusters.size == 0) return false;
    if (clusters.size == 1) return traverse_tree(clusters[0], ray, limit, query);
    ClusterRecord const& top = clusters[clusters.size - 1];
    bool done = false;
    tree_of(top).traverse(ray, limit, [&](std::uint32_t first, std::uint32_t, double&) STRAY_INLINE_LAMBDA {
      done = traverse_tree(clusters[first], ray, limit, query);
      return done;
    });
    return done;
  }

 private:
  template <class Query>
  STRAY_INLINE bool traverse_tree(ClusterRecord const& c, Ray const& ray, double& limit, Query&& query) const {
    Bvh8::View const tree = tree_of(c);
    bvh8_detail::Probe probe;
    if (!probe.set(tree, ray, limit)) return false;
    bool done = false;
    tree.traverse_from(probe, limit, [&](std::uint32_t number, std::uint32_t count, double& end) STRAY_INLINE_LAMBDA {
      SurfacePack const& pack = packs[number];
      unsigned lanes = pack.may_be_hit(probe, bvh8_detail::rounded_up(end - probe.shift)) & ((1u << count) - 1);
      for (; lanes != 0 && !done; lanes &= lanes - 1) done = query.cross(pack.ref[simd::lowest(lanes)], end);
      return done;
    });
    return done;
  }
  STRAY_INLINE Bvh8::View tree_of(ClusterRecord const& c) const {
    return {{nodes.data + c.first_node, c.nodes}, c.origin, c.largest, c.root};
  }
};

class SearchTree {
 public:
  void build(std::vector<SearchItem> const& items);
  SearchView view() const {
    return {tubes_.view(),
            {clusters_.data(), clusters_.size()},
            {nodes_.data(), nodes_.size()},
            {packs_.data(), packs_.size()}};
  }
  TubeData const& tubes() const { return tubes_; }

 private:
  std::vector<SearchItem> take_tubes(std::vector<SearchItem> const& items);  // returns the others
  void add_cluster(std::vector<SearchItem> const& content);
  void add_tree(Bvh8 const&);

  TubeData tubes_;
  std::vector<ClusterRecord> clusters_;
  std::vector<Bvh8::Node> nodes_;
  std::vector<SurfacePack> packs_;
};

}  // namespace straytrace::world
