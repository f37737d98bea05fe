// SPDX-License-Identifier: BSD-3-Clause
// Triangle meshes: no leak at shared edges, the tree finds what testing every triangle finds
// (R3.07), area, samples, bounds.
#include <gtest/gtest.h>

#include "support/chi_square.hpp"
#include "unit/geometry/mesh_control.hpp"

namespace straytrace::testing {
namespace {

// Rays from inside a closed mesh to points of its edges and to its corners, to the precision of doubles.
template <class Test>
int leaks(TriangleMesh const& mesh, int rays, Test crossing) {
  Random random(3);
  int lost = 0;
  for (int i = 0; i < rays; ++i) {
    auto const t = std::uint32_t(random.uniform() * double(mesh.content.triangles.size));
    int const k = int(3 * random.uniform());
    double const s = i % 4 == 0 ? 0 : random.uniform();
    Vec3 const a = mesh.corner(t, k), b = mesh.corner(t, (k + 1) % 3);
    Vec3 const target = mesh.pose.point(mesh.unit * (a + s * (b - a)));
    Vec3 const from = mesh.pose.point((0.2 * mesh.unit) * random.direction());
    lost += !(crossing(mesh, Ray{from, unit(target - from)}).distance < infinity);
  }
  return lost;
}

TEST(triangle_mesh, has_no_leak_at_shared_edges_and_corners) {
  auto const ours = [](TriangleMesh const& m, Ray const& r) { return m.crossing(r, no_piece); };
  auto const strict = [](TriangleMesh const& m, Ray const& r) { return strict_crossing(m, r, 0); };
  Soup const ball = bumpy(40, 0.1);
  for (Pose const& pose : poses()) EXPECT_EQ(leaks(mesh_of(ball, pose), 300000, ours), 0);
  EXPECT_EQ(leaks(mesh_of(cube(), poses()[1]), 100000, ours), 0);
  EXPECT_GT(leaks(mesh_of(bumpy(6, 0.1), Pose{}), 20000, strict), 100) << "strict u, v > 0";
}

TEST(triangle_mesh, has_no_leak_between_parts_of_one_file) {
  Soup const ball = bumpy(40, 0.1);
  std::vector<Soup> halves(2, {ball.vertices, {}});
  for (std::size_t i = 0; i < ball.triangles.size(); ++i) halves[i % 2].triangles.push_back(ball.triangles[i]);
  TriangleMesh const whole = mesh_of(ball, poses()[1]), first = mesh_of(halves[0], poses()[1]),
                     second = mesh_of(halves[1], poses()[1]);
  auto const both = [&](TriangleMesh const&, Ray const& r) {
    Crossing const a = first.crossing(r, no_piece), b = second.crossing(r, no_piece);
    return a.distance < b.distance ? a : b;
  };
  EXPECT_EQ(leaks(whole, 200000, both), 0);
}

bool equal(Crossing a, Crossing b) { return a.distance == b.distance && a.piece == b.piece; }

// R3.07. Brute force costs triangles times rays: 1e5 triangles with 100 rays of each kind, 4000 triangles with 6000.
TEST(triangle_mesh, tree_agrees_with_testing_every_triangle) {
  for (auto const& [rings, rays] : {std::pair{224, 100}, std::pair{32, 6000}}) {
    TriangleMesh const mesh = mesh_of(bumpy(rings, 0.1), poses()[2], 1e-3);
    Random random(5);
    int wrong = 0, hits = 0, coarse = 0;
    for (int i = 0; i < rays; ++i) {
      SurfacePoint const on = mesh.sample(random.uniform(), random.uniform());
      Vec3 const far = mesh.pose.point((mesh.unit * (i % 2 ? 3 : 1000)) * random.direction());
      auto const any = std::uint32_t(random.uniform() * double(mesh.content.triangles.size));
      Vec3 const corner = mesh.pose.point(mesh.unit * mesh.corner(any, 0));
      for (auto const& [ray, leaving] :
           {std::pair{Ray{on.point, random.direction()}, on.piece}, std::pair{Ray{far, unit(on.point - far)}, no_piece},
            std::pair{Ray{far, unit(corner - far)}, no_piece}}) {
        Crossing const found = mesh.crossing(ray, leaving), wanted = crossing_by_force(mesh, ray, leaving);
        wrong += !equal(found, wanted);
        coarse += found.distance != double(float(found.distance));
        hits += found.distance < infinity;
      }
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(hits, rays);
    EXPECT_GT(coarse, rays / 2) << "distances are not rounded to float";
  }
}

// R3.07 for 1e6 random rays and 1e5 triangles: the same triangles, shuffled and put into two other trees. The control
// lacks one triangle in a thousand.
TEST(triangle_mesh, a_million_rays_agree_between_trees) {
  Soup const ball = bumpy(224, 0.1);
  ASSERT_GT(ball.triangles.size(), 99000u);
  std::vector<Soup> parts(3, {ball.vertices, {}});  // the third: the first with gaps
  Random random(12);
  std::vector<MeshTriangle> shuffled = ball.triangles;
  for (std::size_t i = shuffled.size(); i-- > 1;)
    std::swap(shuffled[i], shuffled[std::size_t(random.uniform() * double(i + 1))]);
  for (std::size_t i = 0; i < shuffled.size(); ++i) {
    parts[i % 2].triangles.push_back(shuffled[i]);
    if (i % 2 == 0 && i % 1000 != 0) parts[2].triangles.push_back(shuffled[i]);
  }
  Pose const pose = poses()[2];
  TriangleMesh const whole = mesh_of(ball, pose, 1e-3), first = mesh_of(parts[0], pose, 1e-3),
                     second = mesh_of(parts[1], pose, 1e-3), gaps = mesh_of(parts[2], pose, 1e-3);
  auto const matches = [](TriangleMesh const& a, Crossing x, TriangleMesh const& b, Crossing y) {
    if (x.distance != y.distance) return false;
    if (!(x.distance < infinity)) return true;
    for (int k = 0; k < 3; ++k)
      if (length(a.corner(x.piece, k) - b.corner(y.piece, k)) != 0) return false;
    return true;
  };
  int wrong = 0, seen = 0, hits = 0;
  for (int i = 0; i < 1000000; ++i) {
    Ray const ray{pose.point((1e-3 * (i % 2 ? 1.5 : 0.5)) * random.direction()), random.direction()};
    Crossing const x = whole.crossing(ray, no_piece), y = first.crossing(ray, no_piece),
                   z = second.crossing(ray, no_piece);
    bool const in_first = y.distance < z.distance;
    wrong += !matches(whole, x, in_first ? first : second, in_first ? y : z);
    hits += x.distance < infinity;
    if (i < 20000) {
      Crossing const w = gaps.crossing(ray, no_piece);
      seen += !matches(whole, x, w.distance < z.distance ? gaps : second, w.distance < z.distance ? w : z);
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(hits, 500000);
  EXPECT_GT(seen, 5);
}

// A nearest hit that forgets the tie rule or the start does not pass the comparison.
TEST(triangle_mesh, comparison_finds_a_missing_start) {
  TriangleMesh const mesh = mesh_of(bumpy(32, 0.1), poses()[0]);
  Random random(6);
  int wrong = 0;
  for (int i = 0; i < 2000; ++i) {
    SurfacePoint const on = mesh.sample(random.uniform(), random.uniform());
    Ray const ray{on.point, random.direction()};
    wrong += !equal(mesh.crossing(ray, no_piece), crossing_by_force(mesh, ray, on.piece));
  }
  EXPECT_GT(wrong, 100);
}

TEST(triangle_mesh, area_and_samples_follow_the_triangles) {
  TriangleMesh const mesh = mesh_of(cube(), poses()[1], 0.5);
  EXPECT_NEAR(mesh.area(), 6 * 0.25, 1e-12);  // R3.34, unit 0.5 m
  TriangleMesh const ball = mesh_of(bumpy(6, 0.3), Pose{});
  std::vector<double> expected, observed(ball.content.triangles.size), lopsided = observed;
  constexpr int n = 200000;
  for (std::uint32_t i = 0; i < observed.size(); ++i)
    expected.push_back(n * 0.5 * length(facet_normal(ball.corner(i, 0), ball.corner(i, 1), ball.corner(i, 2))) /
                       ball.area());
  Random random(10);
  Vec3 mean, centre;
  for (int i = 0; i < n; ++i) {
    double const u = random.uniform(), v = random.uniform();
    SurfacePoint const s = ball.sample(u, v);
    ++observed[s.piece];
    ++lopsided[ball.sample(u * u, v).piece];
    mean = mean + (1.0 / n) * s.point;
  }
  for (std::uint32_t i = 0; i < observed.size(); ++i)
    centre = centre + (expected[i] / (3.0 * n)) * (ball.corner(i, 0) + ball.corner(i, 1) + ball.corner(i, 2));
  EXPECT_TRUE(passes(chi_square(observed, expected, 100), 1));
  EXPECT_FALSE(passes(chi_square(lopsided, expected, 100), 1));
  EXPECT_LT(length(mean - centre), 5 * 0.6 / std::sqrt(double(n)));  // points fill their triangles evenly
}

TEST(triangle_mesh, bounds_and_extent_contain_it) {
  for (Pose const& pose : poses()) {
    TriangleMesh const mesh = mesh_of(bumpy(12, 0.2), pose, 1e-3);
    Box const box = mesh.bounds();
    auto const [low, high, r_min, r_max] = mesh.extent();
    EXPECT_EQ(r_min, 0);
    for (MeshVertex v : bumpy(12, 0.2).vertices) {
      Vec3 const p = pose.point(1e-3 * exact(v)), o = p - mesh.reference();
      double const h = dot(o, mesh.axis), r = length(o - h * mesh.axis), pad = 0x1p-50 * length(pose.origin);
      EXPECT_TRUE(h >= low - pad && h <= high + pad && r <= r_max + pad);
      EXPECT_TRUE(p.x >= box.lower.x && p.y >= box.lower.y && p.z >= box.lower.z);
      EXPECT_TRUE(p.x <= box.upper.x && p.y <= box.upper.y && p.z <= box.upper.z);
    }
  }
  Soup ring;  // a triangle off the axis: nearest at the middle of an edge
  ring.vertices = {{1, -1, 0}, {1, 1, 0}, {2, 0, 5}};
  ring.triangles = {{{0, 1, 2}}};
  double const r_min = mesh_of(ring, Pose{}).extent().r_min;
  EXPECT_NEAR(r_min, 1, 1e-9);
  EXPECT_LE(r_min, 1);
}

TEST(triangle_mesh, ends_at_t_max) {
  TriangleMesh const mesh = mesh_of(bumpy(12, 0.2), poses()[1], 1e-3);
  Random random(11);
  for (int i = 0; i < 2000; ++i) {
    Ray ray{mesh.pose.origin, random.direction()};
    double const t = mesh.crossing(ray, no_piece).distance;
    ray.t_max = t;
    EXPECT_FALSE(mesh.crossing(ray, no_piece).distance < infinity);
    ray.t_max = std::nextafter(t, infinity);
    EXPECT_EQ(mesh.crossing(ray, no_piece).distance, t);
  }
}

// R3.07: below a second; debugging and sanitized programs are not measured.
// Work and memory grow with the number of triangles, not faster: leaves are well filled.
TEST(triangle_mesh, tree_of_a_hundred_thousand_triangles_is_small) {
  Soup const ball = bumpy(224, 0.1);
  ASSERT_GT(ball.triangles.size(), 99000u);
  TriangleMesh const mesh = mesh_of(ball, Pose{});
  EXPECT_GT(mesh.area(), 1);
  EXPECT_LT(mesh.content.packs.size, ball.triangles.size() / 4);
  EXPECT_LT(mesh.content.tree.nodes.size, ball.triangles.size() / 16);
}

}  // namespace
}  // namespace straytrace::testing
