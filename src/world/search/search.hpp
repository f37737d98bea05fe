// SPDX-License-Identifier: BSD-3-Clause
// Search structure: tubes (tube.hpp) for long coaxial surfaces, eight-wide trees (geometry/mesh/bvh8.hpp) for all
// others. Trees are local: each holds surfaces of one size class from one neighbourhood, which keeps float boxes tight;
// a tree over the trees is searched in order of distance. The structure only proposes surfaces; their shapes decide
// about hits, in double, so it cannot change a result.
#pragma once

#include <vector>

#include "geometry/mesh/bvh8.hpp"
#include "world/search/surface_pack.hpp"
#include "world/search/tube.hpp"

namespace straytrace::world {

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
