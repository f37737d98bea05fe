// SPDX-License-Identifier: BSD-3-Clause
// Contract of the search structure: the same hit as brute force, bit by bit, for every ray (docs/develop/testing.md).
#include <gtest/gtest.h>

#include <vector>

#include "base/errors.hpp"
#include "base/math/rng.hpp"
#include "support/recorded.hpp"
#include "support/shapes.hpp"
#include "world/model/world.hpp"

namespace straytrace::world_search {
namespace {

using testing::cap, testing::cone, testing::cylinder, testing::disk, testing::sphere;

constexpr double tube_length = 3000, tube_radius = 0.5;

// Placement of a scene: the axis of the tube is z of this frame.
Pose placed_by(int pose) {
  if (pose == 0) return {};
  if (pose == 1) return facing_along({120, -40, 7}, unit({0.6, 0.7, 0.2}));
  return facing_along({-3000, 900, 11}, {-1, 0, 0});
}

// Tube with annuli and frusta, mirrors, and what hangs in real tubes: tilted plates, barrels across, spheres off the
// axis, pairs of surfaces in contact (ties).
void add_tube(World& w, Pose const& pose, double aperture_step) {
  auto const add = [&](auto shape) {
    Pose const own = facing_along(shape.reference(), shape.axis);
    shape.place(nested(pose, own));
    w.add_surface(shape, 0, 0, {}, {});
  };
  add(cylinder(tube_radius, 0, tube_length));
  add(disk(0, tube_radius));
  add(disk(0, tube_radius, {{0, 0, tube_length}}));
  add(cap(1 / 1420.0, 0, 0.175, {{0, 0, 1}, {0, 0, 1}}));
  add(cap(1 / 1683.0, 0, 0.175, {{0, 0, tube_length - 1}, {0, 0, -1}}));
  add(cap(0, 0.18, 0.3, {{0, 0, 1.1}, unit({0, 0.1, -1})}));
  for (int k = 0; k < 150; ++k) {
    double const z = 10 + 19.7 * k, along = k % 4 < 2 ? 1 : -1, aperture = 0.4 + aperture_step * (k * 7 % 5);
    if (k % 3 == 0) add(cone(aperture, tube_radius, 0.4 + 0.006 * k, {{0, 0, z}, {0, 0, along}}));
    if (k % 3 != 0) add(disk(aperture, tube_radius, {{0, 0, z}, {0, 0, along}}));
    if (k % 10 == 1) add(disk(aperture + 0.01, 0.45, {{0, 0, z}, {0, 0, 1}}));
    if (k % 10 == 3) add(sphere(0.05, {{0.42, -0.1, z + 5}}));
    if (k % 10 == 5) add(disk(0, 0.1, {{0.1, 0.3, z + 5}, unit({0.3, -0.5, 1})}));
    if (k % 10 == 7) add(cylinder(0.03, -0.2, 0.2, {{0.25, 0, z + 7}, unit({1, 2, 0.1})}));
    if (k % 10 == 9) add(cone(0.05, 0.1, 0.7, {{-0.3, 0.2, z + 7}, unit({1, 0, 1})}));
  }
}

// The wall in sections of different radius, steps closed by rings: a list of walls.
void add_stepped_tube(World& w, Pose const& pose) {
  auto const add = [&](auto shape) {
    Pose const own = facing_along(shape.reference(), shape.axis);
    shape.place(nested(pose, own));
    w.add_surface(shape, 0, 0, {}, {});
  };
  auto const radius = [](int k) { return 0.4 + 0.02 * (k * 5 % 7); };
  for (int k = 0; k < 30; ++k) {
    add(cylinder(radius(k), 0, 100, {{0, 0, 100.0 * k}}));
    if (k > 0) add(disk(std::min(radius(k - 1), radius(k)), 0.53, {{0, 0, 100.0 * k}}));
    for (int i = 0; i < 5; ++i) add(disk(0.3 + 0.01 * i, radius(k), {{0, 0, 100.0 * k + 10 + 15 * i}}));
  }
  add(disk(0, 0.6));
  add(disk(0, 0.6, {{0, 0, tube_length}}));
}

World mixed_scene(int kind) {
  World w;
  w.add_optic({});
  if (kind < 3) {
    add_tube(w, placed_by(kind), kind == 1 ? 0.01 : 0);
  } else {  // a corner of two arms
    add_stepped_tube(w, placed_by(0));
    add_tube(w, placed_by(2), 0.01);
  }
  w.finish();
  return w;
}
constexpr int scenes = 4;

// A random ray: from the wall, from a mirror almost along the axis (polar angle log-uniform from 1e-6 to 0.3 rad),
// parallel to the axis, across it, from inside the volume, from far outside.
Ray local_ray(int kind, Rng& rng) {
  SinCos const place = sincos_turn(rng.uniform()), heading = sincos_turn(rng.uniform());
  double const z = tube_length * rng.uniform(), r = tube_radius * std::sqrt(rng.uniform());
  Vec3 const inside{r * place.cos, r * place.sin, z};
  double const up = 2 * rng.uniform() - 1, flat = std::sqrt(1 - up * up);
  Vec3 const anywhere{flat * heading.cos, flat * heading.sin, up};
  double const narrow = 1e-6 * std::pow(3e5, rng.uniform());
  SinCos const polar = sincos_turn(narrow / (2 * pi));
  Vec3 const along{polar.sin * heading.cos, polar.sin * heading.sin, kind % 2 ? polar.cos : -polar.cos};
  switch (kind) {
    case 0:
      return {{tube_radius * place.cos, tube_radius * place.sin, z}, anywhere};
    case 1:
      return {{0.34 * inside.x, 0.34 * inside.y, 1.001}, along};
    case 2:
      return {{0.34 * inside.x, 0.34 * inside.y, tube_length - 1.001}, along};
    case 3:
      return {inside, {0, 0, heading.cos > 0 ? 1.0 : -1.0}};
    case 4:
      return {inside, {heading.cos, heading.sin, 0}};
    case 5:
      return {{inside.x, inside.y, 10 + 19.7 * std::floor(150 * rng.uniform())}, anywhere};
    case 6:
      return {inside, anywhere};
    default:
      return {{0.6 * inside.x, 0.6 * inside.y, -37e3}, unit({2e-5 * heading.cos, 2e-5 * heading.sin, 1})};
  }
}
constexpr int kinds = 8;

Ray random_ray(int scene, int kind, Rng& rng) {
  Ray const r = local_ray(kind, rng);
  Pose const pose = placed_by(scene < 3 ? scene : rng.uniform() < 0.5 ? 0 : 2);
  return {pose.point(r.origin), unit(pose.direction(r.dir))};
}

struct Differences {
  int hits = 0, other_surface = 0, other_bits = 0, other_shadow = 0;
  bool none() const { return hits > 5000 && other_surface == 0 && other_bits == 0 && other_shadow == 0; }
};

Differences compare(int scene, WorldView const& tree, WorldView const& brute, int rays) {
  Differences d;
  for (int i = 0; i < rays; ++i) {
    Rng rng(1, std::uint64_t(i), 0, Stream::source);
    Ray ray = random_ray(scene, i % kinds, rng);
    SurfaceId from;
    for (int leg = 0; leg < 2; ++leg) {  // the second leg leaves the surface that the first one found
      Hit const a = tree.closest(ray, from), b = brute.closest(ray, from);
      d.hits += b.surface.valid();
      d.other_surface += a.surface != b.surface;
      d.other_bits += a.distance != b.distance;
      Ray shadow = ray;
      shadow.t_max = (b.surface.valid() ? b.distance : 10) * (0.5 + rng.uniform());
      bool const hidden = b.surface.valid() && b.distance < shadow.t_max;
      d.other_shadow += tree.occluded(shadow, from) != hidden || brute.occluded(shadow, from) != hidden;
      if (!b.surface.valid()) break;
      from = b.surface;
      Vec3 const at = ray.origin + b.distance * ray.dir, n = brute.normal(from, at);
      ray = {brute.project(from, at), unit(reflected(ray.dir, n))};
    }
  }
  return d;
}

WorldView brute_force(WorldView v) {
  v.limits.brute_force = true;
  return v;
}

TEST(world_search, same_bits_as_brute_force) {
  for (int scene = 0; scene < scenes; ++scene) {
    World const w = mixed_scene(scene);
    EXPECT_EQ(w.view().tree.tubes.tubes.size, scene == 3 ? 2u : 1u);
    Differences const d = compare(scene, w.view(), brute_force(w.view()), 20000);
    EXPECT_TRUE(d.none()) << "scene " << scene << ": " << d.hits << " hits, " << d.other_surface << " other surfaces, "
                          << d.other_bits << " other distances, " << d.other_shadow << " other shadows";
  }
}

// Negative controls: what surfaces of a tube occupy is stated a little too small, once per bound.
struct Tampered {
  std::vector<TubeItem> items;
  std::vector<double> behind;
  template <class Change>
  Tampered(WorldView const& v, Change change)
      : items(v.tree.tubes.items.data, v.tree.tubes.items.data + v.tree.tubes.items.size),
        behind(v.tree.tubes.behind.data, v.tree.tubes.behind.data + v.tree.tubes.behind.size) {
    for (std::size_t i = 0; i < items.size(); ++i) change(items[i], behind[i]);
  }
  WorldView in(WorldView v) const {
    v.tree.tubes.items = {items.data(), items.size()};
    v.tree.tubes.behind = {behind.data(), behind.size()};
    return v;
  }
};

template <class Change>
bool rejected(Change change) {
  World const w = mixed_scene(1);
  return !compare(1, Tampered(w.view(), change).in(w.view()), brute_force(w.view()), 12000).none();
}

TEST(world_search, controls_are_rejected) {
  EXPECT_FALSE(rejected([](TubeItem&, double&) {}));
  EXPECT_TRUE(rejected([](TubeItem& e, double&) { e.clear2 *= 1.02; }));
  EXPECT_TRUE(rejected([](TubeItem& e, double&) { e.reach2 *= 0.98; }));
  EXPECT_TRUE(rejected([](TubeItem& e, double&) { e.low += 1e-3; }));
  EXPECT_TRUE(rejected([](TubeItem& e, double&) { e.high = e.low; }));
  EXPECT_TRUE(rejected([](TubeItem& e, double&) { e.run_high -= 50; }));
  EXPECT_TRUE(rejected([](TubeItem&, double& behind) { behind -= 20; }));
  for (int level = 0; level < 3; ++level)
    EXPECT_TRUE(rejected([level](TubeItem& e, double&) { e.skip2[level] *= 1.05; })) << level;
}

// Boxes of trees stated too small lose hits too.
TEST(world_search, control_with_smaller_boxes_is_rejected) {
  World const w = mixed_scene(3);
  WorldView v = w.view();
  std::vector<Bvh8::Node> nodes(v.tree.nodes.data, v.tree.nodes.data + v.tree.nodes.size);
  for (Bvh8::Node& n : nodes)
    for (int k = 0; k < 3; ++k)
      for (float& x : n.bound[k]) x += 0.01f;
  v.tree.nodes = {nodes.data(), nodes.size()};
  EXPECT_FALSE(compare(3, v, brute_force(w.view()), 20000).none());
}

// Every instruction set that this processor can run gives the same bits.
TEST(world_search, same_bits_for_every_instruction_set) {
  SearchKernels const* const chosen = search_kernels;
  World const w = mixed_scene(3);
  WorldView const v = w.view();
  std::vector<Hit> first;
  int compared = 0;
  for (char const* name : {"portable", "avx2", "avx512"}) {
    search_kernels = find_search_kernels(name);
    if (search_kernels == nullptr) continue;  // this processor lacks it
    for (std::size_t i = 0; i < 40000; ++i) {
      Rng rng(7, i, 0, Stream::source);
      Ray ray = random_ray(3, int(i % kinds), rng);
      Hit const hit = v.closest(ray, {});
      if (first.size() <= i) first.push_back(hit);
      EXPECT_EQ(hit.surface, first[i].surface);
      EXPECT_EQ(hit.distance, first[i].distance);
      ray.t_max = hit.distance < infinity ? 1.5 * hit.distance : 10;
      EXPECT_EQ(v.occluded(ray, {}), hit.surface.valid());
      ++compared;
    }
  }
  search_kernels = chosen;
  EXPECT_GE(compared, 40000);
  EXPECT_EQ(find_search_kernels("fast"), nullptr);
}

TEST(world_search, ties_go_to_the_lower_id) {
  World w;
  w.add_optic({});
  for (int i = 0; i < 20; ++i) w.add_surface(disk(0, 1, {{0, 0, double(i / 2)}}), 0, 0, {}, {});
  w.finish();
  for (double from : {-1.0, 0.5, 3.5}) {
    Hit const hit = w.view().closest({{0.1, 0.2, from}, {0, 0, 1}}, {});
    EXPECT_EQ(hit.surface.value, from < 0 ? 0 : 2 * std::uint32_t(std::ceil(from)));
  }
}

// Surfaces beyond t_max do not count, and one exactly at t_max does not either: closest and occluded agree.
TEST(world_search, the_end_of_the_ray_is_open) {
  World w;
  w.add_optic({});
  w.add_surface(disk(0, 1, {{0, 0, 4}}), 0, 0, {}, {});
  w.finish();
  for (WorldView const& v : {w.view(), brute_force(w.view())})
    for (double t_max : {3.0, 4.0, std::nextafter(4.0, 5.0), infinity}) {
      Ray const ray{{0, 0, 0}, {0, 0, 1}, t_max};
      EXPECT_EQ(v.closest(ray, {}).surface.valid(), t_max > 4) << t_max;
      EXPECT_EQ(v.occluded(ray, {}), t_max > 4) << t_max;
    }
}

// A search returns kind and number of a shape in one word: more of a kind than it can name are an error, not confused.
TEST(world_search, more_shapes_than_can_be_named_are_errors) {
  SurfaceRef const last = SurfaceRef::of(5, {3, SurfaceRef::most_shapes - 1}),
                   control = SurfaceRef::of(5, {3, 1u << 24});
  EXPECT_EQ(last.shape().kind, 3u);
  EXPECT_EQ(last.shape().index, SurfaceRef::most_shapes - 1);
  EXPECT_NE(control.shape().index, SurfaceRef::most_shapes);
  World w;
  w.most_shapes = 2;
  w.add_optic({});
  for (double z : {1.0, 2.0}) w.add_surface(disk(0, 1, {{0, 0, z}}), 0, 0, {}, {});
  w.add_surface(sphere(2), 0, 0, {}, {});  // another kind has room
  try {
    w.add_surface(disk(0, 1, {{0, 0, 3}}), 0, 0, {}, {});
    FAIL() << "accepted";
  } catch (InputError const& e) {
    EXPECT_NE(std::string(e.what()).find("more than 2 surfaces of shape 'disk'"), std::string::npos) << e.what();
  }
}

TEST(world_search, empty_and_single_surface_worlds) {
  World w;
  w.add_optic({});
  w.finish();
  EXPECT_FALSE(w.view().closest({{0, 0, 0}, {0, 0, 1}}, {}).surface.valid());
  w.add_surface(sphere(2), 0, 0, {}, {});
  w.finish();
  EXPECT_EQ(w.view().closest({{0, 0, 0}, {0, 0, 1}}, {}).distance, 2);
  EXPECT_EQ(w.view().closest({{0, 0, 2}, {0, 0, -1}}, SurfaceId{0}).distance, 4);
  EXPECT_FALSE(w.view().closest({{0, 0, 2}, {0, 0, 1}}, SurfaceId{0}).surface.valid());
}

}  // namespace
}  // namespace straytrace::world_search
