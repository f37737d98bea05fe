// SPDX-License-Identifier: BSD-3-Clause
// Aiming in scenes of more strips than the tables of importance have rows (docs/theory/sampling.md): neighbours share a
// patch; a patch is drawn, then a point of it. The mean is that of the BSDF model alone, the error is smaller.
#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "base/errors.hpp"
#include "support/baffled_tube.hpp"
#include "support/mesh_shapes.hpp"
#include "support/shapes.hpp"
#include "support/trace_received.hpp"
#include "trace/importance/steering_tables.hpp"

namespace straytrace::testing {
namespace {

// Centres and normals of 3000 small plates above a scattering spot.
std::vector<Placement> plates() {
  std::vector<Placement> all;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 10; ++j)
      for (int k = 0; k < 10; ++k) {
        double const turn = 0.61803398875 * (i + 31 * j + 317 * k);  // no two planes alike
        SinCos const t = sincos_turn(turn - std::floor(turn));
        Vec3 const at{-2 + 4 * (i + 0.5) / 30, -1 + 2 * (j + 0.5) / 10, 1 + (k + 0.5 + 0.3 * t.sin) / 10};
        all.push_back({at, unit({0.2 * t.cos, 0.2 * t.sin, -1})});
      }
  return all;
}
// The same as squares in one mesh.
TriangleMesh meshed_plates(double half_side) {
  Soup soup;
  for (Placement const& p : plates()) {
    Frame const frame = Frame::around(p.along);
    auto const first = std::uint32_t(soup.vertices.size());
    for (auto const& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      Vec3 const v = p.at + half_side * frame.to_world({double(x), double(y), 0});
      soup.vertices.push_back({float(v.x), float(v.y), float(v.z)});
    }
    soup.triangles.push_back({{first, first + 1, first + 2}});
    soup.triangles.push_back({{first, first + 2, first + 3}});
  }
  return mesh_of(soup, Pose{});
}

// A receiver deep in a black tube sees few of the plates, and nothing else.
World cloud(bool mesh = false, double top = 0.9) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), grey = lambertian_optic(world, 0.5);
  SurfaceId const source =
      world.add_surface(disk(0, 0.1), lambertian_optic(world, 1e-3), black, body, world.add_group("source"));
  GroupId const group = world.add_group("plates");
  if (mesh)
    world.add_surface(meshed_plates(5e-3), grey, black, body, group);
  else
    for (Placement const& p : plates()) world.add_surface(disk(0, 5e-3, p), grey, black, body, group);
  world.add_surface(cylinder(0.2, 0.2, top, {{1.5, 0, 0}, {0, 0, 1}}), black, black, body, world.add_group("tube"));
  receive_on(world, "eye",
             world.add_surface(disk(0, 0.05, {{1.5, 0, 0.2}, {0, 0, 1}}), black, black, body, world.add_group("eye")));
  world.add_footprint(spot(source, {}, {0, 0, -1}, Profile::even, 0.05));
  world.limits.max_order = 8;
  world.finish();
  return world;
}

ImportanceSettings few_rows() {
  ImportanceSettings settings;
  settings.most_patches = 300;
  settings.pilot_histories = 1 << 10;
  return settings;
}

TEST(Patches, AimingWorksWithManyStrips) {
  World world = cloud();
  SampleMean const law = received_share(run_histories(world, 1 << 19));
  SteeringTables const tables = make_importance(world, few_rows());
  ASSERT_GT(tables.strips.size(), 2500u);
  EXPECT_LE(tables.patches.size(), 300u);
  world.steer(tables);
  SampleMean const aimed = received_share(run_histories(world, 1 << 17));
  double const relative = law.std_error / law.mean;
  EXPECT_LT(relative, 0.1);
  expect_mean("power on the eye, aimed less by law", difference(aimed, law), 0, 8 * 0.1 * law.mean);
  // at a quarter of the histories
  EXPECT_LT(aimed.std_error / aimed.mean, relative / 10) << relative;
}

// Control: a density that is not the one drawn with.
TEST(Patches, WrongPatchAreaIsRejected) {
  World world = cloud();
  SteeringTables tables = make_importance(world, few_rows());
  world.steer(tables);
  SampleMean const right = received_share(run_histories(world, 1 << 16));
  for (Patch& p : tables.patches)
    if (p.count > 1) p.area *= 1.1;
  world.steer(tables);
  try {
    SampleMean const wrong = received_share(run_histories(world, 1 << 16));
    expect_rejected("patches a tenth too large", difference(wrong, right), 0);
  } catch (NumericalError const&) {
    SUCCEED() << "the check of the energy balance rejects it";
  }
}

// A black surface hides another but for 1.4 % of its area: rings of one size, of which the rear one is seen through the
// hole of the first, and disks, of which the rear one is larger.
namespace sliver {
constexpr double edge = 0.5, near = 1, far = 1.02, albedo = 0.5, eye_radius = 1e-3;  // m; 1
constexpr Vec3 eye{0.03, 0, 0};
enum class Kind { ring, serrated, disk };
struct Radii {
  double inner, outer;
};
Radii front(Kind kind) { return kind == Kind::disk ? Radii{0, edge} : Radii{edge, 1}; }
Radii rear(Kind kind) { return kind == Kind::disk ? Radii{0, 0.5137} : Radii{edge, 1}; }

World world_of(Kind kind) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), grey = lambertian_optic(world, albedo);
  SurfaceId const source =
      world.add_surface(disk(0, 0.01), lambertian_optic(world, 1e-3), black, body, world.add_group("source"));
  Radii const hiding = front(kind), hidden = rear(kind);
  world.add_surface(disk(hiding.inner, hiding.outer, {{0, 0, near}}), black, black, body, world.add_group("front"));
  GroupId const group = world.add_group("rear");
  if (kind == Kind::serrated) {
    SerratedCone teeth = serrated(hidden.inner, hidden.outer, pi / 2, 1e-6, 100);  // so shallow that the rim is round
    teeth.place({.origin = {0, 0, far}});                                          // its front faces against its axis
    world.add_surface(teeth, grey, black, body, group);
  } else {
    world.add_surface(disk(hidden.inner, hidden.outer, {{0, 0, far}, {0, 0, -1}}), grey, black, body, group);
  }
  receive_on(world, "eye",
             world.add_surface(disk(0, eye_radius, {eye, {0, 0, 1}}), black, black, body, world.add_group("eye")));
  world.add_footprint(spot(source, {}, {0, 0, -1}, Profile::even, 1e-4));
  world.limits.max_order = 2;
  world.finish();
  return world;
}

// Both ends Lambertian: cos/pi and the same cosines at the rear surface, over its visible part (eq. 1.3 twice).
double expected(Kind kind, bool shadow) {
  constexpr int n = 2000;
  Radii const hiding = front(kind), hidden = rear(kind);
  auto const passes = [&](Vec3 p, Vec3 end) {
    Vec3 const crossing = end + (near / far) * (p - end);
    double const rho = std::hypot(crossing.x, crossing.y);
    return rho < hiding.inner || rho > hiding.outer;
  };
  double const width = hidden.outer - hidden.inner;
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      double const rho = hidden.inner + width * (i + 0.5) / n;
      SinCos const a = sincos_turn((j + 0.5) / n);
      Vec3 const p{rho * a.cos, rho * a.sin, far};
      if (shadow && !(passes(p, {}) && passes(p, eye))) continue;
      double const there2 = length2(p), back2 = length2(eye - p);
      sum += rho * std::pow(far, 4) / (there2 * there2 * back2 * back2);
    }
  return sum * width / n * 2 * pi / n * albedo * eye_radius * eye_radius / pi;
}
}  // namespace sliver

TEST(Patches, SliversBehindOthersGetLight) {
  for (auto const kind : {sliver::Kind::ring, sliver::Kind::serrated, sliver::Kind::disk}) {
    double const expected = sliver::expected(kind, true);
    EXPECT_GT(sliver::expected(kind, false), 20 * expected) << "control: without the shadow";
    World world = sliver::world_of(kind);
    world.steer(make_importance(world));
    SampleMean const aimed = received_share(run_histories(world, 1 << 17));
    EXPECT_LT(aimed.std_error, 0.04 * aimed.mean) << "0.06 for the disk without the lines that look for slivers";
    expect_mean("light by a sliver", aimed, expected, 0.3 * expected);
  }
}

// A tube of which the source sees a sliver of the inside, and much of the black outside: each section is aimed at.
TEST(Patches, SliversOfOneSideAreAimedAtThoughTheOtherIsInSight) {
  constexpr double radius = 0.13, half_length = 0.45, tilt = 0.01;  // m, rad
  for (bool const closed : {false, true}) {
    World world;
    BodyId const body = world.add_body("all", {});
    std::uint32_t const black = black_optic(world), grey = lambertian_optic(world, 0.5);
    SurfaceId const source =
        world.add_surface(disk(0, 0.01), lambertian_optic(world, 1e-3), black, body, world.add_group("source"));
    SurfaceId const tube =
        world.add_surface(cylinder(radius, -half_length, half_length, {{0, 0, 20}, unit({0, tilt, 1})}), black, grey,
                          body, world.add_group("tube"));
    Vec3 const corner{closed ? 0.2 : 0.0935, 0.072, 15};  // of the screen
    world.add_surface(placed(rectangle(2, 2), {corner - Vec3{1, 1, 0}, {0, 0, -1}}), black, black, body,
                      world.add_group("screen"));
    receive_on(world, "eye",
               world.add_surface(disk(0, 1e-3, {{0.03, 0, 0}, {0, 0, 1}}), black, black, body, world.add_group("eye")));
    world.add_footprint(spot(source, {}, {0, 0, -1}, Profile::even, 1e-4));
    world.finish();
    SteeringTables const tables = make_importance(world);
    PatchSide const& emits = tables.sides.front();  // of the first surface
    auto const aims = std::span(tables.targets).subspan(emits.first, emits.count);
    std::size_t sections = 0, aimed_at = 0;
    for (std::uint32_t patch = 0; patch < tables.patches.size(); ++patch) {
      if (!(tables.strips[tables.members[tables.patches[patch].first].strip].surface == tube)) continue;
      ++sections;
      if (std::ranges::any_of(aims, [=](Target const& t) { return t.patch == patch; })) ++aimed_at;
    }
    EXPECT_GT(sections, 8u);
    EXPECT_EQ(aimed_at, closed ? 0 : sections) << (closed ? "control: nothing of the inside is in sight" : "");
  }
}

// The wall of a tube of 4 km has sections of some decimetres next to the mirror, whose light mostly returns from there,
// and of many metres elsewhere; in all no more than the tables hold.
TEST(Patches, WallsHaveShortSectionsNearBeams) {
  World const world = baffled_tube();
  SteeringTables const tables = make_strips(world);
  std::uint32_t const wall = 1;
  double longest_near = 0, longest = 0;
  int sections = 0;
  for (Strip const& s : tables.strips) {
    if (s.surface.value != wall) continue;
    double const length = baffled_length * (s.u_high - s.u_low);
    if (baffled_length * s.u_high < 3) longest_near = std::max(longest_near, length);
    longest = std::max(longest, length);
    ++sections;
  }
  EXPECT_LT(longest_near, 1);
  EXPECT_GT(longest_near, 0.1);
  EXPECT_GT(longest, 10);
  EXPECT_LE(sections, 256);
}

// Neighbours of one kind: no patch mixes groups, lit surfaces and receivers stay separate, all strips are listed
// once, and patches near the beam are smaller than those far away.
TEST(Patches, NeighboursAreJoined) {
  World const world = cloud();
  SteeringTables tables = make_strips(world);
  merge_strips(world, 300, tables);
  EXPECT_EQ(tables.patches.size(), 300u);
  EXPECT_EQ(tables.sides.size(), 600u);
  std::vector<int> listed(tables.strips.size(), 0);
  WorldView const view = world.view();
  double largest = 0;
  for (std::uint32_t p = 0; p < tables.patches.size(); ++p) {
    Patch const& patch = tables.patches[p];
    Box box;
    double area = 0;
    for (std::uint32_t m = patch.first; m < patch.first + patch.count; ++m) {
      std::uint32_t const strip = tables.members[m].strip;
      ++listed[strip];
      EXPECT_EQ(tables.strips[strip].patch, p);
      EXPECT_EQ(tables.members[m].before, area);
      area += tables.strips[strip].area;
      Surface const& first = view.surfaces[tables.strips[tables.members[patch.first].strip].surface.value];
      Surface const& here = view.surfaces[tables.strips[strip].surface.value];
      EXPECT_EQ(first.group.value, here.group.value);
      EXPECT_TRUE(patch.count == 1 || here.group.value == 1 || here.group.value == 2);  // discs, tube
      box.add(bounds_of(view, tables.strips[strip]));
    }
    EXPECT_EQ(patch.area, area);
    if (patch.count > 1) largest = std::max(largest, length(box.upper - box.lower));
  }
  for (int const times : listed) EXPECT_EQ(times, 1);
  EXPECT_LT(largest, 1.2);  // of a cloud of 4.6 m
  SteeringTables few = make_strips(world);
  merge_strips(world, 3, few);  // fewer than there are groups
  EXPECT_EQ(few.patches.size(), 3u);
}

// One mesh of many triangles is aimed at by its parts.
TEST(Patches, AimingUsesThePartsOfAMesh) {
  World world = cloud(true, 0.5);
  SampleMean const law = received_share(run_histories(world, 1 << 19));
  SteeringTables const tables = make_importance(world);
  EXPECT_GE(tables.strips.size(), 64u);
  world.steer(tables);
  SampleMean const aimed = received_share(run_histories(world, 1 << 17));
  expect_mean("power on the eye, aimed less by law", difference(aimed, law), 0, 0.5 * law.mean);
  EXPECT_LT(aimed.std_error / aimed.mean, law.std_error / law.mean / 2);  // at a quarter of the histories
}

}  // namespace
}  // namespace straytrace::testing
