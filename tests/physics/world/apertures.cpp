// SPDX-License-Identifier: BSD-3-Clause
// The rims that main beams pass, at any angle and for elliptic beams (docs/theory/beams.md, eq. 5.5 to 5.7, R2.26).
#include "world/ghosts/apertures.hpp"

#include <gtest/gtest.h>

#include "beams/overlap.hpp"
#include "support/ghost_support.hpp"
#include "world/ghosts/obstacle.hpp"

namespace straytrace::testing::world_apertures {
namespace {

constexpr double w = 5e-3;

// A free beam along z, and a curved mirror at 60 degrees that sends it through a hole across it, far away.
struct Bench {
  double tilt = pi / 3, mirror = 2 * w, hole = 3 * w, roc = 2;
};
World bench(Bench const& b) {
  World world;
  world.wavelength = lambda;
  std::uint32_t const silver = mirror_optic(world, 1), black = black_optic(world);
  BodyId const body = world.add_body("all", {});
  Vec3 const normal{std::sin(b.tilt), 0, -std::cos(b.tilt)}, on = reflected(Vec3{0, 0, 1}, normal);
  world.add_surface(cap(1 / b.roc, 0, b.mirror, {{}, normal}), silver, silver, body, world.add_group("mirror"));
  world.add_surface(disk(b.hole, 1, {0.5 * on, on}), black, black, body, world.add_group("screen"));
  world.add_surface(disk(0, 1, {1.0 * on, -on}), black, black, body, world.add_group("end"));
  Footprint f = free_beam(world.add_group("beam"), {0, 0, -1}, {0, 0, 1}, Profile::gaussian, w);
  f.index = 1;
  world.add_footprint(f);
  world.finish();
  return world;
}
BeamAperture const& on(std::vector<BeamAperture> const& all, std::uint32_t surface) {
  for (BeamAperture const& a : all)
    if (a.surface.value == surface) return a;
  ADD_FAILURE() << "no rim of surface " << surface;
  return all.front();
}

// The rim of a mirror at 60 degrees is an ellipse of half the width for the beam, though its sagitta moves its plane.
TEST(Apertures, rim_of_a_tilted_mirror) {
  World const world = bench({});
  auto const all = apertures_of(world);
  BeamAperture const& a = on(all, 0);
  double const at = w * std::sqrt(1 + std::pow(lambda / (pi * w * w), 2));
  Mode const mode = circular_mode({}, {0, 0, 1}, at, 0, lambda);
  Vec3 const normal{std::sin(pi / 3), 0, -0.5};
  double const sag = 2 - std::sqrt(4 - 4 * w * w);
  double const exact = clipped_share(Aperture{sag * normal, normal, 2 * w}, mode);
  EXPECT_NEAR(a.clipped / exact, 1, 1e-6);
  EXPECT_GT(a.clipped, 0.0455);  // of a slit of +-w alone
  EXPECT_LT(a.clipped, 0.0455 + 0.01);
  EXPECT_NEAR(a.tilt, pi / 3, 1e-12);
  EXPECT_TRUE(a.reflected && !a.across);
  EXPECT_GT(exact / clipped_share(2 * w, at), 50);  // control: as across the beam
  EXPECT_NEAR(a.clipped, beside_rim(world.view(), {0}, mode), 1e-6 * exact);
}

// Behind it the beam is elliptic; the hole that the chief ray passes is listed, with eq. 5.5 for each axis.
TEST(Apertures, holes_behind_an_elliptic_beam) {
  World const world = bench({});
  auto const all = apertures_of(world);
  BeamAperture const& a = on(all, 1);
  EXPECT_GT(a.w_major / a.w_minor, 1.2);
  EXPECT_NEAR(a.along, 1.5, 1e-12);
  double const exact = clipped_share(3 * w, {a.w_major, a.w_minor}, {0, 0});
  EXPECT_NEAR(a.clipped / exact, 1, 1e-6);
  double const field = clipped_share(3 * w, {std::sqrt(2) * a.w_major, std::sqrt(2) * a.w_minor}, {0, 0});
  EXPECT_NEAR(a.axis_far, (1 - field) * (1 - field), 1e-6);
  double const mean = std::sqrt(a.w_major * a.w_minor);
  EXPECT_GT(std::fabs(clipped_share(3 * w, mean) / exact - 1), 0.1);  // control: as a round beam
}

// A round hole across a round beam: closed forms, and the numbers of the command for --profile.
TEST(Apertures, agree_with_the_closed_forms) {
  World const world = bench({0, 8 * w, pi / 2 * w, 1e6});
  auto const all = apertures_of(world);
  BeamAperture const& hole = on(all, 1);
  EXPECT_TRUE(hole.across);
  double const edge = std::exp(-std::pow(pi / 2 * w / hole.w_major, 2));
  EXPECT_NEAR(hole.clipped, edge * edge, 1e-9);
  EXPECT_NEAR(hole.axis_far, (1 - edge) * (1 - edge), 1e-9);
  EXPECT_NEAR(hole.ripple, 2 * edge, 1e-9);
  BeamInPlane const flat{hole.at.w, 0, hole.at.wavelength};
  double const far = 1e7;
  auto const ratio = field_behind(flat, hole.opening, far, 0, 0) / free_field(flat, far, 0, 0);
  EXPECT_NEAR(hole.axis_far, std::norm(ratio), 1e-6);
  EXPECT_NEAR(hole.axis_far, 0.8376, 1e-3);
}

TEST(Apertures, losses_of_the_main_beam_are_named) {
  auto const none = main_losses(bench({pi / 3, 20 * w, 5 * w, 1e6}));
  EXPECT_TRUE(none.empty());
  auto const both = main_losses(bench({pi / 3, 2 * w, 1.2 * w, 1e6}));
  ASSERT_EQ(both.size(), 2u);
  EXPECT_TRUE(both[0].beside && both[0].surface.value == 0);
  EXPECT_TRUE(!both[1].beside && both[1].surface.value == 1);
  EXPECT_LT(both[1].share, 0.9 * std::exp(-2 * 1.44));  // partly in the shadow of the mirror's rim
  auto const hole = main_losses(bench({pi / 3, 20 * w, 1.2 * w, 1e6}));
  ASSERT_EQ(hole.size(), 1u);
  EXPECT_NEAR(hole[0].share, std::exp(-2 * 1.44), 1e-3);
  EXPECT_EQ(main_losses(bench({pi / 3, 2 * w, 1.2 * w, 1e6}), 0.2).size(), 0u);  // control: a share that neither has
}

}  // namespace
}  // namespace straytrace::testing::world_apertures
