// SPDX-License-Identifier: BSD-3-Clause
// How often sub-paths of a receiver aim at each mirror that it sees (docs/theory/sampling.md, eq. 1.28 and 1.29).
#include <gtest/gtest.h>

#include "support/trace_received.hpp"

namespace straytrace::testing::trace_aim_shares {
namespace {

// A laser lights a white card. A mirror shows it to a receiver from which a screen hides it, another mirror shows a
// card that no light reaches.
World two_mirrors() {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), silver = mirror_optic(world, 0.9),
                      white = lambertian_optic(world, 0.8);
  auto const disc = [&](char const* name, Vec3 at, Vec3 facing, double radius, std::uint32_t front) {
    return world.add_surface(disk(0, radius, {at, unit(facing)}), front, black, body, world.add_group(name));
  };
  disc("card", {}, {1, 0, 1}, 0.03, white);
  disc("mirror", {0.2, 0, 0}, {-1, 0, 1}, 0.03, silver);
  disc("screen", {0.1, 0, 0.1}, {1, 0, 1}, 0.05, black);
  disc("dark card", {0.6, 0, 0}, {-1, 0, 1}, 0.03, white);
  disc("dark mirror", {0.3, 0, 0}, {0.553, 0, 0.894}, 0.03, silver);
  receive_on(world, "eye", disc("eye", {0.2, 0, 0.2}, {0, 0, -1}, 0.02, black));
  world.add_footprint(free_beam(world.add_group("laser"), {0, 0, 0.3}, {0, 0, -1}, Profile::even, 0.02));
  world.finish();
  find_covered_receivers(world);
  return world;
}
TEST(AimShares, GoToTheMirrorThatBringsTheLight) {
  World world = two_mirrors();
  Receiver const& eye = world.receivers()[0];
  ASSERT_EQ(eye.aims, 2u);
  EXPECT_EQ(eye.aim_share[0], Receiver::most_aimed / 2);
  EXPECT_EQ(eye.aim_share[1], Receiver::most_aimed / 2);
  choose_aim_shares(world);
  bool const second = eye.aim[1].value == 1;  // the number of the mirror
  EXPECT_GT(eye.aim_share[second], 0.7);
  EXPECT_LT(eye.aim_share[!second], 0.03);
  EXPECT_NEAR(eye.cosine_share + eye.aim_share[0] + eye.aim_share[1], 1, 1e-15);
}

// A white sphere, lit on one side, with a receiver near its wall that sees a hundredth of it in a small mirror.
World sphere_with_mirror() {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), white = lambertian_optic(world, 0.5);
  world.add_surface(sphere(1), white, white, body, world.add_group("wall"));
  world.add_surface(disk(0, 0.05, {{0.3, 0, -0.6}, unit({-0.2, 0, -1})}), mirror_optic(world, 0.9), black, body,
                    world.add_group("mirror"));
  receive_on(world, "eye",
             world.add_surface(disk(0, 0.02, {{0, 0, -0.9}}), black, black, body, world.add_group("eye")));
  world.add_footprint(free_beam(world.add_group("laser"), {}, {1, 0, 0}, Profile::even, 3e-3));
  world.limits.max_order = 12;
  world.finish();
  find_covered_receivers(world);
  return world;
}
SampleMean watts_in_sphere(bool chosen) {
  World world = sphere_with_mirror();
  Receiver const& eye = world.receivers()[0];
  EXPECT_EQ(eye.aims, 1u);
  if (chosen) choose_aim_shares(world);
  EXPECT_EQ(eye.aim_share[0] < 0.1, chosen) << eye.aim_share[0];
  return received(run_histories(world, 1 << 17));
}
TEST(AimShares, AreSmallWhereMirrorsBringLittle) {
  SampleMean const chosen = watts_in_sphere(true), equal = watts_in_sphere(false);
  expect_mean("same light", difference(chosen, equal), 0, 0.02 * equal.mean);
  EXPECT_LT(chosen.std_error * chosen.std_error, 0.5 * equal.std_error * equal.std_error);
}

}  // namespace
}  // namespace straytrace::testing::trace_aim_shares
