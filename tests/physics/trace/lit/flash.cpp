// SPDX-License-Identifier: BSD-3-Clause
// The flash camera (R3.36) against closed forms of radiometry.
#include "support/trace_support.hpp"
#include "trace/camera/camera.hpp"

namespace straytrace::testing::trace_flash {
namespace {

// A disc of 1 m at z = 2, whose normal is tilted by `tilt` from the line of sight; the eye is at the origin.
World disc_of(double reflect, double albedo, double tilt) {
  World world;
  Optic optic;
  optic.reflect = reflect;
  if (albedo > 0) {
    optic.laws = 1;
    optic.law[0] = world.add_law(Lambertian{albedo});
  }
  std::uint32_t const id = world.add_optic(optic);
  world.add_surface(Disk{{0, 0, 2}, {0, std::sin(tilt), -std::cos(tilt)}, 0, 1}, id, id, world.add_body("b", {}),
                    world.add_group("disc"));
  world.finish();
  return world;
}

Camera const camera = looking_at({}, {0, 0, 1}, {0, 1, 0}, 2 * degree, 101, 101);

// Irradiance at the eye over the intensity of the flash, 1/m^2: sum of radiance times solid angle.
double back_at_the_eye(World const& world, Flash const& flash, Camera const& c) {
  auto const picture = flash_picture(world.view(), c, flash, {});
  double sum = 0;
  for (std::uint32_t row = 0; row < c.rows; ++row)
    for (std::uint32_t column = 0; column < c.columns; ++column)
      sum += picture[std::size_t{row} * c.columns + column].glint * solid_angle(c, column, row);
  return sum;
}

// Lambertian disc: I cos(theta)/d^2 falls on it, and albedo/pi of that comes back per sr.
TEST(Flash, LambertianDiscAtAnAngle) {
  for (double const tilt : {0.0, 30 * degree, 60 * degree}) {
    World const world = disc_of(0, 0.4, tilt);
    FlashLight const seen = flash_along(world.view(), {{}, {0, 0, 1}}, {}, {}, {}, {});
    double const expected = 0.4 / pi * std::cos(tilt) / 4;
    EXPECT_NEAR(seen.scattered / expected, 1, 1e-12);
    EXPECT_EQ(seen.glint, 0);
    if (tilt > 0) {
      EXPECT_GT(std::fabs(seen.scattered * std::cos(tilt) / expected - 1), 0.1) << "control: the cosine twice";
    }
  }
}

// A mirror at d perpendicular to the line of sight shows the flash as a disc of the angle r/(2d), with the radiance of
// the flash times R. Leaning by more than that, it shows nothing where it is looked at, and 1/2 of the way it leans
// everything.
TEST(Flash, GlintOfAFlatMirror) {
  Flash const flash{.radius = 20e-3};
  double const d = 2, half_angle = flash.radius / (2 * d), radiance = 0.9 / (pi * flash.radius * flash.radius);
  World const straight = disc_of(0.9, 0, 0);
  auto const glint = [&](World const& world, double angle) {
    return flash_along(world.view(), {{}, {0, std::sin(angle), std::cos(angle)}}, {}, {}, flash, {}).glint;
  };
  EXPECT_NEAR(glint(straight, 0.99 * half_angle) / radiance, 1, 1e-12);
  EXPECT_EQ(glint(straight, 1.01 * half_angle), 0);
  EXPECT_GT(glint(straight, 0.6 * half_angle), 0) << "control: the flash seen at d, not at 2d, would be r/d wide";
  // 1/(2d)^2 of the intensity: the image of the flash is 2d away.
  EXPECT_NEAR(back_at_the_eye(straight, flash, camera) / (0.9 / (4 * d * d)), 1, 0.03);
  World const leaning = disc_of(0.9, 0, 1.05 * half_angle);
  EXPECT_EQ(glint(leaning, 0), 0);
  EXPECT_GT(glint(leaning, 1.05 * half_angle) + glint(leaning, -1.05 * half_angle), 0) << "where it is perpendicular";
}

// A polished sphere of radius a at the distance d: R a^2/(4 d^2 (a + d)^2) of the intensity comes back.
TEST(Flash, GlintOfASphere) {
  constexpr double a = 0.2, d = 1, r = 40e-3;
  World world;
  std::uint32_t const mirror = mirror_optic(world, 0.8);
  world.add_surface(Sphere{{0, 0, a + d}, {0, 0, 1}, a}, mirror, mirror, world.add_body("b", {}),
                    world.add_group("ball"));
  world.finish();
  double const expected = 0.8 * a * a / (4 * d * d * (a + d) * (a + d));
  double const seen =
      back_at_the_eye(world, {.radius = r}, looking_at({}, {0, 0, 1}, {0, 1, 0}, 0.6 * degree, 101, 101));
  EXPECT_NEAR(seen / expected, 1, 0.03);
  EXPECT_GT(std::fabs(seen / (0.8 / (4 * d * d)) - 1), 0.5) << "control: as if it were flat";
}

// Two mirrors at right angles send everything back, wherever they look: near their edge by 0.9 squared.
TEST(Flash, CornerOfTwoMirrors) {
  World world;
  std::uint32_t const mirror = mirror_optic(world, 0.9);
  BodyId const body = world.add_body("b", {});
  for (double const side : {-1.0, 1.0})
    world.add_surface(Disk{{side, 0, 2}, unit({-side, 0, -1}), 0, std::sqrt(2.0)}, mirror, mirror, body,
                      world.add_group("leaf"));
  world.finish();
  Flash const flash{.radius = 20e-3};
  auto const at = [&](double x) {
    return flash_along(world.view(), {{}, unit({x, 0, 3})}, {}, {}, flash, {}).glint * pi * flash.radius * flash.radius;
  };
  EXPECT_NEAR(at(5e-3), 0.81, 1e-12);
  EXPECT_EQ(at(0.2), 0) << "control: returned off the eye";
}

// A wall behind a mirror at 45 degrees is as bright as at the whole distance, less the mirror twice.
TEST(Flash, ScatterByWayOfAMirror) {
  World world;
  BodyId const body = world.add_body("b", {});
  std::uint32_t const mirror = mirror_optic(world, 0.9), wall = lambertian_optic(world, 0.5);
  world.add_surface(Disk{{0, 0, 1}, unit({1, 0, -1}), 0, 0.3}, mirror, mirror, body, world.add_group("mirror"));
  world.add_surface(Disk{{2, 0, 1}, {-1, 0, 0}, 0, 1}, wall, wall, body, world.add_group("wall"));
  world.finish();
  FlashLight const seen = flash_along(world.view(), {{}, {0, 0, 1}}, {}, {}, {}, {});
  EXPECT_NEAR(seen.scattered / (0.81 * 0.5 / pi / 9), 1, 1e-12);
  EXPECT_GT(std::fabs(seen.scattered / (0.9 * 0.5 / pi / 9) - 1), 0.05) << "control: the mirror once";
}

}  // namespace
}  // namespace straytrace::testing::trace_flash
