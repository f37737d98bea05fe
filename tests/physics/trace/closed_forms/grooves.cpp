// SPDX-License-Identifier: BSD-3-Clause
// Grooves on surfaces of a scene: their direction, and an energy balance whose total depends on the azimuth.
#include "base/errors.hpp"
#include "support/trace_support.hpp"

namespace straytrace::testing {
namespace {

std::uint32_t grooved(World& world, Lay lay, Vec3 direction = {}, bool mean_only = false) {
  Grooves law;
  law.across = 0.5;
  law.along = 0.02;
  law.reflectance = law.grazing = 0.9;
  law.prepare();
  if (mean_only)
    for (int i = 0; i < Grooves::azimuths; ++i)
      for (int k = 0; k < Grooves::cosines; ++k) {
        double const cosine = law.node(i, k).z;
        law.totals[i][k] = law.mean.at(cosine) - law.factor(cosine);
      }
  Optic optic;
  optic.laws = 1;
  optic.law[0] = world.add_law(law);
  optic.lay = lay;
  optic.lay_direction = direction;
  return world.add_optic(optic);
}

// Local y runs with the grooves, whatever way the surface looks; z stays the normal.
TEST(Lay, FollowsTheSurface) {
  World world;
  BodyId const body = world.add_body("all", {});
  GroupId const group = world.add_group("all");
  std::uint32_t const turned = grooved(world, Lay::around), drawn = grooved(world, Lay::along),
                      brushed = grooved(world, Lay::given, unit({1, 1, 0})), plain = lambertian_optic(world, 0.5);
  auto const disk = [&](std::uint32_t optic) {
    return world.add_surface(Disk{{0, 0, 1}, {0, 0, 1}, 0, 1}, optic, optic, body, group);
  };
  auto const tube = [&](std::uint32_t optic) {
    return world.add_surface(Cylinder{{}, {0, 0, 1}, 1, 0, 3}, optic, optic, body, group);
  };
  SurfaceId const faced = disk(turned), brush = disk(brushed), matt = disk(plain), lathe = tube(turned),
                  pipe = tube(drawn);
  world.finish();
  WorldView const view = world.view();
  auto const run = [&](SurfaceId id, Vec3 point, Vec3 travel) {
    Vertex const v = make_vertex(view, id, point, travel);
    EXPECT_NEAR(dot(cross(v.frame.e1, v.frame.e2), v.frame.e3), 1, 1e-12);
    EXPECT_LT(dot(v.frame.e3, travel), 0);
    return v.frame.e2;
  };
  auto const parallel = [](Vec3 a, Vec3 b) { return std::fabs(dot(a, b)) > 1 - 1e-12; };
  for (Vec3 const travel : {Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
    EXPECT_TRUE(parallel(run(faced, {0.3, 0.4, 1}, travel), {-0.8, 0.6, 0}));
    EXPECT_TRUE(parallel(run(brush, {0.3, 0.4, 1}, travel), unit({1, 1, 0})));
    run(faced, {0, 0, 1}, travel);  // no direction in the middle, but a frame
  }
  for (Vec3 const travel : {Vec3{0.6, 0.8, 0}, Vec3{-0.6, -0.8, 0}}) {
    EXPECT_TRUE(parallel(run(lathe, {0.6, 0.8, 2}, travel), {-0.8, 0.6, 0}));
    EXPECT_TRUE(parallel(run(pipe, {0.6, 0.8, 2}, travel), {0, 0, 1}));
  }
  Frame const around = Frame::around({0, 0, -1});
  EXPECT_EQ(make_vertex(view, matt, {0.3, 0.4, 1}, {0, 0, 1}).frame.e1.x, around.e1.x);  // others stay as they are
}

// Light at 75 deg onto a plate, along its grooves: what the energy balance expect is what the samples carry. Control: a
// total that is the mean over the azimuth leaves a mean in `sampling`.
TEST(Lay, EnergyBalanceIncludesTheAzimuth) {
  for (bool const mean_only : {false, true}) {
    World world;
    BodyId const body = world.add_body("all", {});
    std::uint32_t const optic = grooved(world, Lay::given, {1, 0, 0}, mean_only);
    SurfaceId const plate = world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, optic, optic, body, world.add_group("plate"));
    std::uint32_t const wall = lambertian_optic(world, 0.5);
    world.add_surface(Sphere{{}, {0, 0, 1}, 2}, wall, wall, body, world.add_group("wall"));
    world.add_footprint(spot(plate, {}, unit({std::sin(75 * pi / 180), 0, -std::cos(75 * pi / 180)}), Profile::gaussian,
                             0.05, world.add_port("plate")));
    world.limits.max_order = 6;
    world.finish();
    if (mean_only) {
      EXPECT_THROW(run_histories(world, 1 << 19), NumericalError);
      continue;
    }
    BlockSums const total = run_histories(world, 1 << 19).total;
    Estimate const e = estimate(total.energy_balance[int(BalanceTerm::sampling)], total.histories, total.blocks);
    expect_mean("sampling", sample_mean(e, total.histories, double(total.histories) / total.emitted.sum), 0, 1e-2);
  }
}

}  // namespace
}  // namespace straytrace::testing
