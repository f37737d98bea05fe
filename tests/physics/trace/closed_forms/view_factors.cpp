// SPDX-License-Identifier: BSD-3-Clause
// View factors (case A18; docs/theory/sampling.md): by walking, from an evenly lit Lambertian disc, and by the
// coupling between two evenly lit discs, which is the same integral (eq. 1.2):
//   f = lambda^2 (rho_1/pi) (rho_2/pi) int int G dA dA/(A_1 A_2) = lambda^2 rho_1 rho_2 F_12/(pi A_2).
#include <random>

#include "support/trace_support.hpp"

namespace straytrace::testing::trace_view_factors {
namespace {

struct Pair {
  double near, far, distance, hole = 0;  // radii of the coaxial discs, m; inner radius of the far one
};

// Two coaxial Lambertian discs, reflectance 1, both lit evenly; only the near one emits.
World discs(Pair const& p) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 1), black = black_optic(world);
  SurfaceId const low = world.add_surface(Disk{{}, {0, 0, 1}, 0, p.near}, white, black, body, world.add_group("near"));
  SurfaceId const high = world.add_surface(Disk{{0, 0, p.distance}, {0, 0, -1}, p.hole, p.far}, white, black, body,
                                           world.add_group("far"));
  world.add_footprint(spot(low, {}, {0, 0, -1}, Profile::even, p.near));
  Footprint receiver = spot(high, {0, 0, p.distance}, {0, 0, 1}, Profile::even, p.far, world.add_port("far"), 1);
  receiver.emits = false;
  world.add_footprint(receiver);
  world.limits.max_order = 1;
  world.finish();
  return world;
}

struct Seen {
  SampleMean walked, coupled;
};
Seen view_factor(Pair const& p, std::uint64_t histories) {
  World world = discs(p);
  TraceResult const r = run_histories(world, histories);
  double const l2 = world.wavelength * world.wavelength;
  return {arrived(world, r, "far"), scaled(route_coupling(r, "near·S > far·S"), pi * pi * p.far * p.far / l2)};
}

// Coaxial discs, r1 -> r2 at distance h.
double coaxial(double r1, double r2, double h) {
  double const a = h * h + r1 * r1 + r2 * r2, root = std::sqrt(a * a - 4 * r1 * r1 * r2 * r2);
  return 2 * r2 * r2 / (a + root);  // = (a - root)/(2 r1^2) without its cancellation
}

TEST(ViewFactors, ClosedForms) {
  EXPECT_NEAR(coaxial(1, 1, 2), 0.1715729, 5e-8);
  EXPECT_NEAR(coaxial(1, 1, 1), 0.3819660, 5e-8);
  EXPECT_NEAR(coaxial(0.175, 0.6, 10), 3.585996e-3, 5e-10);
  EXPECT_NEAR(coaxial(0.17, 0.17, 3994.5), 1.811227e-9, 5e-16);
  EXPECT_NEAR(coaxial(0.31, 0.31, 1e4), 9.6100e-10, 5e-15);
  EXPECT_NEAR(coaxial(0.17, 0.6, 100) - coaxial(0.17, 0.5, 100), 1.09993e-5, 5e-11);
}

TEST(ViewFactors, CoaxialDiscsA18) {
  Seen const two = view_factor({1, 1, 2}, 1 << 20), one = view_factor({1, 1, 1}, 1 << 20);
  expect_mean("r 1, h 2, walked", two.walked, 0.1715729, 3e-3);
  expect_mean("r 1, h 2, coupled", two.coupled, 0.1715729, 1e-3);
  expect_mean("r 1, h 1, walked", one.walked, 0.3819660, 4e-3);
  expect_mean("r 1, h 1, coupled", one.coupled, 0.3819660, 2e-3);
  // control: discs 1 % further apart
  expect_rejected("r 1, h 1.01", one.walked, coaxial(1, 1, 1.01));
  expect_rejected("r 1, h 2.02", two.coupled, coaxial(1, 1, 2.02));
}

TEST(ViewFactors, SmallToLargeDiscA18) {
  Seen const s = view_factor({0.175, 0.6, 10}, 1 << 20);
  expect_mean("walked", s.walked, 3.585996e-3, 5e-4);
  expect_mean("coupled", s.coupled, 3.585996e-3, 4e-6);
  expect_rejected("without the cosines of the receiver", s.coupled, 3.585996e-3 * (1 + 0.18 / 100));
}

// docs/theory/sampling.md: no walk would ever find these.
TEST(ViewFactors, RareOnesByConnection) {
  for (Pair const& p :
       {Pair{0.17, 0.17, 3994.5}, Pair{0.31, 0.31, 1e4}}) {  // every connection is worth the same to 1e-8
    double const expected = coaxial(p.near, p.far, p.distance);
    EXPECT_NEAR(view_factor(p, 1 << 17).coupled.mean, expected, 1e-7 * expected);
    EXPECT_GT(std::fabs(coaxial(p.near, p.far, 1.000001 * p.distance) - expected), 1e-7 * expected);  // control: 1 ppm
  }
  SampleMean const ring = view_factor({0.17, 0.6, 100, 0.5}, 1 << 20).coupled;
  expect_mean("ring", ring, 1.09993e-5, 2e-7);
  expect_rejected("the whole disc instead of the ring", ring, coaxial(0.17, 0.6, 100));
}

// C2.5: a sensor of radius 5 mm at 0.5 m on axis gets 1.0e-4 of Lambertian light; directions drawn evenly in solid
// angle would give it half.
TEST(ViewFactors, SmallSensorOnAxisC2_5) {
  SampleMean const s = view_factor({1e-3, 5e-3, 0.5}, 1 << 17).coupled;
  double const expected = coaxial(1e-3, 5e-3, 0.5);
  EXPECT_NEAR(expected, 1.0e-4, 5e-8);
  expect_mean("sensor", s, expected, 1e-3 * expected);
  expect_rejected("even in solid angle", s, 5.0e-5);
}

// Wall of a unit cylinder of height h to itself, by paths started evenly on the wall. `power` turns what the sink sees
// into the weight that is counted: 1 for the truth.
template <class Weight>
SampleMean wall_to_itself(double h, std::uint64_t histories, Weight&& weight) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 1), black = black_optic(world);
  Cylinder const tube{{}, {0, 0, 1}, 1, 0, h};
  SurfaceId const wall = world.add_surface(tube, black, white, body, world.add_group("wall"));
  world.finish();
  WorldView const view = world.view();
  Silent silent;
  Sampler found;
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> uniform;
  for (std::uint64_t i = 0; i < histories; ++i) {
    PathState path;
    double const u = uniform(engine), v = uniform(engine);
    Vec3 const start = tube.sample(u, v), outward = tube.normal(start);
    launch(view, 1, i, wall, start, outward, path, silent);
    path.power *= finish_hop_weight(view, path, nullptr);
    bool const hit = view.closest(path.ray, path.from).surface.valid();
    found.add(hit ? path.power * weight(-dot(path.ray.dir, outward)) : 0);
  }
  return found.mean();
}

TEST(ViewFactors, CylinderWallToItself) {
  auto const truth = [](double) { return 1.0; };
  expect_mean("H = 0.5", wall_to_itself(1, 1 << 20, truth), 0.381966, 4e-3);
  expect_mean("H = 1", wall_to_itself(2, 1 << 20, truth), 0.585786, 4e-3);
  // control: directions uniform in solid angle, a density without its cosine (C2.5)
  expect_rejected("no cosine", wall_to_itself(1, 1 << 18, [](double cosine) { return 0.5 / cosine; }), 0.381966);
}

}  // namespace
}  // namespace straytrace::testing::trace_view_factors
