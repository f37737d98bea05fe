// SPDX-License-Identifier: BSD-3-Clause
// The eight-wide tree loses no hit: points 1 to 100 nm inside the edges of their own box, points on its faces, rays
// that run in a face (docs/develop/performance.md). Controls without the growth of boxes lose hits.
#include "geometry/mesh/bvh8.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "base/every_module.hpp"
#include "base/math/functions.hpp"
#include "base/math/rng.hpp"

namespace straytrace::geometry_bvh8 {
namespace {

// A hall of 100 m with small boxes, or a tube of 3 km cut into rings; both away from the origin of the world.
struct Scene {
  std::vector<Box> boxes;
  Vec3 low, high;
};

Scene hall() {
  Scene s{{}, {950, -250, 30}, {1050, -150, 90}};
  for (std::uint64_t i = 0; i < 4000; ++i) {
    Rng rng(1, i, 0, Stream::source);
    auto const within = [&](double a, double b) { return a + (b - a) * rng.uniform(); };
    Vec3 const at{within(s.low.x, s.high.x), within(s.low.y, s.high.y), within(s.low.z, s.high.z)};
    Vec3 const size{within(0.001, 0.5), within(0.001, 0.5), within(0.001, 0.5)};
    s.boxes.push_back({at, at + size});
  }
  return s;
}

Scene tube() {
  Scene s{{}, {-0.5, -0.5, 0}, {0.5, 0.5, 3000}};
  for (int i = 0; i < 1000; ++i) s.boxes.push_back({{-0.5, -0.5, 3.0 * i}, {0.5, 0.5, 3.0 * i + 0.01}});
  return s;
}

enum class Aim { inside_edge, on_face, along_face };

struct Shot {
  Ray ray;
  std::uint32_t item;
  double distance;
};

Shot shot(Scene const& s, Aim aim, std::uint64_t i) {
  Rng rng(2, i, 0, Stream::direction);
  auto const item = std::uint32_t(rng.uniform() * double(s.boxes.size()));
  Box const& b = s.boxes[item];
  double const low[3] = {b.lower.x, b.lower.y, b.lower.z}, high[3] = {b.upper.x, b.upper.y, b.upper.z};
  int const free = int(3 * rng.uniform());
  double p[3];
  for (int k = 0; k < 3; ++k) {
    double const inside = aim == Aim::inside_edge ? 1e-9 * std::pow(100, rng.uniform()) : 0;
    p[k] = k == free             ? low[k] + rng.uniform() * (high[k] - low[k])
           : rng.uniform() < 0.5 ? low[k] + inside
                                 : high[k] - inside;
  }
  Vec3 const at{p[0], p[1], p[2]};
  Vec3 const size = s.high - s.low;
  Vec3 from = s.low + Vec3{rng.uniform() * size.x, rng.uniform() * size.y, rng.uniform() * size.z};
  if (i % 8 == 0) from = from + 5e3 * Vec3{rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5};
  if (aim == Aim::along_face) {
    double const back = rng.uniform() < 0.5 ? 3 : -3;
    from = at + Vec3{free == 0 ? back : 0, free == 1 ? back : 0, free == 2 ? back : 0};
  }
  double const distance = length(at - from);
  return {{from, unit(at - from)}, item, distance};
}

struct Lost {
  int any = 0;
  std::uint64_t leaves = 0;
};
Lost lost_hits(Scene const& s, Aim aim, int shots, double growth, unsigned leaf_size = 4) {
  Bvh8 const tree = build_bvh8(s.boxes, {leaf_size, 1, 1, growth});
  Lost lost;
  for (int i = 0; i < shots; ++i) {
    Shot const one = shot(s, aim, std::uint64_t(i));
    double limit = i % 2 ? std::nextafter(one.distance, infinity) : infinity;
    bool found = false;
    tree.view().traverse(one.ray, limit, [&](std::uint32_t first, std::uint32_t count, double&) {
      ++lost.leaves;
      for (std::uint32_t k = first; k < first + count; ++k) found = found || tree.order[k] == one.item;
      return found;
    });
    lost.any += !found;
  }
  return lost;
}

constexpr double full_growth = 0x1p-23;

TEST(bvh8, loses_no_hit_near_the_edge_of_its_box) {
  for (Aim aim : {Aim::inside_edge, Aim::on_face, Aim::along_face})
    for (Scene const& s : {hall(), tube()}) EXPECT_EQ(lost_hits(s, aim, 200000, full_growth).any, 0);
}

// Negative control: boxes rounded outward alone.
TEST(bvh8, control_without_growth_is_rejected) {
  EXPECT_GT(lost_hits(hall(), Aim::inside_edge, 40000, 0, 1).any, 20);
  EXPECT_GT(lost_hits(hall(), Aim::on_face, 40000, 0, 1).any, 20);
  EXPECT_GT(lost_hits(tube(), Aim::inside_edge, 40000, 0, 1).any, 5);
}

// Few nodes are visited, so the growth does not amount to a search of everything.
TEST(bvh8, visits_few_leaves) {
  Lost const l = lost_hits(hall(), Aim::inside_edge, 10000, full_growth);
  EXPECT_LT(double(l.leaves) / 10000, 25);
}

// The nearest of all boxes entered, found with a falling limit, equals the one of a loop over all boxes.
TEST(bvh8, nearest_entry_as_by_brute_force) {
  Scene const s = hall();
  Bvh8 const tree = build_bvh8(s.boxes);
  auto const entry = [&](Ray const& r, std::uint32_t i) {
    Box const& b = s.boxes[i];
    double near = 0, far = infinity;
    double const o[3] = {r.origin.x, r.origin.y, r.origin.z}, d[3] = {r.dir.x, r.dir.y, r.dir.z};
    double const low[3] = {b.lower.x, b.lower.y, b.lower.z}, high[3] = {b.upper.x, b.upper.y, b.upper.z};
    for (int k = 0; k < 3; ++k) {
      double const x = (low[k] - o[k]) / d[k], y = (high[k] - o[k]) / d[k];
      near = std::max(near, std::min(x, y));
      far = std::min(far, std::max(x, y));
    }
    return near <= far ? near : infinity;
  };
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    Ray const ray = shot(s, Aim::inside_edge, std::uint64_t(i)).ray;
    double best = infinity, brute = infinity;
    for (std::uint32_t k = 0; k < s.boxes.size(); ++k) brute = std::min(brute, entry(ray, k));
    tree.view().traverse(ray, best, [&](std::uint32_t first, std::uint32_t count, double& limit) {
      for (std::uint32_t k = first; k < first + count; ++k) limit = std::min(limit, entry(ray, tree.order[k]));
      return false;
    });
    hits += brute < infinity;
    EXPECT_EQ(best, brute);
  }
  EXPECT_GT(hits, 2900);
}

TEST(bvh8, empty_single_and_degenerate) {
  double limit = infinity;
  int calls = 0;
  auto const count = [&](std::uint32_t, std::uint32_t n, double&) { return calls += int(n), false; };
  build_bvh8({}).view().traverse({{0, 0, 0}, {0, 0, 1}}, limit, count);
  EXPECT_EQ(calls, 0);
  std::vector<Box> const one{{{-1, -1, 5}, {1, 1, 5}}};  // flat
  build_bvh8(one).view().traverse({{0, 0, 0}, {0, 0, 1}}, limit, count);
  EXPECT_EQ(calls, 1);
  build_bvh8(one).view().traverse({{0, 0, 0}, {0, 0, -1}}, limit, count);
  EXPECT_EQ(calls, 1);
  std::vector<Box> const same(1000, one[0]);  // nothing to split by
  calls = 0;
  build_bvh8(same).view().traverse({{0, 0, 0}, {0, 0, 1}}, limit, count);
  EXPECT_EQ(calls, 1000);
}

// Boxes whose sizes fall by a factor each: the heuristic cuts off one after the other; the tree stays flat enough.
TEST(bvh8, depth_is_bounded) {
  std::vector<Box> boxes;
  double at = 1;
  for (int i = 0; i < 3000; ++i, at *= 1.2) boxes.push_back({{at, 0, 0}, {1.1 * at, 1e-3 * at, 1e-3 * at}});
  Bvh8 const tree = build_bvh8(boxes, {1});
  std::vector<std::pair<std::uint32_t, int>> open{{0, 1}};
  int depth = 0;
  while (!open.empty()) {
    auto const [node, level] = open.back();
    open.pop_back();
    depth = std::max(depth, level);
    for (int i = 0; i < 8; ++i)
      if (std::uint32_t const c = tree.nodes[node].child[i]; tree.nodes[node].bound[0][i] < infinity)
        if (!(c & Bvh8::leaf_mark)) open.push_back({c, level + 1});
  }
  EXPECT_LE(depth, Bvh8::depth_limit);
}

}  // namespace
}  // namespace straytrace::geometry_bvh8
