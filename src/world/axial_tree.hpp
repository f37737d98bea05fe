// SPDX-License-Identifier: BSD-3-Clause
// Search structure for long scenes along z: a binary tree over heights whose nodes also know the clear aperture.
// Along a ray r^2(t) is a convex quadratic, so "inside radius a over a height interval" is decided at its two ends: a
// near-axial ray passes whole groups of baffles in one step, where a box tree would test every one of them
// (performance.md 1, 3). Likewise a ray that stays outside the largest radius. A skipped surface was certainly not hit:
// the answer equals brute force bit by bit.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "base/ids.hpp"
#include "base/vec3.hpp"

namespace straytrace {

class AxialTree {
 public:
  // What surfaces occupy: heights along z, least and largest distance of any of their points from the z axis, m.
  struct Extent {
    double low = infinity, high = -infinity, clear = infinity, reach = 0;
  };
  struct Item : Extent {
    std::uint32_t surface = 0;
  };
  struct Node : Extent {
    std::uint32_t first = 0, count = 0;  // leaf: items; inner node (count 0): left child = own index + 1, right = first
  };

  // A ray prepared for node tests.
  struct Probe {
    double z, dz, r2, b, a;  // height and its slope; r^2(t) = r2 + 2 b t + a t^2
    STRAY_HD explicit Probe(Ray const& ray)
        : z(ray.origin.z),
          dz(ray.dir.z),
          r2(ray.origin.x * ray.origin.x + ray.origin.y * ray.origin.y),
          b(ray.origin.x * ray.dir.x + ray.origin.y * ray.dir.y),
          a(ray.dir.x * ray.dir.x + ray.dir.y * ray.dir.y) {}
    STRAY_HD double radius2(double t) const { return r2 + t * (2 * b + t * a); }
    // Whether the ray can touch the extent before `limit`; entry = where it gets to its heights.
    // Rounding can only make it say yes: heights are padded, the aperture is shrunk, the reach is widened.
    STRAY_HD bool touches(Extent const& e, double limit, double& entry) const {
      double near = 0, far = limit;
      if (dz != 0) {
        double const t1 = (e.low - z) / dz, t2 = (e.high - z) / dz;
        near = t1 < t2 ? t1 : t2;
        far = t1 < t2 ? t2 : t1;
        if (near < 0) near = 0;
        if (far > limit) far = limit;
        if (!(near <= far)) return false;
      } else if (z < e.low || z > e.high) {
        return false;
      }
      entry = near;
      if (far == infinity) return true;
      double const r_near = radius2(near), r_far = radius2(far);
      double const rounding = 1e-14 * (r2 + far * (2 * std::fabs(b) + far * a));
      double const most = (r_near > r_far ? r_near : r_far) + rounding;
      if (most < e.clear * e.clear * (1 - 1e-12)) return false;
      double const turn = -b;  // the least radius is reached where b + a t = 0
      double least = r_near < r_far ? r_near : r_far;
      if (turn > a * near && turn < a * far) least = r2 - b * b / a;
      return least - rounding <= e.reach * e.reach * (1 + 1e-12);
    }
  };

  struct View {
    straytrace::View<Node const> nodes;
    straytrace::View<Item const> items;
    straytrace::View<std::uint32_t const> walls;  // long surfaces, tested first: they bound the search

    // Calls test(surface, limit) for every surface that may be hit before `limit`; test may lower the limit, and
    // returns true to end the search.
    template <class Test>
    STRAY_HD void traverse(Ray const& ray, double limit, Test&& test) const {
      for (std::size_t i = 0; i < walls.size; ++i)
        if (test(walls[i], limit)) return;
      if (nodes.size == 0) return;
      Probe const probe(ray);
      struct Entry {
        std::uint32_t node;
        double near;
      } stack[64];
      int top = 0;
      double near = 0;
      if (probe.touches(nodes[0], limit, near)) stack[top++] = {0, near};
      while (top > 0) {
        Entry const e = stack[--top];
        if (e.near > limit) continue;
        Node const& node = nodes[e.node];
        if (node.count > 0) {
          for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
            if (probe.touches(items[i], limit, near) && test(items[i].surface, limit)) return;
          continue;
        }
        std::uint32_t const up = probe.dz < 0, first = up ? node.first : e.node + 1,
                            second = up ? e.node + 1 : node.first;
        if (probe.touches(nodes[second], limit, near)) stack[top++] = {second, near};
        if (probe.touches(nodes[first], limit, near)) stack[top++] = {first, near};
      }
    }
  };

  void build(std::vector<Item> items);
  View view() const {
    return {{nodes_.data(), nodes_.size()}, {items_.data(), items_.size()}, {walls_.data(), walls_.size()}};
  }

 private:
  void split(std::size_t first, std::size_t last);

  std::vector<Node> nodes_;
  std::vector<Item> items_;
  std::vector<std::uint32_t> walls_;
};

}  // namespace straytrace
