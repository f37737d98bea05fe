// SPDX-License-Identifier: BSD-3-Clause
// Properties that the beam tree carries: clipping at edges, the energy balance, polarisation, phase sensitivities, and
// its memory.
#include <gtest/gtest.h>

#include <cstdio>
#include <unistd.h>

#include "beams/overlap.hpp"
#include "support/ghost_support.hpp"
#include "world/ghosts/obstacle.hpp"

namespace straytrace::testing {
namespace {

template <class Shape>
double beside(Shape const& shape, double w, Vec3 centre = {}, Vec3 travel = {0, 0, 1}) {
  World world;
  world.wavelength = lambda;
  std::uint32_t const black = black_optic(world);
  SurfaceId const id = world.add_surface(shape, black, black, world.add_body("b", {}), world.add_group("g"));
  world.finish();
  WorldView const view = world.view();
  return beside_rim(view, id, circular_mode(centre, travel, w, 0, lambda));
}
Ellipse round_by_scan(double a) {
  Ellipse e;
  e.semi_x = e.semi_y = a;
  e.place({});
  return e;
}

// Case A8, eq. 5.5: w = 58 mm in a = 170 mm; eq. 5.6 with an offset; in closed form and by lines that miss.
TEST(GhostRims, share_outside_a_round_mirror) {
  double const w = 0.058, a = 0.17;
  EXPECT_NEAR(beside(disk(0, a), w) / 3.4513e-8, 1, 1e-4);
  EXPECT_NEAR(beside(cap(1 / 1683.0, 0, a), w) / 3.4513e-8, 1, 1e-3);  // w where the beam crosses the plane of the rim
  EXPECT_NEAR(beside(round_by_scan(a), w) / std::exp(-2 * a * a / (w * w)), 1, 1e-9);
  for (double d : {0.02, 0.05, 0.1}) {
    double const expected = clipped_share(a, w, d);
    EXPECT_NEAR(beside(disk(0, a), w, {d, 0, 0}) / expected, 1, 1e-9);
    EXPECT_NEAR(beside(round_by_scan(a), w, {d, 0, 0}) / expected, 1, 1e-3);
    EXPECT_GT(beside(disk(0, a), w, {d, 0, 0}), 1.2 * beside(disk(0, a), w));  // control: the offset forgotten
  }
  EXPECT_EQ(beside(disk(0, 1), w), 0);
}

TEST(GhostRims, share_outside_other_edges) {
  double const w = 0.03;
  double const inside = std::erf(std::sqrt(2) * 0.04 / w) * std::erf(std::sqrt(2) * 0.03 / w);
  EXPECT_NEAR(beside(rectangle(0.08, 0.06), w) / (1 - inside), 1, 2e-3);
  // a ring: the light in its hole passes as well
  double const ring = 1 - std::exp(-2 * 0.01 * 0.01 / (w * w)) + std::exp(-2 * 0.05 * 0.05 / (w * w));
  EXPECT_NEAR(beside(disk(0.01, 0.05), w), ring, 1e-9);
  // turned by 60 degrees, the disk is half as wide as seen by the beam
  double const wide = beside(disk(0, 0.05), w), turned = beside(disk(0, 0.05), w, {}, unit({std::sqrt(3.0), 0, 1}));
  EXPECT_GT(turned, 10 * wide);
  EXPECT_NEAR(turned, clipped_share(0.05, std::array{2 * w, w}, {0, 0}), 1e-9);
}

// R2.24: each watt is on an object, in a medium, outside an edge, out of the scene or cut, with names.
TEST(GhostEnergyBalance, every_watt_is_counted_once) {
  World world = plate(0.04, 1.45, 0.01, 1e-3, 0.006);
  world.add_surface(disk(0, 0.5, {{0, 0, 1}, {0, 0, -1}}), lambertian_optic(world, 0.3), 0, world.add_body("dump", {}),
                    world.add_group("dump"));
  world.finish();
  BeamEnergyBalance energy_balance;
  rows(world, launched(world), {1e-6, 3, 1000}, &energy_balance);
  EXPECT_NEAR(energy_balance.total(), 1, 1e-14);
  BeamEnergyBalance::Object const &front = energy_balance.objects[0], &dump = energy_balance.objects[2];
  EXPECT_NEAR(front.beside, std::exp(-2 * 36.0 / 25.0), 3e-3);  // ghosts that come back add a little
  // The back face lies in the shadow of the front. Control: it clips a whole Gaussian again.
  EXPECT_NEAR(dump.landed, (1 - std::exp(-2 * 36.0 / 25.0)) * 0.96 * 0.96, 3e-3);
  EXPECT_GT(std::fabs(dump.landed - std::pow(1 - std::exp(-2 * 36.0 / 25.0), 2) * 0.96 * 0.96), 0.03);
  EXPECT_NEAR(dump.scattered, 0.3 * (dump.landed), 1e-12);
  EXPECT_GT(dump.ghosts, 1e-4);
  EXPECT_GT(energy_balance.floor + energy_balance.order, 0);
  EXPECT_GT(std::fabs(energy_balance.total() - dump.landed - 1), 0.1);  // control: without one object
}

// Fresnel at 45 degrees (eq. 3.25): unpolarised light is the even mixture of two states, and stays that mixture.
double reflected_at_45(int states, bool p_state) {
  World world;
  world.wavelength = lambda;
  std::uint32_t const glass = glass_optic(world), volume = world.add_volume({1.5, 0});
  double const s = std::sqrt(0.5);
  world.add_surface(disk(0, 0.5, {{0, 0, 0}, {s, 0, -s}}), glass, glass, world.add_body("g", {}),
                    world.add_group("front"), volume);
  world.finish();
  BeamLaunch beam = launched(world);
  beam.field.axis = {0, 1, 0};
  beam.field.states = states;
  if (p_state) beam.field.state[0] = {{0, 0}, {1, 0}};
  beam.field.state[1] = {{0, 0}, {1, 0}};
  for (Row const& r : rows(world, beam))
    if (r.mode.travel.x > 0.9) return r.power;
  return 0;
}
TEST(GhostPolarisation, fresnel_for_each_state) {
  double const c1 = std::sqrt(0.5), c2 = std::sqrt(1 - 0.5 / 2.25);
  double const rs = (c1 - 1.5 * c2) / (c1 + 1.5 * c2), rp = (1.5 * c1 - c2) / (1.5 * c1 + c2);
  EXPECT_NEAR(reflected_at_45(1, false), rs * rs, 1e-12);
  EXPECT_NEAR(reflected_at_45(1, true), rp * rp, 1e-12);
  EXPECT_NEAR(reflected_at_45(2, false), 0.5 * (rs * rs + rp * rp), 1e-12);
  EXPECT_GT(std::fabs(reflected_at_45(1, false) - rp * rp), 0.05);  // control: s and p exchanged
}

double phase_sensitivity(std::vector<PhaseSensitivity> const& phase_sensitivities, std::uint32_t body, int axis) {
  for (PhaseSensitivity const& l : phase_sensitivities)
    if (l.body.value == body) return l.d[axis];
  return 0;
}

// Section 2: a reflection inside glass counts n k twice, a plate moved as a whole nothing in transmission and 2 k in
// reflection.
TEST(GhostPhaseSensitivities, plate_in_one_body_and_in_two) {
  double const k = 2 * pi / lambda, n = 1.45;
  for (bool two : {false, true}) {
    World world;
    world.wavelength = lambda;
    std::uint32_t const optic = coated(world, 1e-3), volume = world.add_volume({n, 0});
    BodyId const a = world.add_body("a", {}), b = two ? world.add_body("b", {}) : a;
    world.add_surface(disk(0, 0.5, {{0, 0, 0}, {0, 0, -1}}), optic, optic, a, world.add_group("front"), volume);
    world.add_surface(disk(0, 0.5, {{0, 0, 0.01}, {0, 0, 1}}), optic, optic, b, world.add_group("back"), volume);
    world.finish();
    BeamLaunch const launch = launched(world);
    MainBeam const main(world, launch, {});
    for (Row const& r : rows(world, launch)) {
      if (r.order == 0 || r.order > 2) continue;
      auto const phase_sensitivities = main.phase_sensitivities(r.standing.recoupled, r.way);
      bool const from_back = r.way[0].event == Event::transmit;
      if (r.order == 2) {
        EXPECT_NEAR(phase_sensitivity(phase_sensitivities, 0, 2), two ? -2 * n * k : 0, 1e-6 * k);
        EXPECT_NEAR(phase_sensitivity(phase_sensitivities, 1, 2), two ? 2 * n * k : 0, 1e-6 * k);
        EXPECT_FALSE(r.standing.recoupled.against);
      } else {
        EXPECT_NEAR(phase_sensitivity(phase_sensitivities, 0, 2), two && from_back ? 2 * (1 - n) * k : 2 * k, 1e-6 * k);
        EXPECT_NEAR(phase_sensitivity(phase_sensitivities, 1, 2), two && from_back ? 2 * n * k : 0,
                    1e-6 * k);  // control: 2 k, no index
        EXPECT_TRUE(r.standing.recoupled.against);
      }
    }
  }
}

// A cavity leaks through its end mirror, and a surface behind it sends a part back: f = T R T (eq. 5.4), and only the
// motion against the mirror counts (eq. 2.5).
TEST(GhostPhaseSensitivities, behind_an_end_mirror) {
  double const k = 2 * pi / lambda, t = 4e-6, back = 1e-3;
  World world;
  world.wavelength = lambda;
  Optic hr;
  hr.reflect = 1 - t;
  hr.transmit = t;
  std::uint32_t const mirror = world.add_optic(hr), bench = mirror_optic(world, back);
  BodyId const etm = world.add_body("ETM", {}), table = world.add_body("bench", {});
  SurfaceId const end =
      world.add_surface(disk(0, 0.5, {{0, 0, 10}, {0, 0, -1}}), mirror, mirror, etm, world.add_group("ETM"));
  world.add_surface(disk(0, 0.5, {{0, 0, 11}, {0, 0, -1}}), bench, bench, table, world.add_group("lens"));
  world.finish();
  BeamLaunch launch = launched(world, 0.05, {0, 0, 10});
  launch.arrives_at = end;
  launch.cavity = {end};
  MainBeam const main(world, launch, {1e-20});
  bool found = false;
  for (Row const& r : rows(world, launch, {1e-20})) {
    if (r.end != BeamEnd::rejoined || r.way.size() != 3) continue;
    found = true;
    Recoupling const& back_in = r.standing.recoupled;
    ASSERT_TRUE(back_in.any && back_in.against);
    EXPECT_NEAR(back_in.share() / (t * t * back), 1, 1e-4);  // 1: the overlap of 2 m of flight at 50 mm
    auto const phase_sensitivities = main.phase_sensitivities(back_in, r.way);
    EXPECT_NEAR(phase_sensitivity(phase_sensitivities, 1, 2), 2 * k, 1e-9 * k);
    EXPECT_NEAR(phase_sensitivity(phase_sensitivities, 0, 2), -2 * k,
                1e-9 * k);  // control: 0, when the main mode's own bounce is forgotten
    // eq. N.29: light met the bench 1 m of way ago, and the mode is reflected now.
    for (PhaseSensitivity const& s : phase_sensitivities)
      EXPECT_NEAR(s.moment[2] * speed_of_light, s.body == table ? 2 * k : 0, 1e-9 * k);
  }
  EXPECT_TRUE(found);
}

double resident_megabytes() {
  long pages = 0, resident = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%ld %ld", &pages, &resident) != 2) resident = 0;
    std::fclose(file);
  }
  return double(resident) * double(sysconf(_SC_PAGESIZE)) / 1048576;
}

// The tree holds one branch and the pending ones on its way: more ghosts need no more memory.
TEST(GhostMemory, does_not_grow_with_their_number) {
  World world;
  world.wavelength = lambda;
  std::uint32_t const optic = coated(world, 0.04);
  for (int i = 0; i < 4; ++i) {
    std::uint32_t const volume = world.add_volume({1.45, 0});
    BodyId const body = world.add_body("plate", {});
    world.add_surface(disk(0, 0.5, {{0, 0, 0.1 * i}, {0, 0, -1}}), optic, optic, body, world.add_group("f"), volume);
    world.add_surface(disk(0, 0.5, {{0, 0, 0.1 * i + 0.01}, {0, 0, 1}}), optic, optic, body, world.add_group("b"),
                      volume);
  }
  world.finish();
  BeamLaunch const launch = launched(world);
  BeamSink nobody;
  BeamEnergyBalance const few = grow_tree(world, launch, {1e-6}, nobody);
  double const before = resident_megabytes();
  BeamEnergyBalance const many = grow_tree(world, launch, {1e-10}, nobody);
  std::printf("%llu ghosts, then %llu, %.1f MB more\n", static_cast<unsigned long long>(few.beams),
              static_cast<unsigned long long>(many.beams), resident_megabytes() - before);
  EXPECT_GT(many.beams, 20 * few.beams);
  EXPECT_LT(resident_megabytes() - before, 1);
  EXPECT_NEAR(many.total(), 1, 1e-12);
}

}  // namespace
}  // namespace straytrace::testing
