// SPDX-License-Identifier: BSD-3-Clause
// Meshes with normals at their corners (docs/reference/shapes/mesh.md): a sphere of triangles focuses like the sphere,
// light stays on its side of the facets, and power is conserved.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/mesh/triangle_mesh.hpp"
#include "support/mesh_shapes.hpp"
#include "support/trace_support.hpp"

namespace straytrace::testing::smooth_mesh {
namespace {

TriangleMesh smooth(TriangleMesh mesh, double angle) {
  static Storage storage;
  mesh.content = smoothed(mesh.content, angle, storage);
  return mesh;
}

// A sphere of radius 1 about the origin, seen from inside; `rings` from pole to pole.
TriangleMesh sphere_of_triangles(int rings) { return mesh_of(bumpy(rings, 0), {}); }

// Where light along z through (x, y) returns from the lower pole of the surface to the plane z = -1/2.
template <class Shape>
Vec3 focused(Shape const& shape, double x, double y) {
  World world;
  std::uint32_t const silver = mirror_optic(world, 1);
  SurfaceId const id =
      world.add_surface(shape, silver, silver, world.add_body("mirror", {}), world.add_group("mirror"));
  world.finish();
  WorldView const view = world.view();
  Ray const ray{{x, y, 0}, {0, 0, -1}};
  Hit const hit = view.closest(ray, {});
  Vertex const v = make_vertex(view, id, ray.origin + hit.distance * ray.dir, ray.dir, hit.piece);
  Vec3 const out = specular_way(view, ray.dir, v, false, 0).out;
  return v.point + ((-0.5 - v.point.z) / out.z) * out;
}

struct Blur {
  double smooth = 0, flat = 0;
};
// Largest distance from the light of the exact sphere, within 0.2 of the axis.
Blur blur(int rings) {
  TriangleMesh const flat = sphere_of_triangles(rings), round = smooth(flat, 0.6);
  Sphere exact;
  exact.radius = 1;
  exact.place({});
  Blur worst;
  for (int i = 1; i < 40; ++i) {
    double const x = 0.2 * std::cos(i) * i / 40, y = 0.2 * std::sin(i) * i / 40;
    Vec3 const wanted = focused(exact, x, y);
    worst.smooth = std::fmax(worst.smooth, length(focused(round, x, y) - wanted));
    worst.flat = std::fmax(worst.flat, length(focused(flat, x, y) - wanted));
  }
  return worst;
}

// The facets lie up to h^2/(8 R) behind the sphere (h: their longest edge), which moves the light by less than that;
// between corners normals are right to h^2. Control: flat facets miss by h/2.
TEST(SmoothMesh, sphere_focuses_like_the_sphere) {
  for (int const rings : {40, 80}) {
    double const h = 2 * pi / (2 * rings) * std::sqrt(2.0), sagitta = h * h / 8;
    Blur const found = blur(rings);
    RecordProperty("smooth_" + std::to_string(rings), std::to_string(found.smooth));
    RecordProperty("flat_" + std::to_string(rings), std::to_string(found.flat));
    EXPECT_LT(found.smooth, 1.5 * sagitta) << "flat: " << found.flat;
    EXPECT_GT(found.flat, 10 * sagitta);
    EXPECT_GT(found.flat, 20 * found.smooth);
  }
}

// The threshold keeps edges: a cube at 30 deg has the normals of its facets, at 90 deg it has not.
TEST(SmoothMesh, edges_sharper_than_the_angle_stay) {
  TriangleMesh const cube = mesh_of(cells(0, 0, [](int i, int j, int k) { return i == 0 && j == 0 && k == 0; }), {});
  double sharp = 1, round = 1;
  for (std::uint32_t t = 0; t < cube.content.triangles.size; ++t) {
    Vec3 const near = 0.98 * cube.corner(t, 0) + 0.01 * cube.corner(t, 1) + 0.01 * cube.corner(t, 2);
    sharp = std::fmin(sharp, dot(smooth(cube, pi / 6).smooth_normal(near, t), cube.normal(near, t)));
    round = std::fmin(round, dot(smooth(cube, pi / 2 + 1e-9).smooth_normal(near, t), cube.normal(near, t)));
  }
  EXPECT_NEAR(sharp, 1, 1e-7);
  EXPECT_LT(round, 0.8);
}

// Reflected light leaves the side of the facet it has met, at any incidence. Control: the normal without the turn.
TEST(SmoothMesh, reflection_stays_on_its_side) {
  Rng rng(5, 0, 0, Stream::source);
  int turned = 0;
  for (int i = 0; i < 20000; ++i) {
    Vec3 const facet{0, 0, 1};
    double const tilt = 0.6 * rng.uniform(), azimuth = 2 * pi * rng.uniform();
    Vec3 const normal{std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)};
    double const c = rng.uniform(), s = std::sqrt(1 - c * c), b = 2 * pi * rng.uniform();
    Vec3 const travel{s * std::cos(b), s * std::sin(b), -c};
    Vec3 const n = shading_normal(normal, facet, travel), out = reflected(travel, n);
    EXPECT_GT(dot(out, facet), 0.9 * grazing_facet);
    EXPECT_LT(dot(travel, n), 0);
    turned += dot(reflected(travel, normal), facet) <= 0 || dot(travel, normal) >= 0;
  }
  EXPECT_GT(turned, 1000);  // control
}

// A white convex body of triangles in the open, lit by a wide beam: what is neither scattered away nor hits it again is
// light sent into the own facet, below delta^2/4 of a Lambertian for normals delta off the facet. All power is booked.
TEST(SmoothMesh, power_is_conserved) {
  auto const run = [](bool round) {
    World world;
    std::uint32_t const white = lambertian_optic(world, 1);
    TriangleMesh const flat = sphere_of_triangles(12);
    world.add_surface(round ? smooth(flat, 0.6) : flat, white, black_optic(world), world.add_body("ball", {}),
                      world.add_group("ball"));
    world.add_footprint(free_beam(world.add_group("beam"), {0, 0, 3}, {0, 0, -1}, Profile::even, 0.9));
    world.limits.roulette_below = 0;
    world.finish();
    struct Books : Silent {
      double escaped = 0, absorbed = 0, all = 0;
      void book(BalanceTerm term, double power) {
        all += power;
        if (term == BalanceTerm::escaped) escaped += power;
        if (term == BalanceTerm::absorbed) absorbed += power;
      }
    } books;
    constexpr double histories = 20000;
    walk(world, std::uint64_t(histories), books, [] {});
    EXPECT_NEAR(books.all, histories, 1e-6);
    return books.absorbed / histories;
  };
  double const delta = pi / 12 * std::sqrt(2.0) / 2;  // half the longest edge
  EXPECT_EQ(run(false), 0);
  double const absorbed = run(true);
  EXPECT_GT(absorbed, 0);
  EXPECT_LT(absorbed, delta * delta / 4);
}

// A normal of the file that points behind its triangle is turned, one of length zero becomes that of the facet.
TEST(SmoothMesh, stated_normals_are_turned_to_their_side) {
  Soup plate;
  plate.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  plate.triangles = {{{0, 1, 2}}};
  static Storage storage;
  TriangleMesh mesh = mesh_of(plate, {});
  mesh.content = smoothed(mesh.content, {{0, 0, -2}, {0.6f, 0, 0.8f}, {0, 0, 0}}, storage);
  EXPECT_NEAR(dot(mesh.smooth_normal({1e-9, 1e-9, 0}, 0), Vec3{0, 0, 1}), 1, 1e-7);
  EXPECT_NEAR(dot(mesh.smooth_normal({1, 0, 0}, 0), Vec3{0.6, 0, 0.8}), 1, 1e-7);
  EXPECT_NEAR(dot(mesh.smooth_normal({0, 1, 0}, 0), Vec3{0, 0, 1}), 1, 1e-7);
}

}  // namespace
}  // namespace straytrace::testing::smooth_mesh
