// SPDX-License-Identifier: BSD-3-Clause
// Transmission of a diffuse tube whose mouth is filled by a Lambertian source (estimators.md 17, scene 5; Clausing's
// problem for rho = 1). The numbers are those of the integral equation of the wall,
//   E(z) = E_0(z) + rho int K(|z - z'|) E(z') dz',  K(x) = 1/2 (1 - x (x^2 + 6)/(x^2 + 4)^(3/2))   (radius 1),
// solved to more digits than printed.
#include "shapes.hpp"
#include "trace_received.hpp"

namespace straytrace::testing {
namespace {

enum class Aim { none, as_made, fixed_share };
SampleMean transmission(double length, double rho, std::uint64_t histories, Aim aim, double radius = 1) {
  World world;
  BodyId const body = world.add_body("tube", {});
  std::uint32_t const black = black_optic(world);
  // a source that takes in what comes back: it scatters 1e-6 only, and powers are over what it scattered
  SurfaceId const mouth =
      world.add_surface(disk(0, 1), lambertian_optic(world, 1e-6), black, body, world.add_group("mouth"));
  if (rho > 0)
    world.add_surface(cylinder(radius, 0, length), black, lambertian_optic(world, rho), body, world.add_group("wall"));
  else
    world.add_surface(cylinder(radius, 0, length), black, black, body, world.add_group("wall"));
  receive_on(
      world, "exit",
      world.add_surface(disk(0, radius, {{0, 0, length}, {0, 0, -1}}), black, black, body, world.add_group("exit")));
  world.add_footprint(spot(mouth, {}, {0, 0, -1}, Profile::even, 1));
  world.limits.max_order = 20000;
  world.finish();
  if (aim != Aim::none) {
    SteeringTables tables = make_importance(world);
    if (aim == Aim::fixed_share)
      for (PatchSide& side : tables.sides)
        if (side.count > 0) side.alpha = 0.25;
    world.steer(tables);
  }
  return received_share(run_histories(world, histories));
}

struct Row {
  double length, rho, expected, effect;
  std::uint64_t histories;
};
// Four standard errors are at most half the effect: 1 %, and 2 % for the one tube in which light is lost nowhere and
// bounces for long.
void expect_rows(std::initializer_list<Row> rows, bool steered) {
  for (Row const& r : rows) {
    SampleMean const t = transmission(r.length, r.rho, r.histories, steered ? Aim::as_made : Aim::none);
    std::string const name = "L/R " + std::to_string(r.length) + ", rho " + std::to_string(r.rho);
    expect_mean(name.c_str(), t, r.expected, r.effect * r.expected, 4, 4);
  }
}

TEST(DiffuseTube, ShortScene5) {
  expect_rows({{1, 1, 0.671984, 2e-2, 1 << 16},
               {1, 0.5, 0.490881, 2e-2, 1 << 16},
               {1, 0.05, 0.390824, 2e-2, 1 << 16},
               {1, 0, 0.381966, 2e-2, 1 << 16},
               {2, 1, 0.514231, 2e-2, 1 << 17},
               {2, 0.5, 0.262203, 2e-2, 1 << 16},
               {2, 0.05, 0.177722, 2e-2, 1 << 16},
               {2, 0, 0.171573, 2e-2, 1 << 16}},
              false);
}
TEST(DiffuseTube, LongScene5) {
  expect_rows({{10, 1, 0.190942, 4e-2, 1 << 18},
               {10, 0.5, 0.0129496, 1e-2, 1 << 17},
               {10, 0.05, 9.95106e-3, 5e-3, 1 << 16},
               {10, 0, 9.80486e-3, 5e-3, 1 << 16},
               {100, 0.5, 1.017657e-4, 1e-3, 1 << 16}},
              true);
}

// Where light is lost nowhere every place is worth about the same: aiming must not cost what bounces add up
// (docs/theory/sampling.md). Twin: a fixed share of the law.
TEST(DiffuseTube, EnclosureIsNotSpoiledByAiming) {
  auto const error = [](Aim aim) {
    SampleMean const t = transmission(10, 1, 1 << 15, aim);
    return t.std_error / t.mean;
  };
  double const law = error(Aim::none);
  EXPECT_LT(error(Aim::as_made), 1.3 * law);
  EXPECT_GT(error(Aim::fixed_share), 2 * law);
}

// The numbers know each other apart, and a wall 1 % wider is seen.
TEST(DiffuseTube, TwinsAreRejected) {
  SampleMean const t = transmission(2, 0.5, 1 << 17, Aim::none);
  expect_rejected("direct light alone", t, 0.171573);
  expect_rejected("a perfect wall", t, 0.514231);
  expect_rejected("1 % wider", transmission(2, 0.5, 1 << 17, Aim::none, 1.01), 0.262203);
}

}  // namespace
}  // namespace straytrace::testing
