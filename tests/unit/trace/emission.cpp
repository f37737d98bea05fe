// SPDX-License-Identifier: BSD-3-Clause
// Where light leaves the mode and in which direction (R3.10).
#include "optics/scatter/shift_invariant.hpp"
#include "support/trace_support.hpp"

namespace straytrace::testing {
namespace {

struct Starts : Silent {
  Footprint lit;
  Sampler rho2, x, power;
  void emitted(PathState const& path, Vertex const& v) {
    Vec3 const off = lit.offset(v.point);
    rho2.add(length2(off));
    x.add(off.x);
    power.add(path.power);
  }
};
Starts starts(Profile profile, double radius, Vec3 travel) {
  World world;
  SurfaceId const s = world.add_surface(Disk{{0, 0, 5}, {0, 0, 1}, 0, 1}, lambertian_optic(world, 0.5),
                                        black_optic(world), world.add_body("plate", {}), world.add_group("plate"));
  world.add_footprint(spot(s, {0.1, 0, 5}, unit(travel), profile, radius));
  world.finish();
  Starts found;
  found.lit = world.footprints()[0];
  walk(world, 1 << 16, found, [] {});
  return found;
}

// Uniform disc: <rho^2> = R^2/2. Gaussian of intensity radius w: w^2/2. Across the beam, also when it is tilted.
TEST(Emission, MomentsR3_10) {
  for (Vec3 const travel : {Vec3{0, 0, -1}, Vec3{1, 0.5, -1}}) {
    Starts const even = starts(Profile::even, 0.2, travel), gaussian = starts(Profile::gaussian, 0.1, travel);
    expect_mean("even", even.rho2.mean(), 0.02, 5e-4);
    expect_mean("gaussian", gaussian.rho2.mean(), 0.005, 2e-4);
    expect_mean("centred", gaussian.x.mean(), 0, 4e-3);
    expect_rejected("w as twice the standard deviation of the radius squared", gaussian.rho2.mean(), 0.01);
    expect_rejected("radius drawn evenly", even.rho2.mean(), 0.2 * 0.2 / 3);
  }
  Starts const point = starts(Profile::point, 0, {0, 0, -1});
  EXPECT_LT(point.rho2.mean().mean, 1e-30);
}

// Start phase of a free beam with a curved wavefront: k rho^2/(2 RoC), to the next order k rho^4/(8 RoC^3).
struct Phases : Silent {
  Footprint beam;
  double k = 0, worst = 0, doubled = 0, largest = 0;
  void emitted(PathState const& path, Vertex const& v) {
    double const rho2 = length2(beam.offset(v.point)), expected = k * 0.5 * beam.curvature * rho2;
    worst = std::fmax(worst, std::fabs(k * path.path_length - expected));
    doubled = std::fmax(doubled, std::fabs(k * path.path_length - 2 * expected));
    largest = std::fmax(largest, std::fabs(expected));
  }
};
TEST(Emission, StartPhaseR3_10) {
  for (double const roc : {2.2, -9.2, 1683.0}) {
    World world;
    Footprint const beam = free_beam({}, {}, {0.2, 0, 1}, Profile::even, 5.75e-3, 1 / roc);
    world.add_footprint(beam);
    world.finish();
    Phases found;
    found.beam = beam;
    found.k = 2 * pi / world.wavelength;
    walk(world, 1 << 12, found, [] {});
    double const rho2 = beam.radius * beam.radius, next = found.k * rho2 * rho2 / std::fabs(8 * roc * roc * roc);
    EXPECT_LT(found.worst, 1.01 * next + 1e-9) << roc;
    EXPECT_GT(found.largest, 0.9 * found.k * rho2 / std::fabs(2 * roc));  // what a flat start would be wrong by
    EXPECT_GT(found.largest, 10 * (1.01 * next + 1e-9));
    EXPECT_GT(found.doubled, 10 * (1.01 * next + 1e-9));  // control: k rho^2/RoC
  }
}

// The share of the light that a source gives to each of its footprints: one of them is drawn, its power is scaled up.
TEST(Emission, FootprintsShareTheHistories) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const grey = lambertian_optic(world, 0.5), black = black_optic(world);
  SurfaceId const a = world.add_surface(Disk{}, grey, black, body, world.add_group("a"));
  SurfaceId const b = world.add_surface(Disk{{0, 0, -1}}, grey, black, body, world.add_group("b"));
  world.add_footprint(spot(a, {}, {0, 0, -1}, Profile::point, 0));
  Footprint f = spot(b, {0, 0, -1}, {0, 0, -1}, Profile::point, 0);
  f.share = 0.25;
  world.add_footprint(f);
  world.finish();
  struct Power : Silent {
    double now[2] = {};
    Sampler by[2];
    void emitted(PathState const& path, Vertex const&) { now[path.source] = path.emitted; }
  } power;
  walk(world, 1 << 16, power, [&] {
    for (int i = 0; i < 2; ++i) power.by[i].add(power.now[i]);
    power.now[0] = power.now[1] = 0;
  });
  expect_mean("whole mode", power.by[0].mean(), 0.5, 2e-2);
  expect_mean("a quarter of it", power.by[1].mean(), 0.125, 5e-3);
  expect_rejected("not scaled by the number of footprints", scaled(power.by[0].mean(), 0.5), 0.5);
}

// b(theta) of eq. 3.19, theta_min = 55e-6: 10, 25, 50, 75, 90 % of the light lie below these angles (R5.06).
TEST(Emission, QuantilesOfTheStatisticalLawR5_06) {
  World world;
  double const above = 55e-6, loss = 1e-6;
  std::uint32_t const mirror = power_law_optic(world, loss * statistical_kappa(above) / (2 * pi), 2, above);
  SurfaceId const s =
      world.add_surface(Disk{}, mirror, black_optic(world), world.add_body("mirror", {}), world.add_group("mirror"));
  world.add_footprint(spot(s, {}, {0, 0, -1}, Profile::point, 0));
  world.finish();
  WorldView const view = world.view();
  double const angles[] = {1.505e-4, 6.812e-4, 8.438e-3, 0.10461, 0.48230}, shares[] = {0.1, 0.25, 0.5, 0.75, 0.9};
  Sampler below[5];
  Silent silent;
  for (std::uint64_t h = 0; h < 1 << 17; ++h) {
    PathState path;
    bool const alive = launch(view, 1, h, s, {}, {0, 0, -1}, path, silent);
    path.power *= finish_hop_weight(view, path, nullptr);
    double const theta = std::atan2(std::hypot(path.ray.dir.x, path.ray.dir.y), path.ray.dir.z);
    for (int i = 0; i < 5; ++i)  // b has no cosine, the walk carries one
      below[i].add(alive && theta < angles[i] ? path.power / path.ray.dir.z / loss : 0);
  }
  for (int i = 0; i < 5; ++i) expect_mean("quantile", below[i].mean(), shares[i], 2e-2);
  expect_rejected("theta_min of 1e-2 in the normalisation", below[2].mean(), 0.5 * 0.2056198 / 0.0993409);
}

}  // namespace
}  // namespace straytrace::testing
