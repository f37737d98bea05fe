// SPDX-License-Identifier: BSD-3-Clause
// Transmission of a diffuse tube whose mouth is filled by a Lambertian source (docs/theory/sampling.md; Clausing's
// problem for rho = 1). The numbers are those of the integral equation of the wall,
//   E(z) = E_0(z) + rho int K(|z - z'|) E(z') dz',  K(x) = 1/2 (1 - x (x^2 + 6)/(x^2 + 4)^(3/2))   (radius 1),
// solved to more digits than printed.
#pragma once

#include "support/shapes.hpp"
#include "support/trace_received.hpp"

namespace straytrace::testing {

enum class Aim { none, as_made, fixed_share };
inline SampleMean transmission(double length, double rho, std::uint64_t histories, Aim aim, double radius = 1) {
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

struct TubeRow {
  double length, rho, expected, effect;
  std::uint64_t histories;
};
// Four standard errors are at most half the effect: 1 %, and 2 % for the one tube in which light is lost nowhere and
// bounces for long.
inline void expect_tubes(std::initializer_list<TubeRow> rows, bool steered) {
  for (TubeRow const& r : rows) {
    SampleMean const t = transmission(r.length, r.rho, r.histories, steered ? Aim::as_made : Aim::none);
    std::string const name = "L/R " + std::to_string(r.length) + ", rho " + std::to_string(r.rho);
    expect_mean(name.c_str(), t, r.expected, r.effect * r.expected, 4, 4);
  }
}

}  // namespace straytrace::testing
