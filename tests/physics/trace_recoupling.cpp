// SPDX-License-Identifier: BSD-3-Clause
// Closed forms of recoupling: one vertex (A6), baffle sum (A11, B5), wall forward (A12).
#include "trace_support.hpp"

namespace straytrace::testing {
namespace {

constexpr double lambda = 1.064e-6;

// physics.md eq. 4.3, case A6: diffuse plate in a beam of radius w, f = beta lambda^2/(pi w^2) at normal incidence.
SampleMean plate(double beta, double w, Profile profile) {
  World world;
  BodyId const body = world.add_body("plate", {});
  PortId const port = world.add_port("plate");
  SurfaceId const s = world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.1}, lambertian_optic(world, pi * beta),
                                        black_optic(world), body, world.add_group("plate"));
  world.add_footprint(spot(s, {}, {0, 0, -1}, profile, w, port));
  world.finish();
  return total_coupling(run_histories(world, 1 << 22));
}

TEST(Recoupling, OneVertexIntoTem00Eq4_3) {
  double const w = 1e-3, beta = 1e-3, expected = 3.60357e-10;
  EXPECT_NEAR(beta * lambda * lambda / (pi * w * w), expected, 1e-5 * expected);
  expect_mean("A6", plate(beta, w, Profile::gaussian), expected, 3e-3 * expected);
}

TEST(Recoupling, OneVertexTwinEvenLightIsRejected) {  // even light over w couples twice less... and must be seen to
  SampleMean const twin = plate(1e-3, 1e-3, Profile::even);
  EXPECT_GT(std::abs(twin.mean - 3.60357e-10), 0.05 * 3.60357e-10);
}

// physics.md eq. 8.1 to 8.4: annuli between angles theta_min and theta_max as seen from a point-like spot; each ring
// fills the gap to the next, so that light leaving at angle theta is caught at l = R_t/theta.
struct BaffleSum {
  double kappa, exponent, tube, length, first, beta, distance_power = 2;
  int rings = 1500;
};

SampleMean traced_sum(BaffleSum const& b, std::uint64_t histories, double mode_radius = 2e-4) {
  World world;
  BodyId const body = world.add_body("all", {});
  PortId const port = world.add_port("mirror");
  std::uint32_t const black = black_optic(world);
  SurfaceId const mirror =
      world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.1}, power_law_optic(world, b.kappa, b.exponent, 5e-5), black, body,
                        world.add_group("mirror"));
  std::uint32_t const baffle = lambertian_optic(world, pi * b.beta);
  double const near = b.length / 2, far = b.length - b.first, ratio = std::pow(far / near, 1.0 / b.rings);
  for (int i = 0; i < b.rings; ++i) {
    double const z = near * std::pow(ratio, i + 0.5);
    world.add_surface(Disk{{0, 0, z}, {0, 0, -1}, b.tube / std::sqrt(ratio), b.tube * std::sqrt(ratio)}, baffle, black,
                      body, world.add_group("baffles"));
  }
  world.add_footprint(spot(mirror, {}, {0, 0, -1}, Profile::gaussian, mode_radius, port));
  world.limits.route_vertices = 3;
  world.finish();
  TraceResult const r = run_histories(world, histories);
  for (CouplingClass const& c : r.coupling.classes)
    if (route_name(r.coupling, c) == "mirror·S > baffles·S > mirror·S") return sample_mean(c.coupling, histories);
  return {};
}

// eq. 8.3, 1/(m^2 sr)
double baffle_sum(BaffleSum const& b) {
  double const low = b.tube / (b.length - b.first), high = 2 * b.tube / b.length, m = 4 - 2 * b.exponent;
  double const integral = m == 0 ? std::log(high / low) : (std::pow(high, m) - std::pow(low, m)) / m;
  return 2 * pi * b.kappa * b.kappa / (b.tube * b.tube) * integral;
}

BaffleSum const et_hf{3.2145e-9, 2.3986, 0.5, 1e4, 32.35, 1e-4};

TEST(Recoupling, ClosedFormBaffleSumA11) {
  EXPECT_NEAR(baffle_sum(et_hf), 3.689325e-13, 1e-6 * 3.689325e-13);
  EXPECT_NEAR(baffle_sum({1e-6, 2, 0.5, 1e4, 50, 1e-4}), 1.729471e-11, 1e-6 * 1.729471e-11);
}

// The light is caught between the stated angles at l = R_t/theta; small-angle form of eq. 8.3, error below 1e-4 here.
TEST(Recoupling, TracedBaffleSumEtHfA11) {
  double const expected = lambda * lambda * et_hf.beta * 3.689325e-13;
  expect_mean("A11 ET-HF", traced_sum(et_hf, 1 << 23), expected, 1e-2 * expected);
}

TEST(Recoupling, TracedBaffleSumInverseSquareA11) {
  BaffleSum const b{1e-6, 2, 0.5, 1e4, 50, 1e-4};
  double const expected = lambda * lambda * b.beta * 1.729471e-11;
  expect_mean("A11 1/theta^2", traced_sum(b, 1 << 23), expected, 1e-2 * expected);
}

}  // namespace
}  // namespace straytrace::testing
