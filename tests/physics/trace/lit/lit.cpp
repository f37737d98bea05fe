// SPDX-License-Identifier: BSD-3-Clause
// Lit surfaces down the beam: elliptic spots, spots in glass, and the phase of light that comes and goes by a chain of
// optics (docs/theory/path_integral.md, docs/theory/phase.md and docs/theory/recoupling.md).
#include <functional>
#include <random>

#include "support/trace_support.hpp"
#include "trace/tally/replay.hpp"
#include "world/ghosts/apertures.hpp"

namespace straytrace::testing::trace_lit {
namespace {

constexpr double lambda = 1.064e-6, k = 2 * pi / lambda;

// eq. 4.3 for an elliptic spot: the integral of |u|^4 is 1/(pi w1 w2), so f = q^2 beta cos(theta) lambda^2/(pi w1 w2).
SampleMean plate(double w1, double w2, double turn, double incidence) {
  World world;
  double const beta = 1e-3;
  BodyId const body = world.add_body("plate", {});
  SurfaceId const s = world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.1}, lambertian_optic(world, pi * beta),
                                        black_optic(world), body, world.add_group("plate"));
  Footprint f =
      spot(s, {}, {std::sin(incidence), 0, -std::cos(incidence)}, Profile::astigmatic, 0, world.add_port("plate"));
  Frame const plane = Frame::around(f.travel);
  Vec3 const e1 = std::cos(turn) * plane.e1 + std::sin(turn) * plane.e2;
  f.astigmatism = {e1, cross(f.travel, e1), w1, w2, 0.1, 0.02, -0.2};
  f.share = 0.5;
  world.add_footprint(f);
  world.finish();
  return total_coupling(run_histories(world, 1 << 19));
}

TEST(Lit, EllipticSpotRejoins) {
  double const expected = 0.25 * 1e-3 * std::cos(pi / 4) * lambda * lambda / (pi * 1e-3 * 0.4e-3);
  SampleMean const s = plate(1e-3, 0.4e-3, 0.6, pi / 4);
  expect_mean("elliptic spot at 45 degrees", s, expected, 1e-2 * expected);
  expect_rejected("circular with the larger radius", s, 0.4 * expected);
  expect_rejected("share counted once", s, 2 * expected);
}

// A mode that arrives at a face from inside glass, through which the face scatters; a plate outside. Both ways couple
// by lambda^2 (0.3/pi) (0.5/pi)/d^2 with lambda of vacuum: the mode in the glass takes (lambda/n)^2, and of laws
// through a face f12/n2^2 = f21/n1^2 (eq. 1.2, 3.2). Spots of 5 mm at 1 m: the geometry is 1 to 1e-4. Controls: n
// forgotten in one.
TEST(Lit, GlassTakesItsOwnEtendue) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const glass = world.add_volume({1.45, 0}), white = lambertian_optic(world, 0.5);
  Optic through;
  through.laws = 1;
  through.law[0] = world.add_law(Lambertian{0.3});
  through.through[0] = true;
  std::uint32_t const face = world.add_optic(through);
  SurfaceId const a = world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.3}, face, face, body, world.add_group("face"), glass);
  SurfaceId const b =
      world.add_surface(Disk{{0, 0, 1}, {0, 0, -1}, 0, 0.3}, white, black_optic(world), body, world.add_group("plate"));
  Footprint inside = spot(a, {}, {0, 0, 1}, Profile::gaussian, 5e-3, world.add_port("face"));
  inside.index = 1.45;
  world.add_footprint(inside);
  world.add_footprint(spot(b, {0, 0, 1}, {0, 0, 1}, Profile::gaussian, 5e-3, world.add_port("plate")));
  world.limits.max_order = 1;
  world.finish();
  TraceResult const r = run_histories(world, 1 << 17);
  double const expected = lambda * lambda * (0.3 / pi) * (0.5 / pi);
  for (char const* route : {"face·S > plate·S", "plate·S > face·S"}) {
    SampleMean const s = route_coupling(r, route);
    expect_mean(route, s, expected, 3e-2 * expected);
    expect_rejected("n^2 too much", s, expected * 1.45 * 1.45);
    expect_rejected("n^2 too little", s, expected / (1.45 * 1.45));
  }
}

// A beam that goes straight from point to point, at surfaces of the same numbers; half of it is left by each.
struct Chain {
  std::vector<BeamSpot> spots;
  std::vector<BeamStep> way;  // past all of them but the last
};
Chain chain(std::vector<Vec3> const& points, Vec3 start, std::vector<double> const& index) {
  Chain c;
  double length = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vec3 const span = points[i] - (i ? points[i - 1] : start);
    length += index[i] * straytrace::length(span);
    BeamSpot s;
    s.surface = {std::uint32_t(i)};
    s.mode = circular_mode(points[i], unit(span), 1e-3, 0, lambda / index[i]);
    s.index = index[i];
    s.power = std::pow(0.5, double(i));
    s.path_length = length;
    c.spots.push_back(s);
    if (i + 1 == points.size()) break;
    BeamStep step;
    step.surface = s.surface;
    step.point = points[i];
    step.in = s.mode.travel;
    step.out = unit(points[i + 1] - points[i]);
    step.n_in = index[i];
    step.n_out = index[i + 1];
    c.way.push_back(step);
  }
  return c;
}
void light_up(World& world, Chain const& c) {
  for (std::size_t i = 0; i < c.spots.size(); ++i)
    add_lit_surface(world, 0, 1, Feed::none, c.spots[i], std::span(c.way).first(i));
}
World lit_world(std::vector<std::uint32_t> const& bodies, std::vector<Vec3> const& pivots, Chain const& c) {
  World world;
  std::uint32_t const white = lambertian_optic(world, 0.5);
  for (Vec3 const& p : pivots) world.add_body("body", p);
  for (std::uint32_t const b : bodies)
    world.add_surface(Disk{c.spots[world.surfaces().size()].mode.origin, {0, 0, 1}, 0, 1}, white, white, BodyId{b},
                      world.add_group("any"));
  light_up(world, c);
  world.finish();
  return world;
}
PhaseSensitivity on_body(std::vector<PhaseSensitivity> const& phase_sensitivities, std::uint32_t body) {
  for (PhaseSensitivity const& l : phase_sensitivities)
    if (l.body.value == body) return l;
  return {{body}, {}};
}
// Back-scatter at the last surface of the chain.
std::vector<PhaseSensitivity> back_scatter(World const& world, std::uint32_t last) {
  Footprint const& f = world.footprints()[last];
  std::vector<PassedVertex> const one{{f.surface, f.centre, f.travel, -f.travel, Event::couple, f.index, f.index, {}}};
  return phase_sensitivities_of(world, one, last, last);
}

// Optical length from the start by all points and back again, with points moved.
double there_and_back(std::vector<Vec3> const& points, Vec3 start, std::vector<double> const& index,
                      std::function<Vec3(std::size_t)> const& moved) {
  double sum = 0;
  Vec3 last = start;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum += 2 * index[i] * length(moved(i) - last);
    last = moved(i);
  }
  return sum;
}

// eq. 2.2, 2.3: phase sensitivities of light that is fed by a chain, scattered back at its end and returned by the
// chain are the derivatives of the optical path there and back, 1e-5 k; control: the way of the beam is forgotten.
TEST(Lit, PhaseSensitivitiesOfTheChainAreDerivativesOfThePathThereAndBack) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  auto const random = [&] { return Vec3{normal(engine), normal(engine), normal(engine)}; };
  std::vector<Vec3> const pivots{{0.3, -0.2, 0.5}, {-1, 0.4, 0.1}};
  int caught = 0;
  for (int n = 0; n < 50; ++n) {
    std::vector<Vec3> const points{random(), random(), random(), random()};
    std::vector<double> const index{1, 1.45, 1.45, 1};
    std::vector<std::uint32_t> const bodies{0, 1, 1, 0};
    Vec3 const start = random();
    World const world = lit_world(bodies, pivots, chain(points, start, index));
    auto const phase_sensitivities = back_scatter(world, 3);
    for (std::uint32_t b = 0; b < 2; ++b)
      for (int axis = 0; axis < 6; ++axis) {
        Vec3 along;
        (&along.x)[axis % 3] = 1;
        auto const length_with = [&](double amount) {
          return there_and_back(points, start, index, [&](std::size_t i) {
            if (bodies[i] != b) return points[i];
            Vec3 const arm = points[i] - pivots[b];
            Vec3 const turned = std::cos(amount) * arm + std::sin(amount) * cross(along, arm) +
                                ((1 - std::cos(amount)) * dot(along, arm)) * along;
            return axis < 3 ? points[i] + amount * along : pivots[b] + turned;
          });
        };
        double const h = 1e-5, slope = k * (length_with(h) - length_with(-h)) / (2 * h);
        ASSERT_NEAR(on_body(phase_sensitivities, b).d[axis], slope, 1e-5 * k);
        Footprint const& f = world.footprints()[3];
        double const alone = b == 0 ? 2 * k * f.index * (&f.travel.x)[axis % 3] : 0;
        if (axis < 3) caught += std::fabs(alone - slope) > 1e-5 * k;
      }
  }
  EXPECT_GT(caught, 280);  // of 300
}

// A folded bench: two mirrors and a dump on one body. Moved as a whole it acts like its entrance, +2k along the beam
// that comes in (eq. 2.4), wherever the dump looks.
TEST(Lit, BenchMovesAsAWhole) {
  std::vector<Vec3> const points{{0, 0, 5}, {0, 0, 10}, {1, 0, 10}, {1, 2, 10}};  // a lens elsewhere first
  std::vector<double> const vacuum{1, 1, 1, 1};
  World const world = lit_world({0, 1, 1, 1}, {{}, {}}, chain(points, {}, vacuum));
  PhaseSensitivity const bench = on_body(back_scatter(world, 3), 1), lens = on_body(back_scatter(world, 3), 0);
  EXPECT_NEAR(bench.d[2], 2 * k, 1e-9 * k);
  EXPECT_NEAR(std::hypot(bench.d[0], bench.d[1]), 0, 1e-9 * k);
  for (double const d : lens.d) EXPECT_NEAR(d, 0, 1e-9 * k);                         // passed straight on
  World const apart = lit_world({0, 0, 0, 1}, {{}, {}}, chain(points, {}, vacuum));  // control: only the dump moves
  EXPECT_NEAR(on_body(back_scatter(apart, 3), 1).d[1], 2 * k, 1e-9 * k);
  EXPECT_NEAR(on_body(back_scatter(apart, 3), 1).d[2], 0, 1e-9 * k);
}

// A mirror of the feeding chain is passed twice, so it counts twice: 2 x 2k cos(theta) at 45 degrees along its normal.
TEST(Lit, MirrorOfTheChainCountsTwice) {
  std::vector<Vec3> const points{{0, 0, 10}, {3, 0, 10}};
  World const world = lit_world({0, 1}, {{}, {}}, chain(points, {}, {1, 1}));
  PhaseSensitivity const mirror = on_body(back_scatter(world, 1), 0);
  Vec3 const normal = unit({1, 0, -1});
  double const along = dot({mirror.d[0], mirror.d[1], mirror.d[2]}, normal);
  EXPECT_NEAR(along, -4 * k * std::cos(pi / 4), 1e-9 * k);
  EXPECT_GT(std::fabs(along + 2 * k * std::cos(pi / 4)), k);  // control: there, but not back
}

// Optical length of such a path: the way there and back (delay of eq. 2.6).
TEST(Lit, TracedPathsIncludeThePathOfTheBeam) {
  std::vector<Vec3> const points{{0, 0, 10}, {3, 0, 10}};
  World world;
  std::uint32_t const white = lambertian_optic(world, 0.5);
  BodyId const mirror = world.add_body("mirror", {}), bench = world.add_body("bench", {});
  world.add_surface(Disk{points[0], unit({1, 0, -1}), 0, 0.1}, white, white, mirror, world.add_group("mirror"));
  world.add_surface(Disk{points[1], {-1, 0, 0}, 0, 0.1}, white, white, bench, world.add_group("dump"));
  light_up(world, chain(points, {}, {1, 1}));
  world.open_port("bench", {0, 1});
  world.limits.max_order = 1;
  world.finish();
  TraceResult const r = run_histories(world, 1 << 14);
  CouplingClass const* dump = find_route(r, "dump·S");
  ASSERT_NE(dump, nullptr);
  expect_mean("q^2 beta lambda^2/(pi w^2)", route_coupling(r, "dump·S"),
              0.25 * 0.5 / pi * lambda * lambda / (pi * 1e-6), 1e-2);
  for (PathRecord const& p : dump->records) {
    EXPECT_NEAR(p.path_length, 26, 1e-9);
    EXPECT_NEAR(on_body(p.phase_sensitivities, 0).d[0], -2 * k, 1e-6 * k);
    EXPECT_NEAR(on_body(p.phase_sensitivities, 0).d[2], 2 * k, 1e-6 * k);
    EXPECT_NEAR(on_body(p.phase_sensitivities, 1).d[0], 2 * k, 1e-6 * k);
  }
  // mirror·S > dump·S: one end at the mirror itself, the other came by it and goes back by it
  CouplingClass const* both = find_route(r, "mirror·S > dump·S");
  ASSERT_NE(both, nullptr);
  EXPECT_EQ(both->reverse, 2);  // one beam: the reverse is the same port's (eq. 1.5)
  EXPECT_NEAR(both->records.front().path_length, 10 + 3 + 13, 0.01);
}

}  // namespace
}  // namespace straytrace::testing::trace_lit
