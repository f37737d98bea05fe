// SPDX-License-Identifier: BSD-3-Clause
// Tree of boxes, eight wide. Boxes are floats about a local origin in double and only select candidates: the function
// called for a leaf decides in double whether a ray hits. No hit inside a box of the input is ever lost:
//   boxes are widened by 2^-23 of the largest local coordinate and rounded outward (rounding of the ray's origin),
//   far distances are multiplied by 1 + 6 eps, the limit is rounded up (rounding of the slab test),
//   a ray from far away starts near the root box, moved there in double.
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "base/math/simd.hpp"
#include "base/math/vec3.hpp"
#include "base/memory/ids.hpp"

namespace straytrace::geometry {

namespace bvh8_detail {
struct Probe;
}

// Parameters of the construction. Costs are in units of one item tested.
struct Bvh8Settings {
  unsigned leaf_size = 4;     // items in a leaf, at most 16
  double traversal_cost = 1;  // of one more level
  unsigned pack = 1;          // items tested together: a leaf costs as many packs as it fills
  double growth = 0x1p-23;    // of boxes, by the largest local coordinate
};

class Bvh8 {
 public:
  struct alignas(64) Node {
    float bound[6][8];       // lower x, y, z and upper x, y, z of the children, m from the origin of the tree
    std::uint32_t child[8];  // node number; or, for leaf_mark set: items - 1 (4 bits), first item (27 bits)
    std::uint32_t spare[8];
  };
  static_assert(sizeof(Node) == 256);
  static constexpr std::uint32_t leaf_mark = 0x80000000u, first_bits = 27;
  static constexpr int stack_size = 192, depth_limit = 26;  // 7 per level wait

  struct View {
    straytrace::View<Node const> nodes;
    Vec3 origin;         // m, of the local coordinates
    double largest = 0;  // m, local coordinate of any box
    Box root;            // local, widened like the nodes

    // Calls leaf(first, count, limit) for every leaf that holds a hit nearer than `limit` (m along the ray), about in
    // the order of distance. `leaf` may lower the limit and returns true to end the search. The ray is given in the
    // frame of the boxes that the tree was built from.
    // `ahead(first)` is called for leaves that will be visited soon, to fetch what they need into the cache; when it is
    // given, nodes are fetched early too: that pays for trees larger than the cache.
    struct NothingAhead {};
    template <class Leaf, class Ahead = NothingAhead>
    STRAY_INLINE void traverse(Ray const& ray, double& limit, Leaf&& leaf, Ahead const& ahead = {}) const;
    // The same for a ray that was made a probe of this tree.
    template <class Leaf, class Ahead = NothingAhead>
    STRAY_INLINE void traverse_from(bvh8_detail::Probe const&, double& limit, Leaf&& leaf,
                                    Ahead const& ahead = {}) const;
  };
  View view() const { return {{nodes.data(), nodes.size()}, origin, largest, root}; }
  // Leaves hold names of the caller instead of boxes: name(first, count) is below 2^27.
  template <class Name>
  void rename_leaves(Name const& name) {
    constexpr std::uint32_t first_mask = (1u << first_bits) - 1;
    for (Node& node : nodes)
      for (std::uint32_t& child : node.child)
        if (child & leaf_mark)
          child = (child & ~first_mask) | name(child & first_mask, (child >> first_bits & 15u) + 1);
  }

  std::vector<Node> nodes;
  std::vector<std::uint32_t> order;  // item i of the leaves is box order[i] of the input
  Vec3 origin;
  double largest = 0;
  Box root;
};

// Binned surface-area heuristic; the same tree for the same boxes, always. At most 2^27 boxes.
Bvh8 build_bvh8(std::span<Box const> boxes, Bvh8Settings const& settings = {});

namespace bvh8_detail {

// Prefetches these bytes.
template <std::size_t Bytes>
STRAY_INLINE void fetch_early([[maybe_unused]] void const* from) {
#if STRAY_VECTORS
  for (std::size_t i = 0; i < Bytes; i += 64) __builtin_prefetch(static_cast<char const*>(from) + i);
#endif
}

// Not below x, for x > 0 (lengths to hits are positive).
STRAY_HD float rounded_up(double x) { return float(x) * (1 + 0x1p-22f); }

// The ray in the coordinates of the boxes.
struct Probe {
  float origin[3], dir[3], inverse[3];
  int near_row[3];   // of Node::bound: where the ray enters
  double shift = 0;  // m along the ray to `origin`

  // False: the ray misses the root box.
  STRAY_INLINE bool set(Bvh8::View const& tree, Ray const& ray, double limit) {
    Vec3 o = ray.origin - tree.origin;
    double const far_away = 1.25 * tree.largest;
    if (std::fabs(o.x) > far_away || std::fabs(o.y) > far_away || std::fabs(o.z) > far_away) {
      double near = 0, far = limit;
      clip(tree.root.lower.x, tree.root.upper.x, o.x, ray.dir.x, near, far);
      clip(tree.root.lower.y, tree.root.upper.y, o.y, ray.dir.y, near, far);
      clip(tree.root.lower.z, tree.root.upper.z, o.z, ray.dir.z, near, far);
      if (!(near * (1 - 1e-14) <= far * (1 + 1e-14))) return false;
      shift = near - 0.25 * tree.largest;
      o = o + shift * ray.dir;
    }
    double const from[3] = {o.x, o.y, o.z}, along[3] = {ray.dir.x, ray.dir.y, ray.dir.z};
    for (int k = 0; k < 3; ++k) {
      origin[k] = float(from[k]);
      dir[k] = float(along[k]);
      inverse[k] = float(1 / along[k]);  // a component of zero: infinity with its sign
      near_row[k] = inverse[k] < 0 ? 3 + k : k;
    }
    return true;
  }
  STRAY_INLINE static void clip(double low, double high, double o, double d, double& near, double& far) {
    double const inverse = 1 / d, a = (low - o) * inverse, b = (high - o) * inverse;
    double const first = inverse < 0 ? b : a, second = inverse < 0 ? a : b;
    if (first > near) near = first;  // NaN (a ray in the face of the box): no bound
    if (second < far) far = second;
  }
};

// The ray as vectors: eight boxes at once.
struct Slabs {
  simd::Floats ox, oy, oz, ix, iy, iz, stretch, zero;
  STRAY_INLINE explicit Slabs(Probe const& probe) {
    simd::fill(ox, probe.origin[0]);
    simd::fill(oy, probe.origin[1]);
    simd::fill(oz, probe.origin[2]);
    simd::fill(ix, probe.inverse[0]);
    simd::fill(iy, probe.inverse[1]);
    simd::fill(iz, probe.inverse[2]);
    simd::fill(stretch, 1 + 6 * 0x1p-23f);
    simd::fill(zero, 0);
  }
  // Bit i: the ray enters box i before `end`, at `near`.
  STRAY_INLINE unsigned entered(Bvh8::Node const& node, int const (&near_row)[3], float end, simd::Floats& near) const {
    auto const row = [&](int k) STRAY_INLINE_LAMBDA -> simd::Floats const& { return simd::loaded(node.bound[k]); };
    simd::Floats far;
    simd::fill(far, end);
    near = zero;
    simd::raise(near, (row(near_row[0]) - ox) * ix);
    simd::raise(near, (row(near_row[1]) - oy) * iy);
    simd::raise(near, (row(near_row[2]) - oz) * iz);
    simd::lower(far, (row(3 - near_row[0]) - ox) * ix);
    simd::lower(far, (row(5 - near_row[1]) - oy) * iy);
    simd::lower(far, (row(7 - near_row[2]) - oz) * iz);
    return simd::at_most(near, far * stretch);
  }
};

// One ray on its way through one tree. A step visits one node or one leaf, so that several rays can take turns while
// each waits for memory.
struct Walk {
  float end;           // m from the start of the probe, rounded up
  std::uint64_t last;  // nodes entered later than this are skipped
  std::uint32_t next = 0;
  int top = 0;
  std::uint64_t stack[Bvh8::stack_size];  // length to where the ray enters (bits of a float not below 0), child

  STRAY_INLINE void begin(double limit) {
    next = 0;
    top = 0;
    shorten(limit);
  }
  STRAY_INLINE void shorten(double limit) {  // from the start of the probe
    end = rounded_up(limit);
    last = std::uint64_t(simd::float_bits(end * (1 + 6 * 0x1p-23f))) << 32 | 0xffffffffu;
  }
  STRAY_INLINE bool at_leaf() const { return (next & Bvh8::leaf_mark) != 0; }
  STRAY_INLINE std::uint32_t leaf_first() const { return next & ((1u << Bvh8::first_bits) - 1); }
  STRAY_INLINE std::uint32_t leaf_count() const { return (next >> Bvh8::first_bits & 15u) + 1; }
  // Returns to the next stacked node; false: the stack is empty.
  STRAY_INLINE bool back() {
    do {
      if (top == 0) return false;
      --top;
    } while (stack[top] > last);
    next = std::uint32_t(stack[top]);
    return true;
  }
  // Moves to the nearest child entered and stacks the others; false: none is entered. Calls see(child) for each.
  template <class See>
  STRAY_INLINE bool down(Bvh8::Node const& node, Slabs const& slabs, int const (&near_row)[3], See const& see) {
    simd::Floats near;
    unsigned hits = slabs.entered(node, near_row, end, near);
    if (hits == 0) return false;
    int const i = simd::lowest(hits);
    hits &= hits - 1;
    next = node.child[i];
    see(next);
    if (hits == 0) return true;
    alignas(32) std::uint32_t entry[simd::lanes];
    simd::store_bits(entry, near);
    auto const key = [&](int k) STRAY_INLINE_LAMBDA { return std::uint64_t(entry[k]) << 32 | node.child[k]; };
    std::uint64_t nearest = key(i);
    do {
      std::uint64_t const other = key(simd::lowest(hits));
      see(std::uint32_t(other));
      hits &= hits - 1;
      stack[top++] = other > nearest ? other : nearest;
      nearest = other > nearest ? nearest : other;
    } while (hits != 0);
    next = std::uint32_t(nearest);
    return true;
  }
};

}  // namespace bvh8_detail

template <class Leaf, class Ahead>
STRAY_INLINE void Bvh8::View::traverse(Ray const& ray, double& limit, Leaf&& leaf, Ahead const& ahead) const {
  bvh8_detail::Probe probe;
  if (nodes.size != 0 && probe.set(*this, ray, limit)) traverse_from(probe, limit, leaf, ahead);
}

template <class Leaf, class Ahead>
STRAY_INLINE void Bvh8::View::traverse_from(bvh8_detail::Probe const& probe, double& limit, Leaf&& leaf,
                                            Ahead const& ahead) const {
  auto const look_ahead = [&]([[maybe_unused]] std::uint32_t child) STRAY_INLINE_LAMBDA {
    if constexpr (!std::is_same_v<Ahead, NothingAhead>) {
      if (child & leaf_mark)
        ahead(child & ((1u << first_bits) - 1));
      else
        bvh8_detail::fetch_early<sizeof(Node)>(nodes.data + child);
    }
  };
  bvh8_detail::Slabs const slabs(probe);
  bvh8_detail::Walk walk;
  walk.begin(limit - probe.shift);
  do {
    while (!walk.at_leaf() && walk.down(nodes[walk.next], slabs, probe.near_row, look_ahead)) {
    }
    if (!walk.at_leaf()) continue;
    double const before = limit;
    if (leaf(walk.leaf_first(), walk.leaf_count(), limit)) return;
    if (limit < before) walk.shorten(limit - probe.shift);
  } while (walk.back());
}

}  // namespace straytrace::geometry
