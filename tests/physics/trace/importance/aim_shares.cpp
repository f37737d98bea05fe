// SPDX-License-Identifier: BSD-3-Clause
// How often sub-paths of a receiver aim at each mirror that it sees (docs/theory/sampling.md, eq. 1.28 and 1.29).
#include <gtest/gtest.h>

#include "support/trace_received.hpp"

namespace straytrace::testing::trace_aim_shares {
namespace {

constexpr double rho = 0.8, radius = 0.01;  // of the card; m, of the receiver

// Discs of one body, black behind.
struct Discs {
  World& world;
  BodyId body = world.add_body("all", {});
  std::uint32_t black = black_optic(world);
  SurfaceId operator()(char const* name, Vec3 at, Vec3 facing, double size, std::uint32_t front) const {
    return world.add_surface(disk(0, size, {at, unit(facing)}), front, black, body, world.add_group(name));
  }
};

// A laser lights a white card, straight or by way of another one. A mirror shows it to a receiver from which screens
// hide both, another mirror shows a card that no light reaches.
struct Layout {
  bool indirect = false;
  bool both_sides = false;  // of the receiver count
};
World two_mirrors(Layout const& s) {
  World world;
  Discs const disc{world};
  std::uint32_t const silver = mirror_optic(world, 0.9), white = lambertian_optic(world, rho);
  disc("card", {}, {1, 0, 1}, 0.03, white);
  disc("mirror", {0.2, 0, 0}, {-1, 0, 1}, 0.03, silver);
  disc("screen", {0.1, 0, 0.1}, {1, 0, 1}, 0.05, disc.black);
  disc("dark card", {0.6, 0, 0}, {-1, 0, 1}, 0.03, white);
  disc("dark mirror", {0.3, 0, 0}, {0.553, 0, 0.894}, 0.03, silver);
  receive_on(world, "eye", disc("eye", {0.2, 0, 0.2}, {0, 0, -1}, radius, disc.black), true, s.both_sides);
  GroupId const laser = world.add_group("laser");
  if (s.indirect) {
    disc("first card", {0, 0.2, 0.1}, {0, -1, 0.3}, 0.05, white);
    disc("other screen", {0.1, 0.1, 0.15}, {-2, 2, -1}, 0.05, disc.black);
    world.add_footprint(free_beam(laser, {0, 0.1, 0.3}, unit({0, 1, -2}), Profile::even, 0.02));
  } else {
    world.add_footprint(free_beam(laser, {0, 0, 0.3}, {0, 0, -1}, Profile::even, 0.02));
  }
  world.limits.roulette_below = 0;
  world.finish();
  find_covered_receivers(world);
  EXPECT_EQ(world.receivers()[0].aims, 2u);
  return world;
}
std::size_t bright(Receiver const& eye) { return eye.aim[1].surface.value == 1 ? 1 : 0; }

// With any shares the mirror brings rho R cos A/(pi d^2), d = 0.4 m, cos = 1/sqrt(2) at the card.
TEST(AimShares, DoNotChangeTheLight) {
  double const expected = rho * 0.9 * std::sqrt(0.5) * radius * radius / 0.16;
  for (bool const both : {false, true})
    for (auto const& [to_bright, to_dark] : {std::pair{0.7, 0.02}, {0.3, 0.6}, {0.25, 0.0}, {1.0, 0.0}}) {
      World world = two_mirrors({.both_sides = both});
      std::size_t const first = bright(world.receivers()[0]);
      double shares[2];
      shares[first] = to_bright;
      shares[1 - first] = to_dark;
      world.set_aim_shares(0, shares);
      SampleMean const w = received(run_histories(world, 1 << 17));
      expect_mean("mirror", w, expected, 0.15 * expected);
      expect_rejected("shares taken for equal ones", w, expected * to_bright / (Receiver::most_aimed / 2));
    }
}

// The mirror that brings light takes what the least shares of the others leave.
TEST(AimShares, FollowTheLight) {
  World world = two_mirrors({.indirect = true});
  Receiver const& eye = world.receivers()[0];
  std::size_t const first = bright(eye);
  EXPECT_EQ(eye.aim[0].share, Receiver::most_aimed / 2);
  EXPECT_EQ(eye.aim[1].share, Receiver::most_aimed / 2);
  choose_aim_shares(world);
  EXPECT_NEAR(eye.aim[first].share, 0.75 - 0.125, 0.02);
  EXPECT_NEAR(eye.aim[1 - first].share, 0.125, 0.02);
  EXPECT_NEAR(eye.cosine_share, 0.25, 0.02);
  EXPECT_NEAR(eye.cosine_share + eye.aim[0].share + eye.aim[1].share, 1, 1e-15);
}
// A spot of a beam on the card may be so small that a short run misses it.
TEST(AimShares, StayEqualWhereAMirrorShowsABeam) {
  World world = two_mirrors({});
  Receiver const& eye = world.receivers()[0];
  std::size_t const first = bright(eye);
  EXPECT_TRUE(eye.aim[first].shows_beam);
  EXPECT_FALSE(eye.aim[1 - first].shows_beam);
  choose_aim_shares(world);
  EXPECT_GE(eye.aim[first].share, Receiver::most_aimed / 2);
}

// A receiver faces the wall of a white sphere. In a small mirror it sees another part of the wall, as bright as the
// rest.
SampleMean in_sphere(bool chosen) {
  World world;
  Discs const disc{world};
  std::uint32_t const white = lambertian_optic(world, 0.5);
  world.add_surface(sphere(1), white, white, disc.body, world.add_group("wall"));
  disc("card", {0.5, 0, 0}, {-1, 0, 0}, 0.1, white);
  disc("mirror", {0.05, 0, -0.95}, {-0.5, 0, 0.3}, 0.01, mirror_optic(world, 0.9));
  receive_on(world, "eye", disc("eye", {0, 0, -0.9}, {0, 0, -1}, 0.02, disc.black));
  world.add_footprint(free_beam(world.add_group("laser"), {}, {1, 0, 0}, Profile::even, 3e-3));
  world.limits.max_order = 12;
  world.finish();
  find_covered_receivers(world);
  EXPECT_EQ(world.receivers()[0].aims, 1u);
  if (chosen) choose_aim_shares(world);
  EXPECT_NEAR(world.receivers()[0].aim[0].share, chosen ? 0.25 : 0.75, 0.02);
  return received(run_histories(world, 1 << 18));
}
TEST(AimShares, AreSmallWhereMirrorsBringLittle) {
  SampleMean const chosen = in_sphere(true), equal = in_sphere(false);
  expect_mean("same light", difference(chosen, equal), 0, 0.05 * equal.mean);
  EXPECT_LT(chosen.std_error * chosen.std_error, 0.3 * equal.std_error * equal.std_error);
}

}  // namespace
}  // namespace straytrace::testing::trace_aim_shares
