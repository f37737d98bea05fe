// SPDX-License-Identifier: BSD-3-Clause
// Ghosts that rims cut, and ghosts of what mounts reflect (docs/theory/ghosts.md, Screens; eq. 5.5, N.11).
#include <gtest/gtest.h>

#include "support/ghost_support.hpp"
#include "support/recorded.hpp"

namespace straytrace::testing::cut_ghosts {
namespace {

constexpr double w = 5e-3;

// A window without coating, a hole in a mount, and a plate, across or at an angle to a beam along z.
struct Bench {
  double hole = w, reflect = 0, tilt = 0, mirror = 0;
};
World bench(Bench const& b) {
  World world;
  world.wavelength = lambda;
  std::uint32_t const clear = coated(world, 0), plate = coated(world, b.mirror), mount = coated(world, b.reflect),
                      black = black_optic(world);
  BodyId const body = world.add_body("all", {});
  world.add_surface(disk(0, 1, {{0, 0, -0.5}, {0, 0, -1}}), clear, clear, body, world.add_group("window"));
  world.add_surface(disk(b.hole, 1, {{}, {std::sin(b.tilt), 0, -std::cos(b.tilt)}}), b.reflect > 0 ? mount : black,
                    black, body, world.add_group("mount"));
  world.add_surface(disk(0, 1, {{0, 0, 0.5}, {0, 0, -1}}), plate, plate, body, world.add_group("mirror"));
  world.finish();
  return world;
}

double passed(double hole) { return -std::expm1(-2 * hole * hole / (w * w)); }

// What the mount takes of the beam and reflects is a ghost of that power; the balance closes (R2.24).
TEST(CutGhosts, mount_reflects) {
  for (double const reflect : {0.5, 0.02}) {
    World const world = bench({.reflect = reflect});
    BeamEnergyBalance balance;
    std::vector<Row> const all = rows(world, launched(world, w), {1e-15}, &balance);
    Row const& ghost = of_order(all, 1, false);
    double const taken = 1 - passed(w);
    EXPECT_NEAR(ghost.power / (reflect * taken), 1, 1e-3);
    EXPECT_EQ(ghost.way.back().surface.value, 0u);  // back through the window
    EXPECT_NEAR(balance.objects[1].landed / ((1 - reflect) * taken), 1, 1e-3);
    EXPECT_NEAR(balance.total(), 1, 1e-12);
    EXPECT_GT(std::fabs(balance.total() - ghost.power - 1), 1e-3) << "control: without the ghost";
  }
  std::vector<Row> const none = rows(bench({}), launched(bench({}), w));
  EXPECT_TRUE(std::ranges::none_of(none, [](Row const& r) { return r.order > 0; })) << "control: a black mount";
}

TEST(CutGhosts, tilted_mount_sends_it_aside) {
  World const world = bench({.reflect = 1, .tilt = pi / 4});
  std::vector<Row> const all = rows(world, launched(world, w));
  auto const ghost = std::ranges::find(all, 1u, &Row::order);
  ASSERT_NE(ghost, all.end());
  EXPECT_NEAR(ghost->mode.travel.x, 1, 1e-12);
  EXPECT_EQ(ghost->end, BeamEnd::escaped);
}

// Field (1 - K) u: the mode of the beam is in it with the amplitude 1 - K_00, though its power is 1 - K_00.
TEST(CutGhosts, light_that_a_mount_sends_back_into_the_beam) {
  constexpr double reflect = 0.5;
  World const world = bench({.reflect = reflect});
  std::vector<Row> const all = rows(world, launched(world, w));
  Recoupling const& r = of_order(all, 1, false).standing.recoupled;
  ASSERT_TRUE(r.any && r.against);
  double const taken = 1 - passed(w);
  EXPECT_NEAR(r.share() / (reflect * taken * taken), 1, 2e-3);
  EXPECT_GT(r.share() / (reflect * taken), 0.1);
  EXPECT_LT(r.share() / (reflect * taken), 0.2) << "control: its power in the mode";
}

// A ghost of a mirror behind the hole, back through it: the hole is near, and its sharp shadow cuts but once, K^2 = K.
TEST(CutGhosts, hole_passed_twice) {
  constexpr double reflect = 1e-4;
  World const world = bench({.hole = 0.8 * w, .mirror = reflect});
  std::vector<Row> const all = rows(world, launched(world, w));
  Row const& ghost = of_order(all, 1, false);
  double const k = passed(0.8 * w);
  EXPECT_NEAR(ghost.power / (reflect * k * k), 1, 1e-3);
  EXPECT_NEAR(ghost.standing.recoupled.share() / (reflect * k * k), 1, 2e-3);
  EXPECT_GT(ghost.standing.recoupled.share() / (reflect * std::pow(k, 4)), 1.5) << "control: cut twice";
}

// A convex mirror sends back a ghost that is three times as wide at the hole as the main beam, and a plate sends it on
// with that. The field in the mode is the integral of u_heard* u_ghost over the hole (eq. 5.7, N.11), here by a sum
// over rings.
TEST(CutGhosts, wide_ghost_and_narrow_mode) {
  constexpr double plate = 0, hole = 0.2, mirror = 0.5, start = -0.1, radius = 2.8e-3, narrow = 1e-3, roc = 0.3;
  auto const share = [&](bool cut) {
    World world;
    world.wavelength = lambda;
    std::uint32_t const weak = coated(world, 1e-3), black = black_optic(world);
    BodyId const body = world.add_body("all", {});
    world.add_surface(disk(0, 1, {{0, 0, plate}, {0, 0, -1}}), weak, weak, body, world.add_group("plate"));
    world.add_surface(cap(-1 / roc, 0, 0.1, {{0, 0, mirror}, {0, 0, -1}}), weak, weak, body, world.add_group("mirror"));
    if (cut)
      world.add_surface(disk(radius, 1, {{0, 0, hole}, {0, 0, -1}}), black, black, body, world.add_group("stop"));
    world.finish();
    for (Row const& r : rows(world, launched(world, narrow, {0, 0, start}), {1e-15, 2}))
      if (r.order == 2 && r.standing.recoupled.any && !r.standing.recoupled.against)
        return r.standing.recoupled.share();
    return 0.0;
  };
  auto const q = [](double w, double curvature) { return Amplitude(curvature, lambda / (pi * w * w)); };
  auto const after = [](Amplitude x, double z) { return x / (1.0 + z * x); };
  Amplitude const launch = q(narrow, 0), back = after(after(launch, mirror - start) + 2 / roc, mirror - hole),
                  heard = after(launch, plate - start - (hole - plate));
  double const k = 2 * pi / lambda, w_ghost = std::sqrt(lambda / (pi * back.imag()));
  EXPECT_NEAR(w_ghost / narrow, 3, 0.2);
  auto const rings = [&](double to) {
    Amplitude sum = 0;
    double const step = 1e-7;
    for (double r = step / 2; r < to; r += step)
      sum += step * r * std::exp(Amplitude(0, k / 2) * (back - std::conj(heard)) * r * r);
    return sum;
  };
  double const exact = std::norm(rings(radius) / rings(20e-3)), found = share(true) / share(false);
  EXPECT_NEAR(found / exact, 1, 2e-3);
  double const passed_power = -std::expm1(-2 * radius * radius / (w_ghost * w_ghost));
  EXPECT_GT(found / passed_power, 1.1) << "control: by the power that passes";
}

}  // namespace
}  // namespace straytrace::testing::cut_ghosts
