// SPDX-License-Identifier: BSD-3-Clause
// Case A26: a path and its reverse add in amplitude (eq. 1.5). Fields of random scatterers are summed here without any
// use of the program: mean power over the sum of the ordered paths' powers. Then: what the traced classes carry.
#include <complex>
#include <random>
#include <vector>

#include "support/trace_support.hpp"
#include "trace/tally/coupling_table.hpp"

namespace straytrace::testing::trace_reverse {
namespace {

using Complex = std::complex<double>;

// Random point scatterers with circular Gaussian amplitudes on two mirrors and two baffles; straight propagation.
class Speckle {
 public:
  struct Patch {
    std::vector<Vec3> at;
    std::vector<Complex> amplitude;
  };
  // `symmetric`: the way back is the way there. The control breaks it by a random phase per leg and direction.
  explicit Speckle(bool symmetric) : symmetric_(symmetric) {}

  Patch patch(double z, int n, double width) {
    Patch p;
    for (int i = 0; i < n; ++i) {
      p.at.push_back({width * normal_(engine_), width * normal_(engine_), z});
      p.amplitude.push_back(Complex(normal_(engine_), normal_(engine_)) / std::sqrt(2.0));
    }
    return p;
  }
  Complex leg(Vec3 from, Vec3 to) {
    double const d = length(to - from), turn = symmetric_ ? 0 : 2 * pi * uniform_(engine_);
    return std::polar(1 / d, 2 * pi / 1.064e-6 * d + turn);
  }
  // Field at every scatterer of `to`, from the mode's light on `from`; power without interference comes along.
  struct Field {
    std::vector<Complex> value;
    std::vector<double> power;
  };
  Field spread(Patch const& from, Patch const& to) {
    Field f{std::vector<Complex>(to.at.size()), std::vector<double>(to.at.size())};
    for (std::size_t j = 0; j < to.at.size(); ++j)
      for (std::size_t i = 0; i < from.at.size(); ++i) {
        f.value[j] += from.amplitude[i] * leg(from.at[i], to.at[j]);
        f.power[j] += 1 / length2(to.at[j] - from.at[i]);
      }
    return f;
  }

 private:
  bool symmetric_;
  std::mt19937_64 engine_{26};
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
};

struct Ratio {
  Sampler same_mirror, other_mode, two_baffles, direct, single;
};
// Mean of |sum of fields|^2 over the sum of the powers of all ordered paths; amplitudes have unit variance.
Ratio ratios(bool symmetric, int draws, int on_mirror) {
  Speckle speckle(symmetric);
  Ratio ratio;
  constexpr int n = 4;  // scatterers on each baffle
  for (int draw = 0; draw < draws; ++draw) {
    auto const m = speckle.patch(0, on_mirror, 0.02), m2 = speckle.patch(0.1, on_mirror, 0.02),
               a = speckle.patch(3, n, 0.3), b = speckle.patch(5, n, 0.3);
    auto const there = speckle.spread(m, a), back = speckle.spread(m, a), other = speckle.spread(m2, a);
    auto const b_there = speckle.spread(m, b), b_back = speckle.spread(m, b);
    Complex round, cross, chain, straight, one;
    double round_power = 0, cross_power = 0, chain_power = 0, straight_power = 0;
    for (std::size_t j = 0; j < n; ++j) {
      round += there.value[j] * a.amplitude[j] * back.value[j];
      round_power += there.power[j] * back.power[j];
      cross += there.value[j] * a.amplitude[j] * other.value[j];
      cross_power += there.power[j] * other.power[j];
      for (std::size_t l = 0; l < n; ++l) {
        // mirror > a > b > mirror and mirror > b > a > mirror
        chain += there.value[j] * a.amplitude[j] * speckle.leg(a.at[j], b.at[l]) * b.amplitude[l] * b_back.value[l];
        chain += b_there.value[l] * b.amplitude[l] * speckle.leg(b.at[l], a.at[j]) * a.amplitude[j] * back.value[j];
        double const d2 = length2(a.at[j] - b.at[l]);
        chain_power += 2 * there.power[j] * b_there.power[l] / d2;
      }
      for (std::size_t i = 0; i < m.at.size(); ++i) {  // mirror > a and a > mirror of a standing wave that lights both
        straight += m.amplitude[i] * a.amplitude[j] * (speckle.leg(m.at[i], a.at[j]) + speckle.leg(a.at[j], m.at[i]));
        straight_power += 2 / length2(m.at[i] - a.at[j]);
      }
    }
    for (Complex const& c : m.amplitude) one += c;
    ratio.same_mirror.add(std::norm(round) / round_power);
    ratio.other_mode.add(std::norm(cross) / cross_power);
    ratio.two_baffles.add(std::norm(chain) / chain_power);
    ratio.direct.add(std::norm(straight) / straight_power);
    ratio.single.add(std::norm(one) / on_mirror);
  }
  return ratio;
}

TEST(ReversePaths, FieldsOfRandomScatterersA26) {
  int const few = 6, many = 30;
  Ratio const r = ratios(true, 100000, few), s = ratios(true, 20000, many);
  expect_mean("mirror > baffle > same mirror", r.same_mirror.mean(), 2, 0.25);
  expect_mean("mirror > mirror of one standing wave", r.direct.mean(), 2, 0.15);
  expect_mean("out by one mode, back by another", r.other_mode.mean(), 1, 0.15);
  expect_mean("one vertex", r.single.mean(), 1, 0.05);
  // Two baffles see speckle of the same n scatterers: 2 (1 + 1/n), so 2 for a real surface.
  expect_mean("two baffles", r.two_baffles.mean(), 2 * (1 + 1.0 / few), 0.25);
  expect_mean("two baffles", s.two_baffles.mean(), 2 * (1 + 1.0 / many), 0.5);
}

TEST(ReversePaths, WithoutSymmetricPropagation) {
  Ratio const r = ratios(false, 40000, 6);
  expect_rejected("mirror > baffle > same mirror", r.same_mirror.mean(), 2);
  expect_rejected("two baffles", r.two_baffles.mean(), 2 * (1 + 1.0 / 6));
  expect_rejected("mirror > mirror", r.direct.mean(), 2);
}

// Two mirrors and a baffle; are the mirrors lit by one beam?
World cavity(bool one_beam, bool reverse_routes) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 0.5), black = black_optic(world);
  SurfaceId const one = world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.5}, white, black, body, world.add_group("one"));
  SurfaceId const two =
      world.add_surface(Disk{{0, 0, 2}, {0, 0, -1}, 0, 0.5}, white, black, body, world.add_group("two"));
  world.add_surface(Disk{{0, 0, 1}, {0, 0, 1}, 0.2, 1}, white, white, body, world.add_group("baffle"));
  world.add_footprint(spot(one, {}, {0, 0, -1}, Profile::gaussian, 0.1, world.add_port("one"), 0));
  world.add_footprint(spot(two, {0, 0, 2}, {0, 0, 1}, Profile::gaussian, 0.1, world.add_port("two"), one_beam ? 0 : 1));
  world.limits.max_order = 2;
  world.reverse_routes = reverse_routes;
  world.finish();
  return world;
}
double reverse_of(World const& world, char const* route) {
  TraceResult const r = run_histories(world, 1 << 17);
  CouplingClass const* c = find_route(r, route);
  return c ? c->reverse : 0;
}

TEST(ReversePaths, ClassesCarryCrev) {
  EXPECT_EQ(reverse_of(cavity(true, true), "one·S > baffle·S > one·S"), 2);
  EXPECT_EQ(reverse_of(cavity(false, true), "one·S > baffle·S > one·S"), 2);
  EXPECT_EQ(reverse_of(cavity(true, true), "one·S > two·S"), 2);
  EXPECT_EQ(reverse_of(cavity(false, true), "one·S > two·S"), 1);             // leaves one mode, returns by another
  EXPECT_EQ(reverse_of(cavity(true, true), "one·S"), 1);                      // its own reverse
  EXPECT_EQ(reverse_of(cavity(true, false), "one·S > baffle·S > one·S"), 1);  // the switch
}

// Two mirrors that reflect and scatter, with a ring between them: light from the ring can be reflected into the other
// mirror's mode, which only the walk finds; backwards it is connected.
World reflecting_cavity(double radius) {
  World world;
  BodyId const mirrors = world.add_body("mirrors", {}), tube = world.add_body("tube", {});
  std::uint32_t const black = black_optic(world), white = lambertian_optic(world, 0.5);
  Optic optic;
  optic.reflect = 0.6;
  optic.laws = 1;
  optic.law[0] = world.add_law(Lambertian{0.3});
  std::uint32_t const mirror = world.add_optic(optic);
  SurfaceId const one = world.add_surface(Disk{{}, {0, 0, 1}, 0, 0.6}, mirror, black, mirrors, world.add_group("one"));
  SurfaceId const two =
      world.add_surface(Disk{{0, 0, 0.6}, {0, 0, -1}, 0, 0.6}, mirror, black, mirrors, world.add_group("two"));
  world.add_surface(Disk{{0, 0, 0.3}, {0, 0, 1}, 0.3, 0.8}, white, white, tube, world.add_group("ring"));
  world.add_footprint(spot(one, {}, {0, 0, -1}, Profile::even, radius, world.add_port("one"), 0));
  world.add_footprint(spot(two, {0, 0, 0.6}, {0, 0, 1}, Profile::even, radius, world.add_port("two"), 0));
  world.limits.max_order = 3;
  world.finish();
  return world;
}
char const* const by_walk = "one·S > ring·S > one·R > two·S";  // ends by a reflection
char const* const by_connection = "two·S > one·R > ring·S > one·S";

TEST(ReversePaths, RoutesAreNamedLikeTheTraceDoes) {
  World const world = reflecting_cavity(0.35);
  TraceResult const r = run_histories(world, 1 << 17);
  int named = 0;
  for (CouplingClass const& c : r.coupling.classes) {
    if (c.steps.empty()) continue;
    EXPECT_EQ(hash_of_route(c.steps, 0, c.port.value), c.hash) << route_name(r.coupling, c);
    EXPECT_EQ(backwards(backwards(c.steps)), c.steps);
    ++named;
  }
  EXPECT_GT(named, 10);
}

double mean_phase_sensitivity(CouplingClass const& c, std::uint32_t body) {
  double sum = 0;
  for (PathRecord const& r : c.records)
    for (PhaseSensitivity const& l : r.phase_sensitivities) sum += l.body.value == body ? r.weight * l.d[2] : 0;
  return sum / c.coupling.mean;
}

// Eq. 1.2 with mirrors in the path: with diffuse mirrors both ends are well sampled and must agree.
TEST(ReversePaths, SameCouplingAndPhaseSensitivitiesFromEitherEnd) {
  TraceResult const r = run_histories(reflecting_cavity(0.35), 1 << 20);
  CouplingClass const *there = find_route(r, by_walk), *back = find_route(r, by_connection);
  ASSERT_TRUE(there && back);
  ASSERT_FALSE(there->by_reverse || back->by_reverse);
  SampleMean const walked = route_coupling(r, by_walk), connected = route_coupling(r, by_connection);
  expect_mean("coupling", difference(walked, connected), 0, 0.1 * connected.mean);
  // control: an angle factor at the mirror
  expect_rejected("20 % more", difference(scaled(walked, 1.2), connected), 0);
  for (std::uint32_t body : {0u, 1u})
    EXPECT_NEAR(mean_phase_sensitivity(*there, body) / mean_phase_sensitivity(*back, body), 1, 0.02);
  EXPECT_GT(std::fabs(mean_phase_sensitivity(*there, 0) / mean_phase_sensitivity(*back, 1) - 1),
            0.1);  // control: phase sensitivities of another body
}

// Small spots are hardly met by the walk: the connected reverse must speak for both.
TEST(ReversePaths, PoorlySampledRoutesTakeTheNumbersOfTheirReverse) {
  TraceResult const r = run_histories(reflecting_cavity(0.01), 1 << 18);
  CouplingClass const *there = find_route(r, by_walk), *back = find_route(r, by_connection);
  ASSERT_TRUE(there && back);
  EXPECT_TRUE(there->by_reverse);
  EXPECT_FALSE(back->by_reverse);
  EXPECT_TRUE(there->coupling.trusted);
  EXPECT_EQ(there->coupling.mean, back->coupling.mean);
  EXPECT_EQ(there->replica_sum, back->replica_sum);
  EXPECT_EQ(there->records.size(), back->records.size());
  EXPECT_EQ(there->reverse, 2);
  EXPECT_NE(there->hash, back->hash);
}

// Counting histories: a route without a score is added, a poorer one replaced, two trusted ones are left alone.
TEST(ReversePaths, ChoiceOfTheSampledDirection) {
  auto const made = [](std::vector<PathStep> const& steps, std::uint64_t scored, bool trusted, double mean) {
    MadeClass m;
    m.row.steps = steps;
    m.row.hash = hash_of_route(steps, 0, 0);
    m.row.port = m.back = {0};
    m.row.coupling.scored = scored;
    m.row.coupling.trusted = trusted;
    m.row.coupling.mean = mean;
    m.reversible = true;
    return m;
  };
  std::vector<PathStep> const a = {
      {{0}, Event::emit}, {{1}, Event::scatter}, {{0}, Event::reflect}, {{2}, Event::couple}};
  std::vector<PathStep> const b = backwards(a);
  auto const mean_of = [](std::vector<MadeClass> list, std::vector<PathStep> const& steps) {
    mirror_poorly_sampled(list);
    for (MadeClass const& m : list)
      if (m.row.steps == steps) return m.row.coupling.mean;
    return 0.0;
  };
  EXPECT_EQ(mean_of({made(a, 500, true, 3)}, b), 3);
  EXPECT_EQ(mean_of({made(a, 500, true, 3), made(b, 20, false, 7)}, b), 3);
  EXPECT_EQ(mean_of({made(b, 20, false, 7), made(a, 500, true, 3)}, b), 3);  // whatever their order
  EXPECT_EQ(mean_of({made(a, 500, true, 3), made(b, 400, true, 7)}, b), 7);
  EXPECT_EQ(mean_of({made(a, 60, false, 3), made(b, 20, false, 7)}, b), 3);
  EXPECT_EQ(mean_of({made(a, 20, false, 3), made(b, 60, false, 7)}, b), 7);  // not the smaller, not the larger
  MadeClass two_beams = made(a, 500, true, 3);
  two_beams.reversible = false;
  EXPECT_EQ(mean_of({two_beams}, b), 0);
}

}  // namespace
}  // namespace straytrace::testing::trace_reverse
