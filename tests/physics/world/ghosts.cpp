// SPDX-License-Identifier: BSD-3-Clause
// Ghost beams of plates, wedges and interferometers against closed forms (docs/theory/beams.md, R2.25, R2.24, eq. 6.9).
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <map>

#include "support/ghost_support.hpp"

namespace straytrace::testing {
namespace {

// R2.25: R_AR = 1e-4 on both faces: the first ghost behind the plate has 1e-8 of the transmitted power.
TEST(Ghosts, first_ghost_of_a_plate) {
  World const world = plate(1e-4, 1.45, 0.01, 0);
  auto const all = rows(world, launched(world));
  double const main = of_order(all, 0, true).power, ghost = of_order(all, 2, true).power;
  EXPECT_NEAR(ghost / main, 1e-8, 1e-20);
  double const first = of_order(all, 1, false).power;  // of either face: 1e-4, or less what the front took twice
  EXPECT_NEAR(first, 1e-4, 2.1e-8);
  World const control = plate(1e-2, 1.45, 0.01, 0);  // amplitudes taken for powers
  auto const wrong = rows(control, launched(control));
  EXPECT_GT(std::fabs(of_order(wrong, 2, true).power / of_order(wrong, 0, true).power / 1e-8 - 1), 1);
}

// Eq. 5.4: one inner round trip turns a ghost by 2 n psi: 2.90 mrad for 1 mrad at n = 1.45 (R2.25), to second order.
TEST(Ghosts, wedge_turns_a_ghost_by_2_n_psi) {
  double const psi = 1e-3, n = 1.45;
  World const world = plate(1e-4, n, 0.01, psi);
  auto const all = rows(world, launched(world));
  Row const &main = of_order(all, 0, true), &ghost = of_order(all, 2, true);
  double const angle = angle_between(main.mode.travel, ghost.mode.travel);
  // exactly: Snell at the back face for inner incidence psi, and 3 psi after the round trip
  EXPECT_NEAR(angle, std::asin(n * std::sin(3 * psi)) - std::asin(n * std::sin(psi)), 1e-12);
  EXPECT_NEAR(angle, 2 * n * psi, 2e-8);
  EXPECT_NEAR(ghost.standing.angle, angle, 1e-12);
  EXPECT_GT(std::fabs(angle - 2 * psi), 1e-4);  // control: the mirror's angle without refraction
}

// Two-bounce ghosts of N surfaces: N (N - 1)/2 in forward direction (docs/theory/beams.md).
TEST(Ghosts, number_of_two_bounce_ghosts) {
  for (int plates : {1, 2, 3, 4}) {
    World world;
    world.wavelength = lambda;
    std::uint32_t const optic = coated(world, 1e-4);
    for (int i = 0; i < plates; ++i) {
      std::uint32_t const volume = world.add_volume({1.45, 0});
      BodyId const body = world.add_body("plate", {});
      double const z = 0.1 * i, psi = 1e-3 * (i + 1);
      world.add_surface(disk(0, 0.5, {{0, 0, z}, {0, 0, -1}}), optic, optic, body, world.add_group("f"), volume);
      world.add_surface(disk(0, 0.5, {{0, 0, z + 0.01}, unit({psi, 0, 1})}), optic, optic, body, world.add_group("b"),
                        volume);
    }
    world.finish();
    auto const all = rows(world, launched(world), {1e-15, 2, 1000});
    int const surfaces = 2 * plates;
    EXPECT_EQ(std::count_if(all.begin(), all.end(), [](Row const& r) { return r.order == 2; }),
              surfaces * (surfaces - 1) / 2);
    EXPECT_EQ(std::count_if(all.begin(), all.end(), [](Row const& r) { return r.order == 1; }), surfaces);
  }
}

// Spot of the two-bounce ghost of a lens by the ABCD law (eq. 6.2), tangential and sagittal alike on the axis.
TEST(Ghosts, spot_of_a_lens_ghost_by_abcd) {
  World world;
  world.wavelength = lambda;
  double const n = 1.45, d = 0.008, roc = 0.18;  // biconvex
  std::uint32_t const optic = coated(world, 1e-3), volume = world.add_volume({n, 0});
  BodyId const body = world.add_body("lens", {});
  world.add_surface(cap(-1 / roc, 0, 0.05, {{0, 0, 0}, {0, 0, -1}}), optic, optic, body, world.add_group("front"),
                    volume);
  world.add_surface(cap(-1 / roc, 0, 0.05, {{0, 0, d}, {0, 0, 1}}), optic, optic, body, world.add_group("back"),
                    volume);
  std::uint32_t const black = black_optic(world);
  world.add_surface(disk(0, 5, {{0, 0, 1}, {0, 0, -1}}), black, black, body, world.add_group("screen"));
  world.finish();
  double const w = 3e-3;
  auto const all = rows(world, launched(world, w, {0, 0, -0.1}));
  using Q = Amplitude;  // beam parameter q = z + i z_R
  auto const abcd = [](Q q, double a, double b, double c, double e) { return (a * q + b) / (c * q + e); };
  auto const into = [&](Q q, double r) { return abcd(q, 1, 0, -(n - 1) / (r * n), 1 / n); };  // convex to the light
  auto const out = [&](Q q, double r) { return abcd(q, 1, 0, (1 - n) / r, n); };              // concave inside: r > 0
  auto const mirror = [&](Q q, double r) { return abcd(q, 1, 0, -2 / r, 1); };
  Q q{0.1, pi * w * w / lambda};
  q = into(q, roc) + d;
  Q const main = out(q, roc) + (1 - d);
  q = mirror(mirror(q, roc) + d, roc) + d;
  Q const ghost = out(q, roc) + (1 - d);
  auto const radius = [](Q at) { return std::sqrt(-lambda / (pi * std::imag(1.0 / at))); };
  auto const spot_of = [&](std::uint32_t order) { return spot(of_order(all, order, true).mode); };
  EXPECT_NEAR(spot_of(0).major / radius(main), 1, 1e-9);
  EXPECT_NEAR(spot_of(2).major / radius(ghost), 1, 1e-9);
  EXPECT_NEAR(spot_of(2).minor / radius(ghost), 1, 1e-9);
  EXPECT_GT(std::fabs(spot_of(2).major / radius(main) - 1), 0.1);  // control: the spot of the main beam
}

// The fields of all ghosts of a plane-parallel plate sum to Airy's formula, behind it and in front of it.
struct Airy {
  Amplitude through, back;
};
Airy summed(double reflect, double thickness, bool forget_gouy = false, bool forget_sign = false) {
  double const n = 1.45;
  World const world = plate(reflect, n, thickness, 0, 1e4);
  BeamLaunch const launch = launched(world, 100);  // wide: nearly a plane wave
  TreeLimits const limits{1e-26, 1000, 10000};
  Airy sum{};
  for (Row const& r : rows(world, launch, limits)) {
    bool const forwards = r.mode.travel.z > 0;
    double const phase = r.phase + (forget_gouy ? 0.1 * double(r.order) : 0);
    Jones const& j = r.field.state[0];
    // both axes of the field: the s axis is kept, so `a` and `b` never mix at normal incidence
    Amplitude const field = Amplitude(j.a.re, j.a.im) * std::polar(1.0, phase - 2 * pi / lambda * 1.0);
    (forwards ? sum.through : sum.back) += (forget_sign && r.order > 1 ? -1.0 : 1.0) * field;
  }
  return sum;
}
TEST(Ghosts, fields_of_a_plate_sum_to_airy) {
  double const n = 1.45;
  for (double reflect : {0.04, 0.3}) {
    for (double thickness : {1e-3, 1e-3 + 0.11e-6, 1e-3 + 0.3e-6}) {
      Amplitude const r{0, std::sqrt(reflect)}, one{1, 0}, turn = std::polar(1.0, 2 * pi / lambda * n * thickness);
      double const t2 = 1 - reflect;
      Amplitude const through = t2 * turn / (one - r * r * turn * turn);
      Amplitude const back = r + t2 * r * turn * turn / (one - r * r * turn * turn);
      Airy const found = summed(reflect, thickness);
      EXPECT_LT(std::abs(found.through - through), 1e-9) << reflect << ' ' << thickness;
      EXPECT_LT(std::abs(found.back - back), 1e-9);
      EXPECT_NEAR(std::norm(found.through) + std::norm(found.back), 1, 1e-9);
      EXPECT_GT(std::abs(summed(reflect, thickness, true).through - through), 1e-4);  // controls: other phases
      EXPECT_GT(std::abs(summed(reflect, thickness, false, true).through - through), 1e-4);
    }
  }
}

// The field that a ghost adds to the main beam behind the plate, from the overlaps where it comes into line: 1/(1 - r^2
// e^{2 i d}).
TEST(Ghosts, recoupled_fields_of_a_plate_sum_to_airy) {
  double const n = 1.45, reflect = 0.04, thickness = 1e-3;
  World const world = plate(reflect, n, thickness, 0, 1e4);
  BeamLaunch const launch = launched(world, 100);
  Amplitude with = 1, against = 0;
  for (Row const& r : rows(world, launch, {1e-26, 1000, 10000})) {
    if (r.order == 0) continue;
    Recoupling const& back = r.standing.recoupled;
    ASSERT_TRUE(back.any);
    (back.against ? against : with) += back.field[0];
  }
  Amplitude const r{0, std::sqrt(reflect)}, one{1, 0}, turn = std::polar(1.0, 2 * pi / lambda * n * thickness);
  EXPECT_LT(std::abs(with - one / (one - r * r * turn * turn)), 1e-9);
  // against: the fields come back to the plane of the launch, 1 m before the plate; polarisation along the axis
  Amplitude const launch_turn = std::polar(1.0, 2 * pi / lambda * 2.0);
  Amplitude const back = launch_turn * (r + (1 - reflect) * r * turn * turn / (one - r * r * turn * turn));
  EXPECT_NEAR(std::norm(against), std::norm(back), 1e-9);
  EXPECT_GT(std::fabs(std::norm(against) - reflect), 1e-3);  // control: the front face alone
}

// Eq. 6.9: two mirrors and a splitter; beams that come together again are summed as fields.
struct Outputs {
  double back = 0, dark = 0;
};
Outputs michelson(double difference, double split = 0.5) {
  World world;
  world.wavelength = lambda;
  Optic splitter;
  splitter.reflect = split;
  splitter.transmit = 1 - split;
  std::uint32_t const half = world.add_optic(splitter), mirror = mirror_optic(world, 0.98);
  BodyId const body = world.add_body("all", {});
  double const s = std::sqrt(0.5);
  world.add_surface(disk(0, 1, {{0, 0, 0}, {s, 0, -s}}), half, half, body, world.add_group("splitter"));
  world.add_surface(disk(0, 1, {{0, 0, 2 + difference / 2}, {0, 0, -1}}), mirror, mirror, body, world.add_group("z"));
  world.add_surface(disk(0, 1, {{2 - difference / 2, 0, 0}, {-1, 0, 0}}), mirror, mirror, body, world.add_group("x"));
  world.finish();
  BeamLaunch const launch = launched(world, 0.1);
  Amplitude back = 0, dark = 0;
  for (Row const& r : rows(world, launch, {1e-12, 1000, 1000})) {
    if (r.end != BeamEnd::escaped) continue;
    // the polarisation along y stays itself; s field: `a` along the s axis, which may point either way
    Jones const& j = r.field.state[0];
    Vec3 const other = cross(r.mode.travel, r.field.axis);
    Amplitude const field = r.field.axis.y * Amplitude(j.a.re, j.a.im) + other.y * Amplitude(j.b.re, j.b.im);
    (r.mode.travel.z < -0.5 ? back : dark) += field * std::polar(1.0, r.phase);
  }
  return {std::norm(back), std::norm(dark)};
}
TEST(Ghosts, michelson_by_recombining_beams) {
  for (double difference : {0.0, 0.1e-6, 0.266e-6, 0.4e-6}) {
    Outputs const found = michelson(difference);
    double const phase = 2 * pi / lambda * difference, R = 0.98;
    EXPECT_NEAR(found.dark, R * std::pow(std::cos(phase), 2), 1e-9);  // one reflection and one transmission in each arm
    EXPECT_NEAR(found.back, R * std::pow(std::sin(phase), 2), 1e-9);
  }
  EXPECT_GT(std::fabs(michelson(0.1e-6, 0.4).dark - 0.98 * std::pow(std::cos(2 * pi / lambda * 0.1e-6), 2)), 1e-3);
}

// Between two faces that reflect most of the light a beam runs to and fro: each round is a ghost of one order more, and
// the beam itself ends. Controls: a face that transmits, and light that is led along glass by total reflection.
TEST(Ghosts, light_that_goes_round_inside_glass_is_a_ghost) {
  auto const orders = [](World const& world, BeamLaunch const& launch, std::uint32_t most) {
    std::map<std::uint32_t, int> spots;
    for (BeamSpot const& s : beam_spots(world, launch, {1e-15, most, 1000})) ++spots[s.order];
    return spots;
  };
  World const trap = plate(0.999, 1.45, 0.2, 0);
  auto const trapped = orders(trap, launched(trap), 0);
  EXPECT_LE(trapped.at(0), 2);
  EXPECT_EQ(trapped.size(), 1u);
  World const open = plate(1e-4, 1.45, 0.2, 0);
  EXPECT_EQ(orders(open, launched(open), 0).at(0), 2);
  World guide;
  guide.wavelength = lambda;
  std::uint32_t const clear = coated(guide, 0), volume = guide.add_volume({1.45, 0});
  BodyId const body = guide.add_body("slab", {});
  for (double const side : {-1.0, 1.0})
    guide.add_surface(disk(0, 1, {{0, 0.01 * side, 0}, {0, side, 0}}), clear, clear, body, guide.add_group("side"),
                      volume);
  guide.add_surface(disk(0, 0.05, {{0, 0, -0.5}, {0, 0, -1}}), clear, clear, body, guide.add_group("end"), volume);
  guide.finish();
  EXPECT_GT(orders(guide, launched(guide, 1e-3, {0, 0, -0.6}, unit({0, 0.4, 1})), 0).at(0), 10);
}

// A spot 20 times wider than the mirror: 0.5 % of it fall there, and the beam ends. Control: 5 times wider, 8 %.
TEST(Ghosts, a_beam_far_wider_than_its_mirror_ends) {
  for (double const times : {20.0, 5.0}) {
    World world;
    world.wavelength = lambda;
    std::uint32_t const mirror = coated(world, 1);
    world.add_surface(disk(0, 1e-2, {{0, 0, 0}, {0, 0, -1}}), mirror, mirror, world.add_body("b", {}),
                      world.add_group("mirror"));
    world.finish();
    BeamEnergyBalance energy_balance;
    auto const all = rows(world, launched(world, times * 1e-2), {}, &energy_balance);
    double const met = 1 - std::exp(-2 / (times * times));
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].end, times > 10 ? BeamEnd::wide : BeamEnd::escaped);
    EXPECT_NEAR(times > 10 ? double(energy_balance.wide) : double(energy_balance.escaped), met, 1e-3 * met);
  }
}

}  // namespace
}  // namespace straytrace::testing
