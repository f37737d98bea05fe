// SPDX-License-Identifier: BSD-3-Clause
// Variants of the empty tube of E.1: one Lambert scatter on its wall (docs/theory/arm.md eq. 8.9), and
// flat rings of silicon carbide before the mirrors (eq. 8.1).
#include "support/arm_tube.hpp"

namespace straytrace::testing::arm_tube {
namespace {

constexpr double albedo = 0.05;

// Eq. 8.9 with or without the cosines at the two mirrors.
struct Lambert {
  double share = 0;     // of the light scattered out of mirror 1 that arrives on mirror 2
  double coupling = 0;  // f_r
};

// Over the wall, and over mirror 2 ring by ring: what a wall at R_t sends to a mirror of R_m is not that of its axis.
Lambert by_integral(bool cosine_1, bool cosine_2) {
  constexpr int along = 4000, rings = 8, around = 24;
  double const span = std::log(1e7), kappa_s = statistical_kappa(above), kappa = mirror_kappa();
  Lambert sum;
  for (int i = 0; i < along; ++i) {  // midpoints in u = ln(z/(L - z))
    double const u = span * (2 * (i + 0.5) / along - 1), z = arm / (1 + std::exp(-u)), left = arm / (1 + std::exp(u));
    double const dz = z * left / arm * 2 * span / along, l1 = std::hypot(z, tube_radius);
    double const theta1 = std::atan2(tube_radius, z), dtheta1 = tube_radius / (l1 * l1) * dz;
    if (theta1 < above) continue;
    double const lit = kappa_s / (theta1 * theta1) * std::sin(theta1) * dtheta1 * (cosine_1 ? z / l1 : 1);
    for (int a = 0; a < rings; ++a)
      for (int b = 0; b < around; ++b) {
        double const rho = mirror_radius * std::sqrt((a + 0.5) / rings), turn = 2 * pi * (b + 0.5) / around;
        double const x = tube_radius - rho * std::cos(turn),
                     d2 = x * x + std::pow(rho * std::sin(turn), 2) + left * left;
        double const d = std::sqrt(d2), theta2 = std::acos(left / d);
        if (theta2 < above) continue;
        double const sent = albedo / pi * (x / d) / d2 * (cosine_2 ? left / d : 1) / (rings * around);
        sum.share += lit * sent * pi * mirror_radius * mirror_radius;
        sum.coupling += loss * lit * sent * lambda * lambda * kappa / (theta2 * theta2);
      }
  }
  return sum;
}

// Recoupled power and share to 1 %. Eq. 8.9 as it was published has no cosines at the mirrors: 2.7 % each in f_r. The
// share is that of a white mirror 2, which takes light from everywhere alike: f = lambda^2 share/(pi^2 R_m^2).
World lambert_tube(bool white) {
  World world = make({.reflect = 0, .scatter = albedo, .white = white});
  world.limits.max_order = 2;
  world.limits.roulette_below = 0;  // what is aimed carries less, and must not be weeded for it
  AimedWall wall{wall_surface, 2 * pi * tube_radius * arm, {0, 1e-4, 1e-3, 1e-2, 0.1}};
  for (double left : {1500.0, 600.0, 250.0, 100.0, 40.0, 15.0, 6.0, 2.5, 1.0, 0.4, 0.15, 0.0})
    wall.edges.push_back(1 - left / arm);
  world.steer(aimed_walls(world, mirror_1, {wall}));
  return world;
}

TEST(ArmTube, OneLambertScatterEq8_9) {
  char const* const route = "mirror 1·S > wall·S > mirror 2·S";
  Lambert const exact = by_integral(true, true), no_1 = by_integral(false, true), no_2 = by_integral(true, false);
  SampleMean const f = route_coupling(run_histories(lambert_tube(false), 1 << 20), route);
  expect_mean("f_r", f, exact.coupling, 1e-2 * exact.coupling);
  expect_rejected("without the cosine at mirror 1", f, no_1.coupling);
  expect_rejected("without the cosine at mirror 2", f, no_2.coupling);
  SampleMean const share = scaled(route_coupling(run_histories(lambert_tube(true), 1 << 20), route),
                                  std::pow(pi * mirror_radius / lambda, 2) / loss);
  expect_mean("share", share, exact.share, 1e-2 * exact.share);
  expect_rejected("share without the cosine at mirror 2", share, no_2.share);
}

// Of the light scattered out of mirror 1, what arrives on a surface as the given event of its path.
SampleMean arriving(World const& world, SurfaceId where, std::uint32_t order) {
  struct Arrivals : Silent {
    SurfaceId where;
    std::uint32_t order;
    double now = 0;
    Arrivals(SurfaceId w, std::uint32_t o) : where(w), order(o) {}
    void visit(PathState const& path, Vertex const& v) {
      if (v.surface == where && path.order == order) now += path.power / loss;
    }
  } seen(where, order);
  Sampler found;
  walk(world, 1 << 20, seen, [&] {
    found.add(seen.now);
    seen.now = 0;
  });
  return found.mean();
}

// Rings of 0.176 to 0.4 m a centimetre before each mirror. The far one is lit by mirror 1 between 59 and
// 133 urad; kappa_s ln(r_2/r_1) of the light meets it, and S/pi of that per sr goes straight back (eq. 8.1, 8.2):
// K = pi kappa^2/l^2 (theta_1^-2 - theta_2^-2). Its phase sensitivity along the axis is 2k: 1 um at 100 Hz wraps to
// 1181 Hz.
TEST(ArmTube, FarRingOfSiliconCarbideE1) {
  World world = make({.rings = true});
  world.steer(aimed_walls(world, mirror_1, {{ring_2, pi * (0.4 * 0.4 - 0.176 * 0.176), {0, 0.1, 0.4, 1}}}));
  TraceResult const r = run_histories(world, 1 << 19);
  double const l = arm - 0.01, low = std::atan(0.176 / l), high = std::atan(0.4 / l), kappa = mirror_kappa();
  double const beta = 5e-5 / pi;
  double const back = lambda * lambda * beta * pi * kappa * kappa / (l * l) * (1 / (low * low) - 1 / (high * high));
  SampleMean const f = route_coupling(r, "mirror 1·S > ring 2·S > mirror 1·S");
  expect_mean("f_r of the far ring", f, back, 2e-2 * back);
  expect_rejected("ring from 0.178 m on", f,
                  back * (1 / std::pow(0.178, 2) - 1 / 0.16) / (1 / std::pow(0.176, 2) - 1 / 0.16));
  CouplingClass const* c = find_route(r, "mirror 1·S > ring 2·S > mirror 1·S");
  ASSERT_NE(c, nullptr);
  EXPECT_EQ(c->reverse, 2);
  for (PathRecord const& p : c->records)
    for (PhaseSensitivity const& phase_sensitivity : p.phase_sensitivities)
      if (world.bodies()[phase_sensitivity.body.value].name == "rings") {
        EXPECT_NEAR(phase_sensitivity.d[2], 2 * k, 1e-8 * 2 * k);
      }
  EXPECT_NEAR(2 * k * 1e-6 * 100, 1181.05, 0.01);  // Hz, eq. 7.2
  SampleMean const share = arriving(world, ring_2, 1);
  double const lit = statistical_kappa(above) * std::log(0.4 / 0.176);
  expect_mean("share on the far ring", share, lit, 1e-2 * lit);
  expect_rejected("ring up to 0.405 m", share, statistical_kappa(above) * std::log(0.405 / 0.176));
}

}  // namespace
}  // namespace straytrace::testing::arm_tube
