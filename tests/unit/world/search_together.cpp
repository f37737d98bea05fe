// SPDX-License-Identifier: BSD-3-Clause
// Rays searched together hit what each hits alone, bit by bit, in every instruction set (docs/develop/performance.md).
#include <gtest/gtest.h>

#include "support/mesh_shapes.hpp"
#include "support/shapes.hpp"
#include "world/model/world.hpp"

namespace straytrace::world_search_together {
namespace {

// A sphere around meshes that overlap, and a sphere and a plate among them. `meshes`: in a row, from one file.
World bodies(int meshes) {
  World w;
  w.add_optic({});
  testing::Soup const soup = testing::bumpy(12, 0.1);
  w.add_surface(testing::sphere(20), 0, 0, {}, {});
  TriangleMesh const first = testing::mesh_of(soup, {}, 0.8);
  for (int k = 0; k < meshes; ++k) {
    TriangleMesh m = first;
    m.place(facing_along({1.2 * k - 0.6 * meshes, 0.1 * k, 0}, unit({0.1 * k, 1, 0.5})));
    w.add_surface(m, 0, 0, {}, {});
  }
  w.add_surface(testing::sphere(0.7, {{0.3, 0.6, 0.4}}), 0, 0, {}, {});
  w.add_surface(testing::disk(0, 2, {{0, -0.4, 0}, unit({0.1, 1, 0})}), 0, 0, {}, {});
  w.finish();
  return w;
}

// Rays of a walk: from inside, from where others hit, some that end early.
std::vector<RayQuery> rays_in(WorldView const& v, std::uint32_t count) {
  std::vector<RayQuery> rays;
  RayQuery query{{{0, 0, 5}, {0, 0, -1}}, {}};
  for (std::uint32_t i = 0; i < count; ++i) {
    Rng rng(9, i, 0, Stream::source);
    rays.push_back(query);
    Hit const hit = v.closest(query.ray, query.from);
    double const c = 2 * rng.uniform() - 1, s = std::sqrt(1 - c * c);
    SinCos const turn = sincos_turn(rng.uniform());
    Vec3 const out = {s * turn.cos, s * turn.sin, c};
    if (!hit.surface.valid()) {
      query = {{{4 * rng.uniform() - 2, 3, 4}, out}, {}};
      continue;
    }
    Vec3 const p = v.project(hit.surface, query.ray.origin + hit.distance * query.ray.dir, hit.piece);
    query = {{p, out, i % 5 == 0 ? 0.9 : infinity}, {hit.surface, hit.piece}};
  }
  return rays;
}

struct Differences {
  std::uint32_t surfaces = 0, distances = 0, pieces = 0;
};
Differences compare(WorldView const& v, std::vector<RayQuery> const& rays, std::uint32_t together,
                    std::size_t shift = 0) {
  Differences d;
  std::vector<Hit> hits(together);
  for (std::size_t first = 0; first + together + shift <= rays.size(); first += together) {
    v.closest_together(&rays[first], hits.data(), together);
    for (std::uint32_t i = 0; i < together; ++i) {
      RayQuery const& q = rays[first + i + shift];
      Hit const alone = v.closest(q.ray, q.from);
      d.surfaces += alone.surface != hits[i].surface;
      d.distances += alone.distance != hits[i].distance;
      d.pieces += alone.piece != hits[i].piece;
    }
  }
  return d;
}

TEST(search_together, same_bits_as_one_by_one) {
  SearchKernels const* const chosen = search_kernels;
  for (int meshes : {0, 1, 40}) {
    World const w = bodies(meshes);
    std::vector<RayQuery> const rays = rays_in(w.view(), 6000);
    for (char const* name : {"portable", "avx2", "avx512"}) {
      search_kernels = find_search_kernels(name);
      if (search_kernels == nullptr) continue;  // this processor lacks it
      for (std::uint32_t together : {1u, 7u, 16u, 60u}) {
        Differences const d = compare(w.view(), rays, together);
        EXPECT_EQ(d.surfaces + d.distances + d.pieces, 0u) << meshes << ' ' << name << ' ' << together;
      }
    }
    search_kernels = chosen;
    EXPECT_GT(compare(w.view(), rays, 16, 1).distances, 4000u) << "a control that mixes up rays";
  }
}

// With many rays through many meshes the list of noted meshes overflows, and the rest are searched at once.
TEST(search_together, more_meshes_than_can_be_noted) {
  World const w = bodies(150);
  std::vector<RayQuery> rays;
  for (int i = 0; i < 64; ++i) rays.push_back({{{-100, 0.01 * i, 0.001 * i}, unit({1, 0.07, 0})}, {}});
  Differences const d = compare(w.view(), rays, 64);
  EXPECT_EQ(d.surfaces + d.distances + d.pieces, 0u);
}

}  // namespace
}  // namespace straytrace::world_search_together
