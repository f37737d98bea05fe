// SPDX-License-Identifier: BSD-3-Clause
// Paths in closed meshes are neither lost nor hit their own start (docs/develop/performance.md; LeavingRule).
#include <gtest/gtest.h>

#include "unit/geometry/mesh_control.hpp"

namespace straytrace::testing {
namespace {

struct Bounces {
  long lost = 0, self = 0, outside = 0, done = 0;
};

// Diffuse bounces inside a closed mesh with outward normals; a path that gets lost starts again.
template <class Test>
Bounces diffuse(TriangleMesh const& mesh, long wanted, Test crossing) {
  Random random(7);
  Bounces b;
  Vec3 p = mesh.pose.origin, d = random.direction();
  std::uint32_t piece = no_piece;
  while (b.done < wanted) {
    ++b.done;
    Crossing const hit = crossing(mesh, Ray{p, d}, piece);
    Vec3 const n = hit.distance < infinity ? -mesh.normal(p, hit.piece) : Vec3{};
    bool const lost = !(hit.distance < infinity), outside = !lost && dot(n, d) > 0;
    b.lost += lost;
    b.outside += outside;  // came upon a wall from behind
    b.self += !lost && piece != no_piece && (hit.piece == piece || hit.distance < 1e-12 * mesh.unit);
    if (lost || outside) {
      p = mesh.pose.origin;
      d = random.direction();
      piece = no_piece;
      continue;
    }
    piece = hit.piece;
    p = mesh.project(p + hit.distance * d, piece);
    Vec3 const r = random.direction() + n;  // cosine law
    d = length(r) > 1e-9 ? unit(r) : n;
  }
  return b;
}

auto const with_rule = [](TriangleMesh const& m, Ray const& r, std::uint32_t from) { return m.crossing(r, from); };

TEST(triangle_mesh, closed_meshes_keep_their_paths) {
  struct Case {
    Soup soup;
    Pose pose;
    double unit;
  };
  for (Case const& c : {Case{bumpy(24, 0), poses()[0], 1}, Case{bumpy(40, 0.25), poses()[0], 1e-3},
                        Case{cube(), poses()[1], 1}, Case{cross_shaped(), poses()[0], 1},
                        Case{bumpy(24, 0.2), poses()[2], 1}, Case{cross_shaped(), poses()[2], 1e-2}}) {
    Bounces const b = diffuse(mesh_of(c.soup, c.pose, c.unit), 700000, with_rule);
    EXPECT_EQ(b.lost, 0);
    EXPECT_EQ(b.self, 0);
    EXPECT_EQ(b.outside, 0);
  }
}

TEST(triangle_mesh, controls_lose_paths_or_hit_their_start) {
  TriangleMesh const near = mesh_of(cross_shaped(), poses()[0]), away = mesh_of(cross_shaped(), poses()[2]);
  auto const naive = [](TriangleMesh const& m, Ray const& r, std::uint32_t) { return strict_crossing(m, r, 0); };
  EXPECT_GT(diffuse(away, 20000, naive).self, 100) << "a tracer that forgets where it starts";
  auto const pushed = [](TriangleMesh const& m, Ray const& r, std::uint32_t) { return strict_crossing(m, r, 1e-2); };
  Bounces const b = diffuse(near, 200000, pushed);
  EXPECT_GT(b.lost + b.outside, 100) << "a smallest distance";
}

// Starts on an edge of a concave corner and goes into the corner: the next wall is hit there, never passed.
template <class Test>
int lost_in_corners(TriangleMesh const& mesh, Test crossing) {
  Random random(8);
  int lost = 0;
  for (int i = 0; i < 100000; ++i) {
    auto const t = std::uint32_t(random.uniform() * double(mesh.content.triangles.size));
    int const k = int(3 * random.uniform());
    Vec3 const a = mesh.corner(t, k), b = mesh.corner(t, (k + 1) % 3);
    Vec3 const p = mesh.project(mesh.pose.point(mesh.unit * (a + random.uniform() * (b - a))), t);
    Vec3 const n = -mesh.normal(p, t), d = unit(random.direction() + 1.0000001 * n);
    Crossing const hit = crossing(mesh, Ray{p, d}, t);
    lost += !(hit.distance < infinity) || dot(mesh.normal(p, hit.piece), d) < 0;
  }
  return lost;
}

TEST(triangle_mesh, concave_corners_hold_paths_that_start_in_them) {
  for (Pose const& pose : poses())
    for (Soup const& soup : {cube(), cross_shaped(), bumpy(24, 0.25)})
      EXPECT_EQ(lost_in_corners(mesh_of(soup, pose), with_rule), 0);
  auto const pushed = [](TriangleMesh const& m, Ray const& r, std::uint32_t) { return strict_crossing(m, r, 1e-9); };
  EXPECT_GT(lost_in_corners(mesh_of(cross_shaped(), poses()[0]), pushed), 100);
}

// A strip of coplanar triangles and one bent away: a ray that leaves it never meets it again, however flat it leaves.
TEST(triangle_mesh, coplanar_and_convex_neighbours_are_not_hit_again) {
  Soup roof;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 2; ++j)
      roof.vertices.push_back({0.1f * float(i), 0.3f * float(j), i < 4 ? 0.f : -1e-6f * float(i - 3)});
  for (std::uint32_t i = 0; i < 5; ++i) {
    roof.triangles.push_back({{2 * i, 2 * i + 2, 2 * i + 1}});
    roof.triangles.push_back({{2 * i + 1, 2 * i + 2, 2 * i + 3}});
  }
  for (Pose const& pose : {facing_along({0.1, 3, -7}, unit({0.3, 0.4, 0.5})), poses()[2]}) {
    TriangleMesh const mesh = mesh_of(roof, pose);
    Random random(9);
    int hits = 0, naive = 0;
    for (int i = 0; i < 100000; ++i) {
      auto const t = std::uint32_t(random.uniform() * 10);
      int const k = int(3 * random.uniform());
      Vec3 const a = mesh.corner(t, k), b = mesh.corner(t, (k + 1) % 3);
      Vec3 const p = mesh.project(pose.point(a + random.uniform() * (b - a)), t), n = mesh.normal(p, t);
      double const slope = std::pow(10, -6 * random.uniform());
      Vec3 d = random.direction();
      d = unit(unit(d - dot(d, n) * n) + slope * n);
      hits += mesh.crossing({p, d}, t).distance < infinity;
      naive += strict_crossing(mesh, {p, d}, 0).distance < infinity;
    }
    EXPECT_EQ(hits, 0);
    EXPECT_GT(naive, 100) << "a tracer that forgets where it starts";
  }
}

}  // namespace
}  // namespace straytrace::testing
