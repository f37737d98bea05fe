// SPDX-License-Identifier: BSD-3-Clause
// What a ray may hit: tubes (tube.hpp) for long coaxial things, eight-wide trees (geometry/bvh8.hpp) for all else.
// Trees are local: each holds things of one size class from one neighbourhood, so that float boxes stay tight; a tree
// over the trees is searched in order of distance. The structure only proposes surfaces; who hits is decided by their
// shapes, in double, so it cannot change a result.
#pragma once

#include <vector>

#include "geometry/bvh8.hpp"
#include "world/tube.hpp"

namespace straytrace {

// What the structure is told about a surface: a box, and heights along its axis and distances from it that contain it.
struct SearchItem {
  SurfaceRef ref;
  Box box;
  Vec3 reference, axis{0, 0, 1};  // heights are measured from the reference point
  double low = 0, high = 0, r_min = 0, r_max = 0;
  std::uint32_t plain_kind = 0;  // see TubePart
  TubePlain plain = {};
};

// One local tree: a slice of the flat arrays.
struct ClusterRecord {
  Vec3 origin;
  double largest = 0;
  Box root;
  std::uint32_t first_node = 0, nodes = 0, first_item = 0;
};

struct SearchView {
  TubeArrays tubes;
  View<ClusterRecord const> clusters;  // the last one, when there are several, is the tree over the others
  View<Bvh8::Node const> nodes;
  View<SurfaceRef const> items;  // in the order of the leaves; for the tree over trees: numbers of clusters

  // Asks query.cross(ref, limit) about every surface that may be hit before `limit` (m), and what else TubeArrays asks.
  // It may lower the limit and returns true to end the search; so do these.
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
      done = traverse_tree(clusters[items[top.first_item + first].surface], ray, limit, query);
      return done;
    });
    return done;
  }

 private:
  template <class Query>
  STRAY_INLINE bool traverse_tree(ClusterRecord const& c, Ray const& ray, double& limit, Query&& query) const {
    bool done = false;
    SurfaceRef const* const refs = items.data + c.first_item;
    tree_of(c).traverse(ray, limit, [&](std::uint32_t first, std::uint32_t count, double& end) STRAY_INLINE_LAMBDA {
      for (std::uint32_t i = first; i < first + count && !done; ++i) done = query.cross(refs[i], end);
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
            {items_.data(), items_.size()}};
  }
  TubeData const& tubes() const { return tubes_; }

 private:
  std::vector<SearchItem> take_tubes(std::vector<SearchItem> const& items);  // returns what is left
  void add_cluster(std::vector<Box> const& boxes, std::vector<SurfaceRef> const& names, Bvh8Settings const&);

  TubeData tubes_;
  std::vector<ClusterRecord> clusters_;
  std::vector<Bvh8::Node> nodes_;
  std::vector<SurfaceRef> items_;
};

}  // namespace straytrace
