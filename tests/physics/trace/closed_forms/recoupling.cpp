// SPDX-License-Identifier: BSD-3-Clause
// Closed forms of recoupling: one vertex (A6) and the baffle sum (A11, B5).
#include "support/trace_support.hpp"

namespace straytrace::testing::trace_recoupling {
namespace {

constexpr double lambda = 1.064e-6;

// docs/theory/path_integral.md, eq. 1.4, 4.3, case A6: diffuse plate in a beam of radius w, f = q^2 beta cos(theta)
// lambda^2/(pi w^2).
SampleMean plate(double w, double incidence = 0, double share = 1, double beta = 1e-3) {
  World world;
  BodyId const body = world.add_body("plate", {});
  SurfaceId const s = world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.1}, lambertian_optic(world, pi * beta),
                                        black_optic(world), body, world.add_group("plate"));
  Vec3 const travel{std::sin(incidence), 0, -std::cos(incidence)};
  Footprint f = spot(s, {}, travel, Profile::gaussian, w, world.add_port("plate"));
  f.share = share;
  world.add_footprint(f);
  world.finish();
  return total_coupling(run_histories(world, 1 << 20));
}

TEST(Recoupling, OneVertexIntoTem00A6) {
  double const w = 1e-3, beta = 1e-3, expected = 3.60357e-10;
  EXPECT_NEAR(beta * lambda * lambda / (pi * w * w), expected, 1e-5 * expected);
  expect_mean("A6", plate(w), expected, 5e-3 * expected);
  expect_rejected("w as a diameter", plate(w / 2), expected);
  expect_rejected("1 % more BRDF", plate(w, 0, 1, 1.01 * beta), expected);
}

TEST(Recoupling, OneVertexAtAnAngleAndAfterASplitter) {
  double const w = 1e-3, expected = 3.60357e-10 * std::cos(pi / 4) * 0.25;
  SampleMean const s = plate(w, pi / 4, 0.5);
  expect_mean("45 degrees, half of the light", s, expected, 5e-3 * expected);
  expect_rejected("no cosine", s, expected / std::cos(pi / 4));
  expect_rejected("share counted once", s, 2 * expected);
}

// docs/theory/arm.md, eq. 8.1 to 8.4: annuli between `nearest` and length - first; each fills the gap to the next, so
// that light leaving at angle theta is caught at l = R_t/theta.
struct BaffleSum {
  double kappa, exponent, tube, length, first, beta, nearest;
  double from_angle() const { return tube / (length - first); }
  double to_angle() const { return tube / nearest; }
};
BaffleSum const et_hf{3.2145e-9, 2.3986, 0.5, 1e4, 32.35, 1e-4, 5000}, square{1e-6, 2, 0.5, 1e4, 50, 1e-4, 50};

// eq. 8.3, 1/(m^2 sr): light between two angles.
double baffle_sum(BaffleSum const& b, double low, double high) {
  double const m = 4 - 2 * b.exponent;
  double const integral = m == 0 ? std::log(high / low) : (std::pow(high, m) - std::pow(low, m)) / m;
  return 2 * pi * b.kappa * b.kappa / (b.tube * b.tube) * integral;
}

// The rings of the far half of the tube are a group of their own.
TraceResult traced(BaffleSum const& b, std::uint64_t histories) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), baffle = lambertian_optic(world, pi * b.beta);
  SurfaceId const mirror =
      world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.1}, power_law_optic(world, b.kappa, b.exponent, 5e-5), black, body,
                        world.add_group("mirror"));
  constexpr int rings = 1000;
  GroupId const near = world.add_group("near"), far = world.add_group("far");
  double const middle = b.length / 2, ends[] = {b.nearest, middle, b.length - b.first};
  for (int half = b.nearest < middle ? 0 : 1; half < 2; ++half) {
    double const ratio = std::pow(ends[half + 1] / ends[half], 1.0 / rings), root = std::sqrt(ratio);
    for (int i = 0; i < rings; ++i) {
      double const z = ends[half] * std::pow(ratio, i + 0.5);
      world.add_surface(Disk{{0, 0, z}, {0, 0, -1}, b.tube / root, b.tube * root}, baffle, black, body,
                        half ? far : near);
    }
  }
  world.add_footprint(spot(mirror, {}, {0, 0, -1}, Profile::gaussian, 2e-4, world.add_port("mirror")));
  world.limits.max_order = 2;
  world.finish();
  return run_histories(world, histories);
}
constexpr char const *far_route = "mirror·S > far·S > mirror·S", *near_route = "mirror·S > near·S > mirror·S";

TEST(Recoupling, ClosedFormBaffleSumA11) {
  EXPECT_NEAR(baffle_sum(et_hf, et_hf.from_angle(), et_hf.to_angle()), 3.689325e-13, 1e-6 * 3.689325e-13);
  EXPECT_NEAR(baffle_sum(square, square.from_angle(), 1e-4), 1.729471e-11, 1e-6 * 1.729471e-11);
}

// The small-angle form of eq. 8.3 is good to 1e-4 here, and to 3e-4 at the angles of the near half below.
TEST(Recoupling, TracedBaffleSumEtHfA11) {
  SampleMean const f = route_coupling(traced(et_hf, 5 << 19), far_route);
  double const unit = lambda * lambda * et_hf.beta, expected = unit * 3.689325e-13;
  expect_mean("A11 ET-HF", within(f, 1e-4 * expected), expected, 1e-2 * expected);
  expect_rejected("exponent rounded to 2.4", f, unit * baffle_sum({3.2145e-9, 2.4, 0.5, 1e4, 0, 0, 0}, 5.016e-5, 1e-4));
  expect_rejected("C_rev already applied", f, 2 * expected);
}

TEST(Recoupling, TracedBaffleSumInverseSquareA11) {
  TraceResult const r = traced(square, 1 << 21);
  SampleMean const far = route_coupling(r, far_route), near = route_coupling(r, near_route);
  double const unit = lambda * lambda * square.beta, expected = unit * 1.729471e-11;
  double const rest = unit * baffle_sum(square, 1e-4, square.to_angle());
  expect_mean("A11 1/theta^2, far half", within(far, 1e-4 * expected), expected, 2.5e-2 * expected);
  expect_mean("1/theta^2, near half", within(near, 3e-4 * rest), rest, 8e-3 * rest);
  expect_rejected("1 % more BRDF", near, 1.01 * rest);
}

}  // namespace
}  // namespace straytrace::testing::trace_recoupling
