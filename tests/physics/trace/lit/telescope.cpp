// SPDX-License-Identifier: BSD-3-Clause
// Point-source transmission of a clean mirror telescope, single scatter (docs/theory/sampling.md): irradiance on the
// detector over that on the pupil = BSDF x projected solid angle of the pupil cone, pi sin^2 with tan = 1/(2 F). The
// small-angle form pi/(4 F^2) must not be met.
#include "support/shapes.hpp"
#include "support/trace_received.hpp"

namespace straytrace::testing::trace_telescope {
namespace {

constexpr double focal = 2, detector = 1e-3, reflectance = 0.01;  // m, m radius, of the scatter

// Irradiance ratio over the BSDF; the telescope looks along z, its detector is on the axis at the focus.
template <class Mirror>
SampleMean transmission(Mirror const& mirror, double radius, std::uint64_t histories) {
  World world;
  BodyId const body = world.add_body("telescope", {});
  std::uint32_t const black = black_optic(world);
  SurfaceId const pupil =
      world.add_surface(mirror, lambertian_optic(world, reflectance), black, body, world.add_group("mirror"));
  SurfaceId const sensor = world.add_surface(disk(0, detector, {{0, 0, focal}, {0, 0, -1}}), black, black, body,
                                             world.add_group("detector"));
  receive_on(world, "detector", sensor);
  world.add_footprint(spot(pupil, {}, {0, 0, -1}, Profile::even, radius));
  world.limits.max_order = 1;
  prepare(world);
  double const bsdf = reflectance / pi, irradiance = 1 / (pi * radius * radius);
  return scaled(received(run_histories(world, histories)), 1 / (pi * detector * detector * irradiance * bsdf));
}

// The detector's finite size changes the fourth digit after those printed.
TEST(Telescope, PupilConeScene10) {
  struct Case {
    double number, expected;
  };
  for (Case const c : {Case{2, 0.184800}, {4, 0.048332}, {8, 0.012224}}) {
    double const radius = 0.5 * focal / c.number, small_angle = pi / (4 * c.number * c.number);
    EXPECT_NEAR(pi / (1 + 4 * c.number * c.number), c.expected, 5e-7);
    SampleMean const s = transmission(disk(0, radius), radius, 1 << 17);
    expect_mean("pi sin^2", s, c.expected, 2e-3 * c.expected);
    expect_rejected("pi/(4 F^2)", s, small_angle);
  }
}

// The same with the mirror's own shape. Paraboloid of focal length f, u = r/(2f) = tan(angle/2): distance f (1 + u^2),
// normal at angle/2, so the ratio is 8 pi int u (1 - u^2)/(1 + u^2)^(7/2) du.
TEST(Telescope, ParaboloidScene10) {
  double const number = 2, radius = 0.5 * focal / number, s = 1 + radius * radius / (4 * focal * focal);
  double const expected = 4 * pi * (2.0 / 3 * (std::pow(s, -1.5) - 1) + 0.8 * (1 - std::pow(s, -2.5)));
  EXPECT_NEAR(expected, 0.189624, 5e-7);
  SampleMean const t = transmission(conic(0.5 / focal, -1, 0, radius), radius, 1 << 17);
  expect_mean("paraboloid", t, expected, 2e-3 * expected);
  expect_rejected("flat pupil", t, 0.184800);
  expect_rejected("pi/(4 F^2)", t, 0.196350);
}

}  // namespace
}  // namespace straytrace::testing::trace_telescope
