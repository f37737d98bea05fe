// SPDX-License-Identifier: BSD-3-Clause
// Case A26 through the program: paths that it traces in the arm of Virgo and the same paths run backwards, summed as
// fields with the optical lengths and phase sensitivities that it gives to each (docs/theory/path_integral.md
// eq. 1.5, 2.3). Mean power over the sum of the powers of all ordered paths: 2, as the classes state.
#include <complex>
#include <random>

#include "scene/scene.hpp"
#include "support/trace_support.hpp"
#include "trace/tally/replay.hpp"

namespace straytrace::testing::trace_reverse_fields {
namespace {

using Complex = std::complex<double>;

World virgo_arm() {
  Scene const scene = read_scene(std::string(STRAY_SOURCE_DIR) + "/tests/scenes/virgo_arm.yaml");
  World world = build_world(scene);
  scene.throw_if_problems();
  return world;
}

struct Way {
  double power = 0, length = 0;  // relative; optical, m
  std::vector<PhaseSensitivity> phase_sensitivities;
};
struct Pair {
  Way there, back;
};

// Product of the BSDFs along a path.
double scattered(WorldView const& view, std::vector<PassedVertex> const& path) {
  double product = 1;
  for (PassedVertex const& p : path) {
    Vertex const v = make_vertex(view, p.surface, p.point, p.in);
    product *= scatter_eval(view.laws, *v.optic, v.wi, v.frame.to_local(p.out));
  }
  return product;
}

// From the last vertex of `there` to its first, found by the program's search; light starts there in the mode of its
// last footprint. How far it misses the points: `miss`.
Way backwards(World const& world, ReplayedPath const& there, double& miss) {
  WorldView const view = world.view();
  PathState path;
  std::vector<PassedVertex> const& v = there.vertices;
  std::vector<PassedVertex> run{
      {v.back().surface, v.back().point, view.lit[there.goal].direction(v.back().point), {}, Event::emit}};
  for (std::size_t i = v.size() - 1; i-- > 0;) {
    Vec3 const out = unit(v[i].point - run.back().point);
    run.back().out = out;
    path.from = run.back().surface;
    path.ray = {run.back().point, out};
    Hit const hit = view.closest(path.ray, path.from);
    if (hit.surface != v[i].surface) return {};
    Vec3 const point = vertex_at(view, path, hit).point;
    miss = std::fmax(miss, length(point - v[i].point));
    lost_in_medium(view, path, hit.distance);
    run.push_back({v[i].surface, point, out, {}, Event::scatter});
  }
  run.back().out = -view.lit[there.source].direction(run.back().point);
  return {scattered(view, run), path.path_length, phase_sensitivities_of(world, run, there.goal, there.source)};
}

struct Traced {
  World world = virgo_arm();
  std::vector<Pair> pairs;
  double miss = 0;    // m
  double stated = 0;  // C_rev of the class
};
Traced traced(char const* route) {
  Traced t;
  TraceResult const r = run_histories(t.world, 1 << 17);
  CouplingClass const* c = find_route(r, route);
  if (!c || c->by_reverse) return t;
  t.stated = c->reverse;
  for (PathRecord const& kept : c->records) {
    auto const found = replay(SteeredWorld::as_given(t.world), 1, kept.history, kept.event, kept.connection);
    if (!found) continue;
    Pair pair{{kept.weight, kept.path_length, kept.phase_sensitivities}, backwards(t.world, *found, t.miss)};
    pair.back.power *= kept.weight / scattered(t.world.view(), found->vertices);
    t.pairs.push_back(pair);
  }
  return t;
}

// Where the bodies are: some wavelengths and microradians away.
using Places = std::vector<std::array<double, 6>>;
Places moved(std::size_t bodies, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Places at(bodies);
  for (auto& body : at)
    for (int axis = 0; axis < 6; ++axis) body[axis] = (axis < 3 ? 3e-6 : 1e-6) * normal(engine);
  return at;
}
Complex field(Way const& way, Places const& at, double wavelength, double sign = 1) {
  double phase = 2 * pi * std::fmod(way.length / wavelength, 1.0);
  for (PhaseSensitivity const& l : way.phase_sensitivities)
    for (int axis = 0; axis < 6; ++axis) phase += sign * l.d[axis] * at[l.body.value][axis];
  return std::polar(std::sqrt(way.power), phase);
}

struct Sums {
  double pairs = 0, strangers = 0, unmoved_phase_sensitivities = 0;  // over the powers of all ordered paths
  SampleMean speckle;                                                // of all paths together
};
Sums sums_of(Traced const& t) {
  Sums s;
  Sampler speckle;
  std::mt19937_64 engine(26);
  std::normal_distribution<double> normal;
  constexpr int instants = 8;
  double const wavelength = t.world.wavelength;
  for (int instant = 0; instant < instants; ++instant) {
    Places const at = moved(t.world.bodies().size(), std::uint64_t(instant));
    std::vector<Complex> both;
    double all = 0, pairs = 0, strangers = 0, wrong_phase_sensitivities = 0;
    for (std::size_t j = 0; j < t.pairs.size(); ++j) {
      Pair const &one = t.pairs[j], &next = t.pairs[(j + 1) % t.pairs.size()];
      Complex const there = field(one.there, at, wavelength);
      both.push_back(there + field(one.back, at, wavelength));
      all += one.there.power + one.back.power;
      pairs += std::norm(both.back());
      strangers += std::norm(there + field(next.back, at, wavelength));
      wrong_phase_sensitivities += std::norm(there + field(one.back, at, wavelength, -1));
    }
    s.pairs += pairs / all / instants;
    s.strangers += strangers / all / instants;
    s.unmoved_phase_sensitivities += wrong_phase_sensitivities / all / instants;
    for (int draw = 0; draw < 1000; ++draw) {  // amplitudes of the scatterers: one for a path and its reverse
      Complex sum;
      for (Complex const& f : both) sum += f * Complex(normal(engine), normal(engine)) / std::sqrt(2.0);
      speckle.add(std::norm(sum) / all);
    }
  }
  s.speckle = speckle.mean();
  return s;
}

TEST(ReversePaths, FieldsOfTracedPathsA26) {
  for (char const* route :
       {"ITM·S > baffles_in·S > ITM·S", "ETM·S > baffles_end·S > baffles_end·S > ETM·S", "ITM·S > ETM·S"}) {
    Traced const t = traced(route);
    ASSERT_GT(t.pairs.size(), 20u) << route;
    EXPECT_LT(t.miss, 1e-9) << route;  // m
    Sums const s = sums_of(t);
    EXPECT_NEAR(s.pairs, 2, 1e-6) << route;
    expect_mean("all fields together", s.speckle, 2, 0.25);
    EXPECT_EQ(t.stated, 2) << route;
    EXPECT_LT(s.strangers, 1.5) << "control: reverses of other paths";
    EXPECT_LT(s.unmoved_phase_sensitivities, 1.5) << "control: phase sensitivities of the way back with the other sign";
  }
}

}  // namespace
}  // namespace straytrace::testing::trace_reverse_fields
