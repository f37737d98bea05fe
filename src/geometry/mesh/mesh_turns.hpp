// SPDX-License-Identifier: BSD-3-Clause
// Rays in large meshes that take turns: a mesh does not fit into the cache, and while one ray waits for a node or a
// pack of triangles, the others go on. Every ray does the operations of TriangleMesh::crossing, so the bits are the
// same.
#pragma once

#include <optional>

#include "geometry/mesh/triangle_mesh.hpp"

namespace straytrace {

template <int Width>
class MeshTurn {
 public:
  // False: the ray passes the mesh.
  STRAY_INLINE bool begin(TriangleMesh const& mesh, Ray const& ray, std::uint32_t leaving) {
    Ray const local = mesh.in_file(ray);
    search_.emplace(mesh, local.origin, local.dir, ray.t_max, leaving);
    Bvh8::View const& tree = mesh.content.tree;
    probe_.shift = 0;
    if (tree.nodes.size == 0 || !probe_.set(tree, local, search_->limit)) return false;
    walk_.begin(search_->limit - probe_.shift);
    return true;
  }
  // Looks at one node or one pack, and asks for what comes next; false: the ray has seen all that it may hit.
  STRAY_INLINE bool turn() {
    MeshContent const& mesh = search_->mesh->content;
    if (walk_.at_leaf()) {
      double const before = search_->limit;
      search_->template try_pack<Width>(walk_.leaf_first(), walk_.leaf_count());
      if (search_->limit < before) walk_.shorten(search_->limit - probe_.shift);
      if (!walk_.back()) return false;
    } else {
      bvh8_detail::Slabs const slabs(probe_);
      bool const down = walk_.down(mesh.tree.nodes[walk_.next], slabs, probe_.near_row, [](std::uint32_t) {});
      if (!down && !walk_.back()) return false;
    }
    if (walk_.at_leaf())
      bvh8_detail::fetch_early<sizeof(TrianglePack)>(&mesh.packs[walk_.leaf_first()]);
    else
      bvh8_detail::fetch_early<sizeof(Bvh8::Node)>(mesh.tree.nodes.data + walk_.next);
    return true;
  }
  STRAY_INLINE Crossing result() const { return search_->result(); }

 private:
  std::optional<TriangleMesh::Search> search_;
  bvh8_detail::Probe probe_;
  bvh8_detail::Walk walk_;
};

}  // namespace straytrace
