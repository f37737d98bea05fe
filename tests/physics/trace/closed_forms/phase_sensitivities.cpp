// SPDX-License-Identifier: BSD-3-Clause
// Phase of a path under motion: case A1, the rigid-body invariant (R4.06), the cavity rule (eq. 2.5)
// and rotations against the optical path itself.
#include <functional>
#include <random>

#include "support/sequential.hpp"
#include "support/trace_support.hpp"
#include "trace/tally/replay.hpp"

namespace straytrace::testing::trace_phase_sensitivities {
namespace {

constexpr double k = 2 * pi / 1.064e-6;

Vec3 along(PhaseSensitivity const& l) { return {l.d[0], l.d[1], l.d[2]}; }
Vec3 turning(PhaseSensitivity const& l) { return {l.d[3], l.d[4], l.d[5]}; }
bool close(Vec3 a, Vec3 b, double tolerance) { return length(a - b) <= tolerance * (length(a) + length(b)) / 2; }
PhaseSensitivity on_body(std::vector<PhaseSensitivity> const& phase_sensitivities, BodyId body) {
  for (PhaseSensitivity const& l : phase_sensitivities)
    if (l.body == body) return l;
  return {body, {}};
}

// As many bodies of one surface each as wanted; surface i belongs to body bodies[i].
World bodies_world(std::vector<std::uint32_t> const& bodies, std::vector<Vec3> const& pivots) {
  World world;
  std::uint32_t const black = black_optic(world);
  for (Vec3 const& p : pivots) world.add_body("body", p);
  for (std::uint32_t const b : bodies) world.add_surface(Disk{}, black, black, BodyId{b}, world.add_group("any"));
  world.add_footprint(
      spot({0}, {}, {0, 0, -1}, Profile::gaussian, 1e-3));  // not a standing wave: no main mode to subtract
  world.finish();
  return world;
}

// docs/theory/conventions.md, eq. 0.2, case A1.
double bounce(Vec3 in, Vec3 out, Vec3 moved, int times = 1) {
  World const world = bodies_world({0}, {{}});
  std::vector<PassedVertex> const hits(std::size_t(times), PassedVertex{{0}, {}, in, out});
  return dot(along(phase_sensitivities_of(world, hits, 0, 0)[0]), moved);
}

TEST(PhaseSensitivities, MovingBounceA1) {
  double const s45 = std::sin(pi / 4), nm = 1e-9, tolerance = 1e-9;  // rad
  Vec3 const in45{s45, 0, -s45}, out45{s45, 0, s45}, out30{0, 0.5, std::cos(pi / 6)};
  EXPECT_NEAR(bounce({0, 0, 1}, {0, 0, -1}, {0, 0, nm}), 0.01181050, 5e-9);  // printed digits of the case
  EXPECT_NEAR(bounce({0, 0, 1}, {0, 0, -1}, {0, 0, nm}), 2 * k * nm, tolerance);
  EXPECT_NEAR(bounce(in45, out45, {0, 0, nm}), -0.00835128, 5e-9);
  EXPECT_NEAR(bounce(in45, out45, {0, 0, nm}), -2 * k * std::cos(pi / 4) * nm, tolerance);
  EXPECT_NEAR(bounce(in45, out30, {nm, 2 * nm, 3 * nm}), -0.02959882, 5e-9);
  EXPECT_NEAR(bounce(in45, out30, {nm, 2 * nm, 3 * nm}), k * nm * (s45 - 2 * 0.5 - 3 * (s45 + std::sqrt(0.75))),
              tolerance);
  EXPECT_NEAR(bounce(in45, out45, {0, 0, nm}, 2), -0.01670257, 5e-9);
  EXPECT_NEAR(bounce(in45, out45, {nm, 0, 0}), 0, tolerance);  // a specular mirror does not feel tangential motion
  // R4.03: 1 um toward the source shortens the path by 2 um; at 45 deg along the normal by 1.41421 um
  EXPECT_NEAR(bounce({0, 0, 1}, {0, 0, -1}, {0, 0, -1e3 * nm}) / k, -2e-6, 1e-15);
  EXPECT_NEAR(bounce(in45, out45, {0, 0, 1e3 * nm}) / k, -1.41421e-6, 5e-12);
  // control: the opposite sign of the original code is off by twice the phase
  EXPECT_GT(std::fabs(bounce(out45, in45, {0, 0, nm}) + 0.00835128), tolerance);
}

// R4.01: 3 km are 2.82e9 cycles. A quarter of a wave more at their end is pi/2 to the rounding of double precision;
// control: single precision.
TEST(PhaseSensitivities, PhaseOfThreeKilometresR4_01) {
  auto const length_to = [](double z) {
    World world;
    std::uint32_t const black = black_optic(world);
    BodyId const body = world.add_body("mirror", {0, 0, z});
    SurfaceId const mirror =
        world.add_surface(Disk{{0, 0, z}, {0, 0, -1}, 0, 0.1}, black, black, body, world.add_group("mirror"));
    world.add_footprint(spot(mirror, {0, 0, z}, {0, 0, 1}, Profile::gaussian, 1e-3));
    world.finish();
    std::vector<SequenceStep> const steps = {{mirror, Event::reflect}};
    return trace_sequence(world.view(), {{0, 0, 0}, {0, 0, 1}}, steps).points.at(0).path_length;
  };
  double const near = length_to(3000), far = length_to(3000 + 1.064e-6 / 4);
  EXPECT_NEAR(near / 1.064e-6, 2.82e9, 0.005e9);
  EXPECT_NEAR(k * (far - near), pi / 2, 3e-6);
  EXPECT_GT(std::fabs(k * double(float(far) - float(near)) - pi / 2), 1);
}

class RandomPaths {
 public:
  Vec3 point() { return {normal_(engine_), normal_(engine_), normal_(engine_)}; }
  Vec3 direction() { return unit(point()); }
  // n hits at random points; surface i at hit i. Legs before and after have random directions.
  std::vector<PassedVertex> path(std::size_t n) {
    std::vector<PassedVertex> hits(n);
    for (std::size_t i = 0; i < n; ++i) hits[i] = {SurfaceId{std::uint32_t(i)}, point(), {}, {}};
    hits.front().in = direction();
    hits.back().out = direction();
    for (std::size_t i = 0; i + 1 < n; ++i) hits[i + 1].in = hits[i].out = unit(hits[i + 1].point - hits[i].point);
    return hits;
  }

 private:
  std::mt19937_64 engine_{20};
  std::normal_distribution<double> normal_;
};

// docs/theory/phase.md, eq. 2.4, R4.06: the inner terms of a rigid body cancel; 1e-12 relative.
TEST(PhaseSensitivities, RigidBodyInvariantR4_06) {
  RandomPaths random;
  World const one = bodies_world({0, 0, 0}, {{0.1, 0.2, 0.3}}), two = bodies_world({0, 1, 0}, {{}, {}});
  for (int i = 0; i < 1000; ++i) {
    auto const hits = random.path(3);
    Vec3 const ends = k * (hits.front().in - hits.back().out);
    ASSERT_TRUE(close(along(phase_sensitivities_of(one, hits, 0, 0)[0]), ends, 1e-12 * 2 * k / length(ends)));
    // control: the middle hit belongs to another body
    ASSERT_FALSE(close(along(phase_sensitivities_of(two, hits, 0, 0)[0]), ends, 1e-12 * 2 * k / length(ends)));
  }
}

// Phase of a path whose hit points are moved: k (first leg + straight legs + last leg), eq. 0.1.
double phase(std::vector<PassedVertex> const& hits, std::function<Vec3(PassedVertex const&)> const& moved) {
  Vec3 last = moved(hits.front());
  double sum = dot(hits.front().in, last - hits.front().point);
  for (std::size_t i = 1; i < hits.size(); ++i) {
    Vec3 const here = moved(hits[i]);
    sum += length(here - last);
    last = here;
  }
  return k * (sum - dot(hits.back().out, last - hits.back().point));
}
// Derivative of the phase by a rotation of one body about an axis through its pivot, or by a translation.
double slope(World const& world, std::vector<PassedVertex> const& hits, BodyId body, Vec3 axis, bool turn) {
  auto const with = [&](double amount) {
    return phase(hits, [&](PassedVertex const& v) {
      if (world.surfaces()[v.surface.value].body != body) return v.point;
      Vec3 const arm = v.point - world.bodies()[body.value].pivot;
      Vec3 const turned = std::cos(amount) * arm + std::sin(amount) * cross(axis, arm) +
                          ((1 - std::cos(amount)) * dot(axis, arm)) * axis;
      return turn ? world.bodies()[body.value].pivot + turned : v.point + amount * axis;
    });
  };
  double const step = 1e-5;
  return (with(step) - with(-step)) / (2 * step);
}

// eq. 2.3, rotations about the pivot: 1e-5 relative to the finite difference of the optical path.
TEST(PhaseSensitivities, RotationsAndTranslationsAreDerivativesOfTheOpticalPath) {
  RandomPaths random;
  std::vector<Vec3> const pivots{{0.3, -0.2, 0.5}, {-1, 0.4, 0.1}};
  World const world = bodies_world({0, 1, 0, 1}, pivots), off = bodies_world({0, 1, 0, 1}, {{}, {}});
  int control_caught = 0;
  for (int i = 0; i < 200; ++i) {
    auto const hits = random.path(4);
    auto const phase_sensitivities = phase_sensitivities_of(world, hits, 0, 0),
               elsewhere = phase_sensitivities_of(off, hits, 0, 0);
    for (std::uint32_t b = 0; b < 2; ++b)
      for (Vec3 const axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
        double const turn = slope(world, hits, {b}, axis, true), shift = slope(world, hits, {b}, axis, false);
        ASSERT_NEAR(dot(turning(on_body(phase_sensitivities, {b})), axis), turn, 1e-5 * k);
        ASSERT_NEAR(dot(along(on_body(phase_sensitivities, {b})), axis), shift, 1e-5 * k);
        // control: turned about another pivot
        control_caught += std::fabs(dot(turning(on_body(elsewhere, {b})), axis) - turn) > 1e-5 * k;
      }
  }
  EXPECT_GT(control_caught, 1190);  // of 1200
}

// Two mirrors of a cavity of 1 km and one small ring between them; everything diffuse, so every path exists.
struct Cavity {
  World world;
  BodyId one, two, ring;
  explicit Cavity(bool standing = true) {
    one = world.add_body("one", {0, 0, 0});
    two = world.add_body("two", {0, 0, 1000});
    ring = world.add_body("ring", {0, 0, 400});
    std::uint32_t const white = lambertian_optic(world, 0.5), black = black_optic(world);
    SurfaceId const m1 = world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.1}, white, black, one, world.add_group("one"));
    SurfaceId const m2 =
        world.add_surface(Disk{{0, 0, 1000}, {0, 0, -1}, 0, 0.1}, white, black, two, world.add_group("two"));
    world.add_surface(Disk{{0, 0, 400}, {0, 0, -1}, 0.02, 0.04}, white, black, ring, world.add_group("ring"));
    Footprint f1 = spot(m1, {}, {0, 0, -1}, Profile::gaussian, 5e-3, world.add_port("one"));
    Footprint f2 = spot(m2, {0, 0, 1000}, {0, 0, 1}, Profile::gaussian, 5e-3, world.add_port("two"));
    f1.standing = f2.standing = standing;
    world.add_footprint(f1);
    world.add_footprint(f2);
    world.limits.max_order = 2;
    world.finish();
  }
};

// The route one > ring > one has no analog hit in a million histories: histories are sent to the ring by hand.
std::vector<PhaseSensitivity> there_and_back(Cavity const& c, double radius) {
  Vec3 const hit{radius, 0, 400}, out = unit(hit);
  std::vector<PassedVertex> const path{
      {{0}, {}, {0, 0, -1}, out, Event::emit}, {{2}, hit, out, -out}, {{0}, {}, -out, {0, 0, 1}, Event::couple}};
  return phase_sensitivities_of(c.world, path, 0, 0);
}

// eq. 2.5: +2k on the baffle and -2k on the mirror; cosines of 7.5e-5 rad are 1 to 3e-9.
TEST(PhaseSensitivities, CavityMirrorBaffleMirror) {
  Cavity const c;
  auto const phase_sensitivities = there_and_back(c, 0.03);
  EXPECT_NEAR(on_body(phase_sensitivities, c.ring).d[2], 2 * k, 1e-8 * k);
  EXPECT_NEAR(on_body(phase_sensitivities, c.one).d[2], -2 * k, 1e-8 * k);
  Cavity const running(false);  // control: the reflection of the main mode is not subtracted
  EXPECT_GT(std::fabs(on_body(there_and_back(running, 0.03), running.one).d[2] + 2 * k), k);
}

// eq. N.30: the light left the mirror 2 l/c ago and met the ring l/c ago; the mode is reflected now. Control: without
// the reflection of the mode, the mirror counts twice, in the mean l/c ago.
TEST(PhaseSensitivities, DelaysOfMirrorAndBaffleN30) {
  Cavity const c, running(false);
  double const ago = std::hypot(400, 0.03) / speed_of_light;
  auto const z_ago = [](std::vector<PhaseSensitivity> const& all, BodyId body) {
    PhaseSensitivity const s = on_body(all, body);
    return s.moment[2] / s.d[2];
  };
  auto const all = there_and_back(c, 0.03);
  EXPECT_NEAR(z_ago(all, c.ring) / ago, 1, 1e-7);
  EXPECT_NEAR(z_ago(all, c.one) / ago, 2, 1e-7);
  EXPECT_NEAR(z_ago(there_and_back(running, 0.03), running.one) / ago, 1, 1e-7);
}

// eq. N.29: each hit after the rest of the way. A path that adds to its reverse: after half of the way. Control: each
// is what the other is not.
TEST(PhaseSensitivities, DelayOfEachHitN29) {
  RandomPaths random;
  World alone = bodies_world({0, 1, 2, 3}, {{}, {}, {}, {}});
  World const both = alone;
  alone.reverse_routes = false;
  for (int i = 0; i < 100; ++i) {
    auto const hits = random.path(4);
    double left = 0, whole = 0;
    for (std::size_t h = 1; h < 4; ++h) whole += length(hits[h].point - hits[h - 1].point) / speed_of_light;
    auto const one_way = phase_sensitivities_of(alone, hits, 0, 0), two_ways = phase_sensitivities_of(both, hits, 0, 0);
    for (std::size_t h = 4; h-- > 0;) {
      if (h < 3) left += length(hits[h + 1].point - hits[h].point) / speed_of_light;
      Vec3 const kappa = k * (hits[h].in - hits[h].out);
      for (int axis = 0; axis < 3; ++axis) {
        double const of_axis = axis == 0 ? kappa.x : axis == 1 ? kappa.y : kappa.z;
        ASSERT_NEAR(one_way[h].moment[axis], of_axis * left, 1e-12 * k * whole);
        ASSERT_NEAR(two_ways[h].moment[axis], of_axis * whole / 2, 1e-12 * k * whole);
      }
    }
    ASSERT_GT(std::fabs(one_way[3].moment[0] - two_ways[3].moment[0]), 1e-12 * k * whole) << "negative control";
  }
}

// The beam meets a body 4 m after its start and lights a surface after 10 m. Light scattered there and over 3 m to
// another beam felt the body 9 m ago; light of the other beam that rejoins this one feels it 4 m ago.
TEST(PhaseSensitivities, DelayOnTheWayOfTheBeam) {
  World world;
  std::uint32_t const black = black_optic(world);
  BodyId const lens = world.add_body("lens", {});
  SurfaceId const lit = world.add_surface(Disk{}, black, black, world.add_body("lit", {}), world.add_group("lit"));
  Feed feed{true, 10, {{lens, {0, 0, 2}, {0, 0, 2 * 4 / speed_of_light}}}};
  world.add_footprint(spot(lit, {}, {0, 0, -1}, Profile::gaussian, 1e-3), feed);
  world.add_footprint(spot(lit, {0, 0, 3}, {0, 0, -1}, Profile::gaussian, 1e-3, {}, 1));
  world.finish();
  std::vector<PassedVertex> const there{{lit, {}, {0, 0, -1}, {0, 0, 1}, Event::emit},
                                        {lit, {0, 0, 3}, {0, 0, 1}, {0, 0, 1}, Event::couple}};
  auto const ago = [&](std::uint32_t source, std::uint32_t goal) {
    PhaseSensitivity const s = on_body(phase_sensitivities_of(world, there, source, goal), lens);
    return s.moment[2] / s.d[2] * speed_of_light;
  };
  EXPECT_NEAR(ago(0, 1), 9, 1e-12);
  EXPECT_NEAR(ago(1, 0), 4, 1e-12);
  EXPECT_NEAR(ago(0, 0), 11.5, 1e-12);  // there and back, with the reverse: half of 23 m
}

// A path straight from mirror to mirror moves with the main mode: zero phase sensitivity on both.
TEST(PhaseSensitivities, CavityMirrorToMirrorIsTheMode) {
  Cavity const c, running(false);
  std::vector<PassedVertex> const path{{{0}, {}, {0, 0, -1}, {0, 0, 1}, Event::emit},
                                       {{1}, {0, 0, 1000}, {0, 0, 1}, {0, 0, 1}, Event::couple}};
  auto straight = path;
  straight[1].out = {0, 0, -1};
  for (PhaseSensitivity const& l : phase_sensitivities_of(c.world, straight, 0, 1))
    for (double const d : l.d) EXPECT_LT(std::fabs(d), 1e-12 * k);
  EXPECT_GT(std::fabs(on_body(phase_sensitivities_of(running.world, straight, 0, 1), running.two).d[2]),
            k);  // negative control
}

// The same rules in traced paths: direct light of a cavity has no axial phase sensitivity beyond theta^2/2, and a
// translation of the whole scene changes no relative phase, so the phase sensitivities of every record add up to zero.
TEST(PhaseSensitivities, TracedCavityPathsAreRelativeToTheMode) {
  Cavity const c, running(false);
  TraceResult const r = run_histories(c.world, 1 << 14), s = run_histories(running.world, 1 << 14);
  CouplingClass const* direct = find_route(r, "one·S > two·S");
  ASSERT_NE(direct, nullptr);
  double const theta = 4 * 5e-3 / 1000;  // spots of 5 mm, out to 4 radii in all
  for (PathRecord const& p : direct->records) {
    for (PhaseSensitivity const& l : p.phase_sensitivities) {
      EXPECT_LT(std::fabs(l.d[2]), k * theta * theta);
      EXPECT_LT(std::hypot(l.d[0], l.d[1]), k * theta);
    }
    EXPECT_NEAR(p.path_length, 1000, 1e-6);
  }
  CouplingClass const* control = find_route(s, "one·S > two·S");
  ASSERT_NE(control, nullptr);
  EXPECT_GT(std::fabs(control->records[0].phase_sensitivities[0].d[2]), k);
  for (CouplingClass const& route : r.coupling.classes)
    for (PathRecord const& p : route.records) {
      Vec3 sum;
      for (PhaseSensitivity const& l : p.phase_sensitivities) sum = sum + along(l);
      EXPECT_LT(length(sum), 1e-9 * k) << route_name(r.coupling, route);  // ends: main beam in, reversed mode out
    }
}

}  // namespace
}  // namespace straytrace::testing::trace_phase_sensitivities
