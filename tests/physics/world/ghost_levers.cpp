// SPDX-License-Identifier: BSD-3-Clause
// Complex levers of ghosts (docs/theory/ghosts.md, eq. N.27) against the exact overlap of the moved scene.
#include <gtest/gtest.h>

#include "support/ghost_support.hpp"

namespace straytrace::testing::ghost_levers {
namespace {

// T28: a beam of 5 mm, 20 urad off its line: d ln K/d alpha = -k^2 w^2 alpha/4, of the field.
TEST(GhostLevers, TiltOfABeamT28) {
  constexpr double alpha = 20e-6, w = 5e-3, expected = -4359.0;
  Mode const line = circular_mode({}, {0, 0, 1}, w, 0, lambda),
             tilted = circular_mode({}, {std::sin(alpha), 0, std::cos(alpha)}, w, 0, lambda);
  Amplitude const found = overlap_slope(tilted, line).of({}, {1, 0, 0});
  EXPECT_NEAR(found.real() / expected, 1, 1e-4);
  EXPECT_LT(std::abs(found.imag()), 1e-3);
  double const step = 1e-9;
  auto const power = [&](double a) {
    return log_power_overlap(circular_mode({}, {std::sin(a), 0, std::cos(a)}, w, 0, lambda), line);
  };
  EXPECT_NEAR((power(alpha + step) - power(alpha - step)) / (2 * step) / expected, 2, 1e-3) << "control: of the power";
  EXPECT_LT(std::abs(overlap_slope(line, line).of({}, {1, 0, 0})), 1e-6) << "control: in line";
}

// Eq. N.7: of a shifted beam at its waist, the tilt turns the phase about the middle between both: -i k d/2.
TEST(GhostLevers, TiltOfAShiftedBeam) {
  constexpr double d = 1e-3, w = 5e-3;
  Mode const line = circular_mode({}, {0, 0, 1}, w, 0, lambda),
             shifted = circular_mode({d, 0, 0}, {0, 0, 1}, w, 0, lambda);
  OverlapSlope const slope = overlap_slope(shifted, line);
  EXPECT_NEAR(slope.of({}, {1, 0, 0}).imag() / (-pi / lambda * d), 1, 1e-6);
  EXPECT_NEAR(slope.of({1, 0, 0}, {}).real() / (-d / (w * w)), 1, 1e-6);  // of exp(-d^2/(2 w^2)), eq. 5.2
}

using Coordinates = std::array<double, 6>;

struct Moved {
  Vec3 pivot;
  Coordinates x{};
  Vec3 turned(Vec3 v) const {
    Vec3 const by{x[3], x[4], x[5]};
    double const angle = length(by);
    if (!(angle > 0)) return v;
    Vec3 const axis = (1 / angle) * by;
    return v + std::sin(angle) * cross(axis, v) + 2 * std::pow(std::sin(angle / 2), 2) * cross(axis, cross(axis, v));
  }
  Placement place(Vec3 point, Vec3 axis) const {
    return {pivot + turned(point - pivot) + Vec3{x[0], x[1], x[2]}, turned(axis)};
  }
};

// A lens on one body, out of line, and a curved mirror on another one, tilted by 30 urad: the ghost of the mirror.
constexpr Vec3 pivot_of_lens{0.01, -0.02, 0.05}, pivot_of_mirror{-0.03, 0.01, 0.6};
World bench(Coordinates const& lens, Coordinates const& mirror, double reflects = 0) {
  World world;
  world.wavelength = lambda;
  constexpr double n = 1.45, d = 0.008, roc = 2, tilt = 30e-6;
  std::uint32_t const clear = coated(world, reflects), weak = coated(world, 1e-3), volume = world.add_volume({n, 0});
  BodyId const first = world.add_body("lens", pivot_of_lens), second = world.add_body("mirror", pivot_of_mirror);
  Moved const a{pivot_of_lens, lens}, b{pivot_of_mirror, mirror};
  Vec3 const axis = unit({2e-4, -1e-4, 1});
  world.add_surface(cap(-1 / roc, 0, 0.05, a.place({2e-4, 1e-4, 0}, -axis)), clear, clear, first,
                    world.add_group("front"), volume);
  world.add_surface(cap(-1 / roc, 0, 0.05, a.place({2e-4, 1e-4, d}, axis)), clear, clear, first,
                    world.add_group("back"), volume);
  world.add_surface(cap(0.3, 0, 0.05, b.place({0, 0, 0.6}, unit({tilt, 0.5 * tilt, -1}))), weak, weak, second,
                    world.add_group("mirror"));
  world.finish();
  return world;
}
World bench_of(int coordinate, double by, double reflects = 0) {
  Coordinates lens{}, mirror{};
  (coordinate < 6 ? lens : mirror)[std::size_t(coordinate % 6)] = by;
  return bench(lens, mirror, reflects);
}

BeamLaunch light(World const& world) { return launched(world, 3e-3, {0, 0, -1}); }

struct Return {
  Amplitude field;
  std::vector<PhaseSensitivity> phases;
  std::vector<OverlapLever> levers;
};
Return ghost_of(World const& world, std::uint32_t order = 1, bool against = true) {
  BeamLaunch const launch = light(world);
  MainBeam const main(world, launch, {});
  Rows sink(&main);
  grow_tree(world, launch, {}, sink);
  for (Row const& r : sink.all)
    if (Recoupling const& back = r.standing.recoupled; r.order == order && back.any && back.against == against)
      return {back.field[0], main.phase_sensitivities(back, r.way), main.overlap_levers(back, r.way)};
  ADD_FAILURE() << "no ghost";
  return {};
}

double phase_lever(Return const& r, int coordinate) {
  for (PhaseSensitivity const& s : r.phases)
    if (s.body.value == std::uint32_t(coordinate / 6)) return s.d[coordinate % 6];
  return 0;
}
Amplitude lever(Return const& r, int coordinate) {
  for (OverlapLever const& l : r.levers)
    if (l.body.value == std::uint32_t(coordinate / 6)) return l.d[std::size_t(coordinate % 6)];
  return 0;
}

// The field of the scene with one body moved both ways, less the phase at the hits.
Amplitude by_difference(int coordinate, double phase, auto const& ghost) {
  double const step = coordinate % 6 < 3 ? 1e-6 : 1e-7;
  Amplitude sum = 0;
  for (double const sign : {1.0, -1.0})
    sum += sign *
           std::log(ghost(coordinate, sign * step).field * std::polar(1.0, -sign * phase * step) / ghost(0, 0).field);
  return sum / (2 * step);
}

TEST(GhostLevers, OverlapOfAMovedLensAndMirror) {
  auto const ghost = [](int coordinate, double by) { return ghost_of(bench_of(coordinate, by)); };
  Return const at_rest = ghost(0, 0);
  double const most = std::abs(lever(at_rest, 10));
  EXPECT_GT(most, 1000) << "a tilt of the mirror matters";
  EXPECT_GT(std::abs(lever(at_rest, 0)), 100) << "a shift of the lens matters";
  for (int c = 0; c < 12; ++c) {
    Amplitude const found = lever(at_rest, c), expected = by_difference(c, phase_lever(at_rest, c), ghost);
    double const allowed = 1;  // 1/m, 1/rad: changes of the curvature are left out
    EXPECT_NEAR(found.real(), expected.real(), allowed + 2e-3 * std::abs(expected)) << "coordinate " << c;
    EXPECT_NEAR(found.imag(), expected.imag(), allowed + 2e-3 * std::abs(expected)) << "coordinate " << c;
  }
  EXPECT_GT(std::abs(lever(at_rest, 4)), 10) << "control: the lens, met on both ways, counts";
}

// Light that is reflected twice in the lens and leaves it with the main beam, which the lens moves too.
TEST(GhostLevers, WithAMainBeamThatMoves) {
  auto const ghost = [](int coordinate, double by) { return ghost_of(bench_of(coordinate, by, 1e-3), 2, false); };
  Return const at_rest = ghost(0, 0);
  for (int const c : {0, 1, 3, 4}) {
    Amplitude const found = lever(at_rest, c), expected = by_difference(c, phase_lever(at_rest, c), ghost);
    EXPECT_GT(std::abs(expected), 100) << "it matters: coordinate " << c;
    EXPECT_LT(std::abs(found - expected), 5e-3 * std::abs(expected)) << "coordinate " << c;
  }
}

// A hole off the axis that moves: of 1 - t, eq. N.11, of the ghost of a plate behind it. Centred: none.
TEST(GhostLevers, MovingHole) {
  constexpr double a = 5e-3;
  auto const world_of = [&](double off) {
    World world;
    world.wavelength = lambda;
    std::uint32_t const plate = coated(world, 1e-3), black = black_optic(world);
    BodyId const mount = world.add_body("mount", {}), rest = world.add_body("plate", {});
    world.add_surface(disk(a, 1, {{off, 0, 0}, {0, 0, -1}}), black, black, mount, world.add_group("mount"));
    world.add_surface(disk(0, 1, {{0, 0, 0.5}, {0, 0, -1}}), plate, plate, rest, world.add_group("plate"));
    world.finish();
    return world;
  };
  double const off = 1e-3, step = 1e-6;
  auto const log_field = [&](double at) { return std::log(std::abs(ghost_of(world_of(at)).field)); };
  double const expected = (log_field(off + step) - log_field(off - step)) / (2 * step);
  Amplitude const found = lever(ghost_of(world_of(off)), 0);
  EXPECT_LT(expected, -1);
  EXPECT_NEAR(found.real() / expected, 1, 1e-3);
  EXPECT_LT(std::abs(lever(ghost_of(world_of(0)), 0)), 1e-3) << "control: centred";
}

}  // namespace
}  // namespace straytrace::testing::ghost_levers
