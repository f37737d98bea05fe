// SPDX-License-Identifier: BSD-3-Clause
// Light of a beam that starts in empty space, scattered once and then seen through glass or in a mirror
// (docs/theory/sampling.md): sub-paths from the receiver meet what the beam lights. Truth: small receivers on the axis
// of an even disc of radiance rho/(pi A), irradiance pi L sin^2; view factors between coaxial discs; the walk alone.
#include "support/trace_received.hpp"

namespace straytrace::testing::trace_free_beams {
namespace {

constexpr double rho = 0.5, height = 0.2;  // m, of the receiver above the card

struct Layout {
  Profile profile = Profile::even;
  double radius = 0.1, curvature = 0, start = 0.05;  // m and 1/m, of the beam; m before the card
  Vec3 travel{0, 0, -1};
  double receiver = 1e-3;  // m
  double clear = 0;        // share of light that passes the card unscattered
  bool glass_first = false, aims = false, second_beam = false;
};

// A white card in the plane z = 0; above it a free beam that shines down, a window of index 1, and a receiver that
// looks down through it. The beam starts below the window; `glass_first`: another window lies between beam and card.
World card_behind_a_window(Layout const& s, bool covered) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world);
  Optic card;
  card.laws = 1;
  card.law[0] = world.add_law(Lambertian{rho});
  card.transmit = s.clear;
  world.add_surface(disk(0, 0.3, {{}, {0, 0, 1}}), world.add_optic(card), black, body, world.add_group("card"));
  receive_on(
      world, "eye",
      world.add_surface(disk(0, s.receiver, {{0, 0, height}, {0, 0, -1}}), black, black, body, world.add_group("eye")));
  add_plate(world, "window", 1, 0.1, 0.11);
  if (s.glass_first) add_plate(world, "first", 1, 0.02, 0.03);
  world.add_footprint(
      free_beam(world.add_group("laser"), -s.start * s.travel, s.travel, s.profile, s.radius, s.curvature));
  if (s.second_beam)  // meets nothing: half of the histories start with it
    world.add_footprint(free_beam(world.add_group("other"), {5, 0, 0}, {1, 0, 0}, Profile::even, 1e-3, 0, 1));
  world.limits.max_order = 8;
  world.limits.route_vertices = 10;
  world.limits.roulette_below = 0;
  world.finish();
  if (covered) find_covered_receivers(world);
  EXPECT_EQ(world.receivers()[0].behind_glass, covered);
  if (s.aims) world.steer(make_importance(world));
  return world;
}
SampleMean watts(Layout const& s, bool covered, std::uint64_t histories) {
  return received(run_histories(card_behind_a_window(s, covered), histories));
}

// A small receiver over an even disc of radius a.
double seen(double a, double receiver) { return rho * receiver * receiver / (a * a + height * height); }

// Radius on the card: a (1 + L C), also behind a focus.
TEST(FreeBeams, ThroughAWindow) {
  for (double const grown : {1.0, 1.8, 0.5, -1.3}) {
    Layout s;
    s.curvature = (grown - 1) / s.start;
    double const expected = seen(s.radius * grown, s.receiver);
    SampleMean const w = watts(s, true, 1 << 17);
    expect_mean("window", w, expected, 0.08 * expected);
    double const parallel =
        rho * s.receiver * s.receiver / (grown * grown) / (0.01 + 0.04);  // sin^2 of a parallel beam
    if (grown != 1) expect_rejected("parallel light of that irradiance", w, parallel);
  }
}

// One beam of two, a card with gaps, aimed directions: the light is the same.
TEST(FreeBeams, ThroughAWindowWithOtherReceivers) {
  Layout two, clear, aims;
  two.second_beam = aims.aims = true;
  clear.clear = 0.45;
  for (Layout const& s : {two, clear, aims}) {
    double const expected = seen(s.radius, s.receiver);
    SampleMean const w = watts(s, true, 1 << 17);
    expect_mean("window", w, expected, 0.05 * expected);
    expect_rejected("twice", w, 2 * expected);
  }
}

// The score of each technique, and the score of the walk without the other technique.
struct Parts : Silent {
  Sampler walk, through, both;
  double walked = 0, seen = 0;
  void score(PathState const&, Vertex const&, std::uint32_t, std::uint32_t, Vertex const&, double power) {
    walked += power;
  }
  void score_lit(PathState const&, std::uint32_t, Vertex const&, Chain const&, std::uint32_t, Vertex const&,
                 double power) {
    seen += power;
  }
  void close() {
    walk.add(walked);
    through.add(seen);
    both.add(walked + seen);
    walked = seen = 0;
  }
};
Parts parts(Layout const& s, bool covered, std::uint64_t histories, std::uint64_t seed = 1) {
  World const world = card_behind_a_window(s, covered);
  Parts found;
  walk(
      world, histories, found, [&] { found.close(); }, seed);
  return found;
}

// A wide receiver is met by the walk about as often as by sub-paths: their weights sum to one. Controls: either counted
// in full in addition to the other.
TEST(FreeBeams, WeightsOfWalkAndSubPathSumToOne) {
  Layout even, gaussian, focus, clear, aims, two;
  gaussian.profile = Profile::gaussian;
  gaussian.travel = unit({0.3, 0.1, -1});
  gaussian.radius = 0.08;
  focus.curvature = -2.4 / focus.start;
  clear.clear = 0.45;
  aims.aims = two.second_beam = true;
  for (Layout s : {even, gaussian, focus, clear, aims, two}) {
    s.receiver = 0.12;
    Parts const alone = parts(s, false, 1 << 18, 2), shared = parts(s, true, 1 << 17);
    SampleMean const expected = alone.walk.mean();
    EXPECT_EQ(alone.through.mean().mean, 0);
    EXPECT_GT(shared.walk.mean().mean, 0.1 * expected.mean);
    EXPECT_GT(shared.through.mean().mean, 0.1 * expected.mean);
    expect_mean("both", difference(shared.both.mean(), expected), 0, 0.1 * expected.mean);
    SampleMean const doubled = difference(shared.through.mean(), scaled(expected, -1));
    expect_rejected("sub-paths beside the whole walk", doubled, expected.mean);
    expect_rejected("the walk's part alone", difference(shared.walk.mean(), expected), 0);
  }
}
TEST(FreeBeams, WideReceiverViewFactor) {
  double const radius = 0.09, big = 0.1, s = 1 + (height * height + radius * radius) / (big * big);
  double const factor = 0.5 * (s - std::sqrt(s * s - 4 * radius * radius / (big * big)));  // coaxial discs
  Layout wide;
  wide.receiver = radius;
  SampleMean const w = watts(wide, true, 1 << 18);
  expect_mean("view factor", w, rho * factor, 0.03 * rho * factor);
  expect_rejected("twice", w, 2 * rho * factor);
}

// No straight way from the beam to the card: the walk alone counts, with its whole weight.
TEST(FreeBeams, GlassBeforeTheCardUsesTheWalkOnly) {
  Layout s;
  s.glass_first = true;
  s.receiver = 0.09;
  Parts const alone = parts(s, false, 1 << 15), shared = parts(s, true, 1 << 15);
  EXPECT_EQ(shared.through.mean().mean, 0);
  EXPECT_EQ(shared.walk.mean().mean, alone.walk.mean().mean);
  EXPECT_GT(alone.walk.mean().mean, 0);
}

// A thin laser on a tilted card, a small mirror that shows the card to a receiver; they see each other directly too.
struct Folded {
  double receiver = 2e-3;  // m
  bool covered = true, both_sides = false;
};
World folded(Folded const& s) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), silver = mirror_optic(world, 0.9);
  world.add_surface(disk(0, 0.03, {{}, unit({1, 0, 1})}), lambertian_optic(world, rho), black, body,
                    world.add_group("card"));
  world.add_surface(disk(0, 0.03, {{0.2, 0, 0}, unit({-1, 0, 1})}), silver, black, body, world.add_group("mirror"));
  receive_on(
      world, "eye",
      world.add_surface(disk(0, s.receiver, {{0.2, 0, 0.2}, {0, 0, -1}}), black, black, body, world.add_group("eye")),
      true, s.both_sides);
  world.add_footprint(free_beam(world.add_group("laser"), {0, 0, 0.3}, {0, 0, -1}, Profile::even, 3e-3));
  world.limits.roulette_below = 0;
  world.finish();
  if (s.covered) find_covered_receivers(world);
  EXPECT_EQ(world.receivers()[0].aims, s.covered ? 1u : 0u);  // sub-paths start towards the mirror
  return world;
}
// Power by way of the mirror; paths are found again by their address.
SampleMean by_the_mirror(Folded const& s, std::uint64_t histories, std::uint64_t seed = 1) {
  TraceResult const r = run_histories(folded(s), histories, seed);
  for (CouplingClass const& c : r.coupling.received)
    if (received_name(r.coupling, c) == "laser·B > card·S > mirror·R > eye·D") {
      for (PathRecord const& record : c.records) EXPECT_NEAR(record.path_length, 0.3 + 0.4, 0.03 + s.receiver);
      return {c.coupling.mean, c.coupling.std_error, (long long)histories};
    }
  return {};
}

// rho R cos A/(pi d^2), d = 0.4 m by way of the mirror, cos = 1/sqrt(2) at the card.
TEST(FreeBeams, InASmallMirror) {
  for (bool const both : {false, true}) {
    double const expected = rho * 0.9 * std::sqrt(0.5) * 4e-6 / 0.16;
    SampleMean const w = by_the_mirror({.both_sides = both}, 1 << 18);
    expect_mean("mirror", w, expected, 0.5 * expected);
    expect_rejected("starts towards the mirror taken for even ones", w, 0.25 * expected);
  }
}
TEST(FreeBeams, WeightsOfAimedSubPathsSumToOne) {
  SampleMean const alone = by_the_mirror({.receiver = 0.02, .covered = false}, 1 << 21, 2),
                   both = by_the_mirror({.receiver = 0.02}, 1 << 19);
  expect_mean("both", difference(both, alone), 0, 0.3 * alone.mean);
  EXPECT_LT(both.std_error, 1.5 * alone.std_error);  // of a quarter of the histories
  expect_rejected("twice", difference(both, scaled(alone, 2)), 0);
}

// A laser on a white card in a tube, next to a mirror whose spot scatters 1e-4: the contribution of the mirror must
// not decide how often that of the laser is split. With one level for both there are 50 times as many events.
World laser_beside_a_faint_spot() {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const black = black_optic(world), white = lambertian_optic(world, 0.9);
  SurfaceId const mirror =
      world.add_surface(disk(0, 0.2), lambertian_optic(world, 1e-4), black, body, world.add_group("mirror"));
  world.add_surface(cylinder(0.5, -1, 5), black, lambertian_optic(world, 0.1), body, world.add_group("tube"));
  world.add_surface(disk(0, 0.05, {{0, 0.2, 3}, {0, 0, -1}}), white, black, body, world.add_group("card"));
  receive_on(
      world, "eye",
      world.add_surface(disk(0, 2e-3, {{0, 0.1, 2.6}, unit({0, 0.3, 1})}), black, black, body, world.add_group("eye")));
  world.add_footprint(spot(mirror, {}, {0, 0, -1}, Profile::gaussian, 0.05, world.add_port("mirror")));
  world.add_footprint(
      free_beam(world.add_group("laser"), {0.1, 0.2, 2.6}, {-0.25, 0, 1}, Profile::gaussian, 5e-3, 0, 1));
  world.limits.max_order = 8;
  world.finish();
  return world;
}

TEST(FreeBeams, FirstVertexSetsTheLevelOfTheWindow) {
  World world = laser_beside_a_faint_spot();
  SteeringTables tables = make_importance(world);
  ASSERT_GT(tables.level, 0);
  world.steer(tables);
  TraceResult const kept = run_histories(world, 1 << 14);
  tables.level = 0;  // no window
  world.steer(tables);
  TraceResult const free = run_histories(world, 1 << 14);
  EXPECT_LT(kept.total.bounces, 4 * free.total.bounces);
  SampleMean const a = received(kept), b = received(free);
  EXPECT_NEAR(a.mean, b.mean, 5 * std::hypot(a.std_error, b.std_error));
}

// A beam that only passes: it illuminates no surface that scatters, so no light is stray, and every history ends at its
// start.
TEST(FreeBeams, NothingThatScattersEmitsNothing) {
  for (bool const emits : {false, true}) {
    World world;
    world.add_body("all", {});
    Footprint beam = free_beam(world.add_group("laser"), {}, {0, 0, 1}, Profile::even, 1e-3, 0);
    beam.emits = emits;
    world.add_footprint(beam);
    world.finish();
    BlockSums const sums = run_histories(world, largest_block).total;
    EXPECT_EQ(sums.histories, largest_block);
    if (emits)
      EXPECT_GT(sums.emitted.sum, 0);
    else
      EXPECT_EQ(sums.emitted.sum, 0);
  }
}

}  // namespace
}  // namespace straytrace::testing::trace_free_beams
