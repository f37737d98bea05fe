// SPDX-License-Identifier: BSD-3-Clause
// A concave mirror sees itself. On a sphere the exchange between any two points is cos cos/d^2 = 1/(4 R^2), so two
// Lambertian scatters on one cap give f = lambda^2 beta^2/(4 R^2) at any position of the cap
// (docs/theory/path_integral.md, eq. 1.2).
#include "support/trace_support.hpp"

namespace straytrace::testing::trace_self_connection {
namespace {

constexpr double lambda = 1.064e-6, roc = 1683, beta = 1e-3;

SampleMean self_exchange(double z) {
  World world;
  BodyId const body = world.add_body("mirror", {});
  PortId const port = world.add_port("mirror");
  Cap cap;
  cap.curvature = 1 / roc;
  cap.outer_radius = 0.3;
  cap.place(facing_along({0, 0, z}, {0, 0, -1}));
  SurfaceId const s =
      world.add_surface(cap, lambertian_optic(world, pi * beta), black_optic(world), body, world.add_group("mirror"));
  Footprint lit = spot(s, {0, 0, z}, {0, 0, 1}, Profile::gaussian, 0.05, port);
  lit.standing = true;
  world.add_footprint(lit);
  world.finish();
  return total_coupling(run_histories(world, 1 << 18));
}

TEST(SelfConnection, ConcaveMirrorCouplesToItselfFarFromTheOriginEq1_2) {
  double const expected = lambda * lambda * beta * beta / (4 * roc * roc);
  for (double const z : {0.0, 2999.8, 4e4}) {
    SampleMean const f = self_exchange(z);
    EXPECT_NEAR(f.mean, expected, 2e-3 * expected) << "at z = " << z;
  }
}

TEST(SelfConnection, AFactorOfTwoWouldBeFound) {
  double const control = 0.5 * lambda * lambda * beta * beta / (4 * roc * roc);
  EXPECT_GT(std::abs(self_exchange(2999.8).mean - control), 0.4 * control);
}

}  // namespace
}  // namespace straytrace::testing::trace_self_connection
