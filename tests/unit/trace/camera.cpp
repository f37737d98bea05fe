// SPDX-License-Identifier: BSD-3-Clause
// Camera pictures (R3.36): geometry of the frame, silhouettes, maps against a search of every surface.
#include "trace/camera/camera.hpp"

#include "support/trace_support.hpp"

namespace straytrace::testing::trace_camera {
namespace {

// A few of everything, piled up.
World pile() {
  World world;
  BodyId const body = world.add_body("pile", {});
  std::uint32_t const white = lambertian_optic(world, 0.5);
  for (int i = 0; i < 60; ++i) {
    Rng rng(9, i, 0, Stream::source);
    auto const any = [&] { return 2 * rng.uniform() - 1; };
    Vec3 const at{any(), any(), any()}, axis = unit({any(), any(), any() + 1e-3});
    GroupId const group = world.add_group("thing " + std::to_string(i));
    if (i % 4 == 0) world.add_surface(Sphere{at, {0, 0, 1}, 0.2}, white, white, body, group);
    if (i % 4 == 1) world.add_surface(Disk{at, axis, 0.1, 0.4}, white, white, body, group);
    if (i % 4 == 2) world.add_surface(Cylinder{at, axis, 0.1, -0.3, 0.3}, white, white, body, group);
    if (i % 4 == 3) world.add_surface(Cap{at, axis, 1.5, 0, 0.3}, white, white, body, group);
  }
  world.finish();
  return world;
}

// `up` counts only across the direction of view. Control: taken as it is, the frame is oblique.
TEST(Camera, FrameIsOrthogonal) {
  Vec3 const up{0.3, 1, 0.9};
  Camera const c = looking_at({1, 2, 3}, {-4, 1, 0}, up, 30 * degree, 800, 600);
  auto const oblique = [&](Vec3 u) {
    return std::max({std::fabs(dot(c.forward, unit(u))), std::fabs(dot(c.right, unit(u))),
                     std::fabs(dot(c.forward, c.right)), std::fabs(length(u) - 1)});
  };
  EXPECT_LT(oblique(c.up), 1e-15);
  EXPECT_GT(oblique(up), 0.1);
  EXPECT_GT(dot(c.up, up), 0);
  EXPECT_GT(dot(cross(c.right, c.up), -c.forward), 0.999);  // right-handed, looking along -e3
  EXPECT_NEAR(c.focal_length(), 300 / std::tan(15 * degree), 1e-9);
  Camera const along = looking_at({}, {0, 5, 0}, {0, 1, 0}, 30 * degree, 800, 600);  // up is of no use
  EXPECT_NEAR(length(along.up), 1, 1e-15);
  EXPECT_LT(std::fabs(dot(along.up, along.forward)), 1e-15);
}

// Silhouette of a sphere R at distance D: a circle of radius f R/sqrt(D^2 - R^2) pixels, found by bisection along rows
// and columns through the middle. Control: f R/D.
TEST(Camera, SilhouetteOfASphere) {
  constexpr double radius = 0.7, distance = 2;
  World world;
  world.add_surface(Sphere{{5, 1, 2}, {0, 0, 1}, radius}, 0, 0, world.add_body("ball", {}), world.add_group("ball"));
  world.add_optic({});
  world.finish();
  Vec3 const eye = Vec3{5, 1, 2} + distance * unit({1, 2, -0.5});
  Camera const c = looking_at(eye, {5, 1, 2}, {0, 1, 0}, 60 * degree, 640, 480);
  double const f = c.focal_length(), expected = f * radius / std::sqrt(distance * distance - radius * radius);
  for (int direction = 0; direction < 4; ++direction) {
    double const dx = direction == 0 ? 1 : direction == 1 ? -1 : 0, dy = direction == 2 ? 1 : direction == 3 ? -1 : 0;
    double low = 0, high = 240;
    for (int i = 0; i < 60; ++i) {
      double const r = 0.5 * (low + high);
      bool const hit = sight(world.view(), c.ray(320 + r * dx, 240 + r * dy), {}, {}).solid.surface.valid();
      (hit ? low : high) = r;
    }
    EXPECT_NEAR(low, expected, 1e-9);
    EXPECT_GT(std::fabs(low - f * radius / distance), 1);
  }
}

// Ids, distances and normals of every pixel equal those of a search through every surface, for all lenses. Control: one
// surface missing.
TEST(Camera, MapsEqualBruteForce) {
  World world = pile();
  WorldView const fast = world.view();
  WorldView slow = fast;
  slow.limits.brute_force = true;
  Camera flat = looking_at({0, 0, -4}, {}, {0, 1, 0}, 40 * degree, 96, 72);
  flat.lens = Camera::Lens::flat;
  flat.half_width = flat.half_height = 1.5;
  for (Camera const& c : {looking_at({3, 2, -3}, {}, {0, 1, 0}, 40 * degree, 96, 72), flat,
                          fisheye_at({}, {0, 0, 1}, {0, 1, 0}, 300 * degree, 96, 72)}) {
    auto const one = seen_by(fast, c, {}), two = seen_by(slow, c, {});
    std::size_t hits = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
      ASSERT_EQ(one[i].surface.value, two[i].surface.value);
      ASSERT_EQ(one[i].distance, two[i].distance);
      if (!one[i].surface.valid()) continue;
      ++hits;
      EXPECT_LT(dot(one[i].normal, c.ray(double(i % 96) + 0.5, double(i / 96) + 0.5).dir), 1e-12);
    }
    EXPECT_GT(hits, one.size() / 10);
    WorldView less = slow;
    --less.surfaces.size;
    std::size_t differing = 0;
    auto const three = seen_by(less, c, {});
    for (std::size_t i = 0; i < one.size(); ++i) differing += one[i].surface.value != three[i].surface.value;
    EXPECT_GT(differing, 0u);
  }
}

// A cut leaves out all points beyond its plane, and the number of threads changes nothing.
TEST(Camera, CutsAndThreads) {
  World world = pile();
  Camera const c = looking_at({3, 2, -3}, {}, {0, 1, 0}, 40 * degree, 96, 72);
  LookSettings one{{{{1, 0, 0}, 0.1}, {{0, -1, 0}, 0.5}}, {}, 1}, four = one;
  four.threads = 4;
  auto const a = seen_by(world.view(), c, one), b = seen_by(world.view(), c, four), all = seen_by(world.view(), c, {});
  std::size_t hits = 0, beyond = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].distance, b[i].distance);
    if (a[i].surface.valid()) {
      ++hits;
      EXPECT_LE(a[i].point.x, 0.1 + 1e-12);
      EXPECT_GE(a[i].point.y, -0.5 - 1e-12);
      EXPECT_NEAR(length(a[i].point - c.eye), a[i].distance, 1e-12);
    }
    beyond += all[i].surface.valid() && all[i].point.x > 0.1 + 1e-12;
  }
  EXPECT_GT(hits, 100u);
  EXPECT_GT(beyond, 100u);
  std::vector<bool> visible, again;
  auto const paint = [](Seen const& s) { return Rgb{0.01 * s.surface.value, 0.5, 0.5}; };
  EXPECT_EQ(shaded(world.view(), c, one, paint, visible), shaded(world.view(), c, four, paint, again));
  EXPECT_EQ(visible, again);
}

// Glass is looked through without refraction; the bare side of a wall is not there.
TEST(Camera, GlassAndOpenWalls) {
  World world;
  BodyId const body = world.add_body("things", {});
  GroupId const group = world.add_group("things");
  std::uint32_t const white = lambertian_optic(world, 0.5), black = black_optic(world);
  Optic bare;
  bare.has_interface = true;
  bare.interface = world.add_interface(Fresnel{});
  std::uint32_t const clear = world.add_optic(bare), glass = world.add_volume({1.5, 0});
  world.add_surface(Cylinder{{}, {0, 0, 1}, 1, -1, 1}, black, white, body, group);  // viewed from inside
  SurfaceId const lens = world.add_surface(Sphere{{0, 0, 0}, {0, 0, 1}, 0.3}, clear, clear, body, group, glass);
  SurfaceId const wall = world.add_surface(Disk{{0.5, 0, 0}, {1, 0, 0}, 0, 0.4}, black, black, body, group);
  world.finish();
  LookSettings settings{{}, looks_of(world.view()), 1};
  EXPECT_EQ(settings.looks[0], Look::open);
  EXPECT_EQ(settings.looks[1], Look::solid);
  EXPECT_EQ(settings.looks[2 * lens.value], Look::glass);
  EXPECT_EQ(settings.looks[2 * wall.value], Look::solid);
  Sight const s = sight(world.view(), {{-5, 0.01, 0.02}, {1, 0, 0}}, {}, settings);
  EXPECT_EQ(s.panes, 2);
  EXPECT_TRUE(s.solid.surface == wall);
  EXPECT_NEAR(s.solid.distance, 5.5, 1e-12);
  EXPECT_NEAR(sight(world.view(), {{-5, 0.01, 0.02}, {1, 0, 0}}, {}, {}).solid.distance, 4, 1e-3);  // all solid
}

// The automatic camera sees all corners of the box; nothing of it is cut away.
TEST(Camera, FramesTheBox) {
  for (double const aspect : {0.5, 1.0, 2.0}) {
    Box const box{{-1, 2, 3}, {2, 2.5, 5}};
    Framing const f = framing(box, 30 * degree, std::uint32_t(400 * aspect), 400);
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 const p{corner & 1 ? -1.0 : 2.0, corner & 2 ? 2 : 2.5, corner & 4 ? 3.0 : 5.0};
      Vec3 const q = p - f.camera.eye;
      double const ahead = dot(q, f.camera.forward);
      EXPECT_GT(ahead, 0);
      EXPECT_LT(std::fabs(dot(q, f.camera.right)) / ahead, f.camera.half_width);
      EXPECT_LT(std::fabs(dot(q, f.camera.up)) / ahead, f.camera.half_height);
      EXPECT_LT(dot(p, f.cuts[0].normal), f.cuts[0].offset);
    }
  }
  EXPECT_TRUE(is_long({{-1, -1, 0}, {1, 1, 100}}));
  EXPECT_FALSE(is_long({{-1, -1, 0}, {1, 1, 20}}));
  Framing const f = section({{-1, -1, 0}, {1, 1, 100}}, 800, 200);
  EXPECT_NEAR(f.camera.half_width, 52, 1e-9);
  EXPECT_NEAR(f.camera.half_height, 1.04, 1e-9);
  EXPECT_NEAR(f.camera.ray(400, 100).origin.z, 50, 1e-9);
  EXPECT_GT(f.camera.right.z, 0.99);
}

}  // namespace
}  // namespace straytrace::testing::trace_camera
