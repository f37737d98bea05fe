// SPDX-License-Identifier: BSD-3-Clause
// Strips of meshes: drawn in the order of the tree, triangles occur in proportion to their area, points have their
// strip, and neighbours on the list are neighbours in space.
#include <gtest/gtest.h>

#include "geometry/shape_types.hpp"
#include "support/chi_square.hpp"
#include "support/mesh_shapes.hpp"
#include "support/statistics.hpp"

namespace straytrace::testing {
namespace {

TEST(mesh_strips, draw_triangles_by_area_and_know_their_coordinate) {
  TriangleMesh const mesh = mesh_of(bumpy(8, 0.3), Pose{}, 1e-3);
  std::size_t const triangles = mesh.content.triangles.size;
  std::vector<double> counts(triangles), expected(triangles);
  Rng rng(1, 0, 0, Stream::source);
  int const samples = 200000;
  for (int i = 0; i < samples; ++i) {
    double const u = rng.uniform(), v = rng.uniform();
    SurfacePoint const at = sample_in_strip(mesh, u, v);
    ++counts[at.piece];
    double const middle = strip_coordinate(mesh, at.point, at.piece);
    std::size_t const place = mesh.content.place[at.piece];
    double const width = (mesh.content.area_before[place + 1] - mesh.content.area_before[place]) / mesh.content.area;
    ASSERT_LE(std::fabs(u - middle), 0.5 * width * (1 + 1e-9));
  }
  for (std::size_t t = 0; t < triangles; ++t) {
    auto const id = std::uint32_t(t);
    Vec3 const a = mesh.corner(id, 0), normal = cross(mesh.corner(id, 1) - a, mesh.corner(id, 2) - a);
    expected[t] = samples * 0.5 * length(normal) / mesh.content.area;
  }
  EXPECT_TRUE(passes(chi_square(counts, expected, 100), 1));
  std::vector<double> const even(triangles, double(samples) / double(triangles));
  EXPECT_FALSE(passes(chi_square(counts, even, 100), 1)) << "control: every triangle alike";
}

// A point of the middle of each triangle: its mean place is its centroid.
TEST(mesh_strips, points_are_even_over_a_triangle) {
  TriangleMesh const mesh = mesh_of(cube(), Pose{});
  double const low = mesh.content.area_before[0] / mesh.content.area,
               high = mesh.content.area_before[1] / mesh.content.area;
  std::uint32_t const id = mesh.content.in_order[0];
  Vec3 const centroid = (1.0 / 3) * (mesh.corner(id, 0) + mesh.corner(id, 1) + mesh.corner(id, 2));
  Rng rng(2, 0, 0, Stream::source);
  Sampler away[3];
  for (int i = 0; i < 100000; ++i) {
    SurfacePoint const at = mesh.sample_in_order(low + rng.uniform() * (high - low), rng.uniform());
    ASSERT_EQ(at.piece, id);
    Vec3 const d = at.point - centroid;
    away[0].add(d.x);
    away[1].add(d.y);
    away[2].add(d.z);
  }
  for (Sampler const& s : away) {
    SampleMean const m = s.mean();
    EXPECT_LE(std::fabs(m.mean), 5 * m.std_error + 1e-12);
  }
}

TEST(mesh_strips, neighbours_on_the_list_are_neighbours_in_space) {
  TriangleMesh const mesh = mesh_of(bumpy(40, 0.1), Pose{});
  constexpr int strips = 64;
  auto const diagonal = [&](auto const& piece_at) {  // mean over strips of the box of their triangles
    double sum = 0;
    std::size_t const n = mesh.content.triangles.size;
    for (std::size_t s = 0; s < strips; ++s) {
      Box box;
      for (std::size_t i = s * n / strips; i < (s + 1) * n / strips; ++i) box.add(mesh.corner(piece_at(i), 0));
      sum += length(box.upper - box.lower);
    }
    return sum / strips;
  };
  EXPECT_LT(diagonal([&](std::size_t i) { return mesh.content.in_order[i]; }), 1.2);  // of a ball of 3.5
  EXPECT_GT(diagonal([&](std::size_t i) { return std::uint32_t(i * 2654435761u % mesh.content.triangles.size); }), 2)
      << "control: any order";
}

}  // namespace
}  // namespace straytrace::testing
