// SPDX-License-Identifier: BSD-3-Clause
// First-order lists: what a detector sees by mirrors (closed forms of etendue and visibility), and single scatter.
#include "trace/camera/first_order.hpp"

#include <set>

#include "support/trace_support.hpp"

namespace straytrace::testing::trace_first_order {
namespace {

constexpr double sensor = 5e-3, hole = 0.03;  // m, radii
constexpr double shift = 0.2, height = 0.3, plate = 0.4, wall = 0.5;

// A sensor at the origin looks up into two mirrors that shift its view by `shift` along x; above them a plate with a
// hole, then a wall. `baffle`: a screen between the mirrors that leaves only the way from one to the other.
World periscope(bool baffle, double reflect = 1) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), silver = mirror_optic(world, reflect),
                      white = lambertian_optic(world, 0.5);
  SurfaceId const diode =
      world.add_surface(Disk{{}, {0, 0, 1}, 0, sensor}, black, black, body, world.add_group("sensor"));
  GroupId const mirrors = world.add_group("mirrors"), screens = world.add_group("screens");
  world.add_surface(Disk{{0, 0, height}, unit({1, 0, -1}), 0, 0.06}, silver, silver, body, mirrors);
  world.add_surface(Disk{{shift, 0, height}, unit({-1, 0, 1}), 0, 0.06}, silver, silver, body, mirrors);
  world.add_surface(Disk{{shift, 0, plate}, {0, 0, 1}, hole, 5}, black, black, body, screens);
  if (baffle) world.add_surface(Disk{{shift / 2, 0, height}, {1, 0, 0}, 0.03, 5}, black, black, body, screens);
  world.add_surface(Disk{{0, 0, wall}, {0, 0, 1}, 0, 5}, white, white, body, world.add_group("wall"));
  Receiver r;
  r.surface = diode;
  world.add_receiver("diode", r);
  world.finish();
  return world;
}

struct SeenWall {
  SampleMean throughput;
  double furthest = 0;  // m from where the shifted axis meets the wall
};
SeenWall seen_wall(World& world, std::uint64_t walks) {
  WorldView const view = world.view();
  GroupId const group = world.add_group("wall");
  double sum = 0, sum2 = 0;
  SeenWall result;
  for (std::uint64_t n = 0; n < walks; ++n) {
    PathState path;
    double here = 0;
    if (!start_backward(view, 1, n, {false, 0}, path)) continue;
    follow_specular(
        view, 1, path,
        [&](PathState const& p, Vertex const& v) {
          if (view.surfaces[v.surface.value].group != group) return;
          here += p.power;
          result.furthest = std::max(result.furthest, length(v.point - Vec3{shift, 0, wall}));
        },
        [](double) {});
    sum += here;
    sum2 += here * here;
  }
  double const mean = sum / double(walks);
  result.throughput = {mean, std::sqrt((sum2 / double(walks) - mean * mean) / double(walks)), (long long)walks};
  return result;
}

// Etendue pi A F of sensor and hole, two coaxial discs at the unfolded distance; the wall is seen within the shadow of
// the hole's rim, and nowhere else. Controls: without the screen, and another radius of the hole.
TEST(FirstOrder, PeriscopeShowsExactlyThePartOfTheWall) {
  auto const etendue = [](double radius) {
    double const d = plate + shift, r1 = sensor / d, r2 = radius / d, x = 1 + (1 + r2 * r2) / (r1 * r1);
    return pi * pi * sensor * sensor * 0.5 * (x - std::sqrt(x * x - 4 * r2 * r2 / (r1 * r1)));
  };
  double const rim = hole + (hole + sensor) * (wall - plate) / (plate + shift);
  World world = periscope(true);
  constexpr std::uint64_t walks = 1 << 22;
  SeenWall const seen = seen_wall(world, walks);
  expect_mean("etendue", seen.throughput, etendue(hole), 0.1 * etendue(hole));
  expect_rejected("a hole 15 % wider", seen.throughput, etendue(1.15 * hole));
  EXPECT_LT(seen.furthest, rim * (1 + 1e-12));
  EXPECT_GT(seen.furthest, 0.9 * rim);
  World open = periscope(false);
  EXPECT_GT(seen_wall(open, 1 << 18).furthest, 2 * rim);
}

// Two mirrors of reflectance 0.8 keep 0.64 of it: the same walks, fainter. Control: one mirror.
TEST(FirstOrder, MirrorsTakeTheirShare) {
  World clear = periscope(true), dim = periscope(true, 0.8);
  double const ratio = seen_wall(dim, 1 << 16).throughput.mean / seen_wall(clear, 1 << 16).throughput.mean;
  EXPECT_NEAR(ratio, 0.64, 1e-12);
  EXPECT_GT(std::fabs(ratio - 0.8), 1e-12);
}

// Baffles by the shadow rule hide the whole wall of a tube from every point of the mirror (docs/theory/sampling.md).
// Control: one baffle missing.
TEST(FirstOrder, BafflesHideTheWholeWall) {
  auto const wall_seen = [](int missing) {
    constexpr double tube = 0.6, rim = 0.5, mirror = 0.17, first = 10, end = 600;
    World world;
    BodyId const body = world.add_body("tube", {});
    std::uint32_t const black = black_optic(world), white = lambertian_optic(world, 0.3);
    SurfaceId const optic =
        world.add_surface(Disk{{}, {0, 0, 1}, 0, mirror}, white, black, body, world.add_group("mirror"));
    world.add_surface(Cylinder{{}, {0, 0, 1}, tube, first, end}, black, white, body, world.add_group("wall"));
    int number = 0;
    for (double z = first; z < end; z *= 0.999 * (tube + mirror) / (rim + mirror), ++number)
      if (number != missing)
        world.add_surface(Disk{{0, 0, z}, {0, 0, 1}, rim, tube}, white, white, body, world.add_group("baffles"));
    world.add_surface(Disk{{0, 0, end}, {0, 0, 1}, 0, tube}, white, white, body, world.add_group("end"));
    Receiver r;
    r.surface = optic;
    world.add_receiver("mirror", r);
    world.add_footprint(spot(optic, {}, {0, 0, -1}, Profile::even, 0.1));
    world.finish();
    FirstOrderSettings settings;
    settings.histories = 1 << 17;
    double seen = 0;
    auto const lists = first_order(world, settings);
    for (FirstOrderRow const& row : lists.front().rows)
      if (world.groups()[row.group.value] == "wall") seen += row.throughput.mean + row.power.mean;
    return seen;
  };
  EXPECT_EQ(wall_seen(-1), 0);
  EXPECT_GT(wall_seen(2), 0);
}

// Integrating sphere: light scattered at a point lights the sphere evenly, and a part of it of share s is seen evenly,
// so that single scatter off the rest is rho^2 (1 - s) s; power on the rest rho (1 - s), etendue pi A s. Control: rho 3
// % off.
TEST(FirstOrder, SingleScatterInASphere) {
  constexpr double rho = 0.6, rim = 0.5;
  World world;
  BodyId const body = world.add_body("sphere", {});
  std::uint32_t const white = lambertian_optic(world, rho), black = black_optic(world);
  GroupId const all = world.add_group("wall");
  SurfaceId const low = world.add_surface(Cap{{0, 0, -1}, {0, 0, 1}, 1, 0, 1}, white, black, body, all);
  world.add_surface(Cap{{0, 0, 1}, {0, 0, -1}, 1, rim, 1}, white, black, body, all);
  SurfaceId const diode =
      world.add_surface(Cap{{0, 0, 1}, {0, 0, -1}, 1, 0, rim}, black, black, body, world.add_group("diode"));
  Receiver r;
  r.surface = diode;
  world.add_receiver("diode", r);
  world.add_footprint(spot(low, {0, 0, -1}, {0, 0, -1}, Profile::point, 0));
  world.finish();
  FirstOrderSettings settings;
  settings.histories = 1 << 17;
  auto const lists = first_order(world, settings);
  ASSERT_EQ(lists.size(), 1u);
  FirstOrderRow const row = lists.front().rows.front();
  ASSERT_TRUE(row.group == all);
  double const share = 0.5 * (1 - std::sqrt(1 - rim * rim)), area = 4 * pi * share;
  auto const n = (long long)settings.histories;
  expect_mean("power", sample_mean(row.power, n), rho * (1 - share), 0.01 * rho);
  expect_mean("throughput", sample_mean(row.throughput, n), pi * area * (1 - share), 0.01 * pi * area);
  double const single = rho * rho * (1 - share) * share;
  expect_mean("single scatter", sample_mean(row.product, n), single, 0.01 * single);
  expect_rejected("rho 3 % off", sample_mean(row.product, n), 1.03 * 1.03 * single);
  settings.threads = 1;
  EXPECT_EQ(first_order(world, settings).front().rows.front().product.mean, row.product.mean);
}

// Walks from a mode start in directions that a block deals evenly (docs/theory/sampling.md, Strata): by the cosine law
// (eq. 3.3), 256 consecutive ones have each of 256 cells of sin^2 once. Control: those of different blocks do not.
TEST(FirstOrder, WalksFromAModeShareTheirDirections) {
  World world;
  SurfaceId const mirror = world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, lambertian_optic(world, 0.5),
                                             black_optic(world), world.add_body("all", {}), world.add_group("mirror"));
  world.add_footprint(spot(mirror, {}, {0, 0, -1}, Profile::even, 0.1, world.add_port("mode")));
  world.finish();
  WorldView const view = world.view();
  auto const cells = [&](std::uint64_t step) {
    std::set<int> met;
    for (std::uint64_t n = 0; n < 256; ++n) {
      PathState path;
      EXPECT_TRUE(start_backward(view, 1, step * n, {true, 0}, path));
      double const z = path.ray.dir.z;
      met.insert(int(256 * (1 - z * z)));
    }
    return met.size();
  };
  EXPECT_EQ(cells(1), 256u);
  EXPECT_LT(cells(view.block_size), 200u) << "control";
}

}  // namespace
}  // namespace straytrace::testing::trace_first_order
