// SPDX-License-Identifier: BSD-3-Clause
// Ghost paths through N surfaces (docs/theory/sampling.md): N(N-1)/2 with two reflections, 190 for N = 20; 30,115 with
// four. Counted by following both ways at every surface that the search finds; the walk finds the same power.
#include <set>

#include "support/trace_support.hpp"

namespace straytrace::testing {
namespace {

constexpr double reflect = 0.1;

// Discs 1 cm apart that reflect R and transmit 1 - R, a thin beam from below, a black disc above.
World stack(int surfaces) {
  World world;
  BodyId const body = world.add_body("all", {});
  Optic half;
  half.reflect = reflect;
  half.transmit = 1 - reflect;
  std::uint32_t const optic = world.add_optic(half), black = black_optic(world);
  for (int i = 1; i <= surfaces; ++i)
    world.add_surface(disk(0, 0.1, {{0, 0, 0.01 * i}, {0, 0, 1}}), optic, optic, body, world.add_group("stack"));
  world.add_surface(disk(0, 0.1, {{0, 0, 1}, {0, 0, -1}}), black, black, body, world.add_group("end"));
  world.add_footprint(free_beam({}, {}, {0, 0, 1}, Profile::even, 1e-3));
  world.limits.max_order = 200;
  world.limits.roulette_below = 0;
  world.finish();
  return world;
}

// Paths that reach the end, by their number of reflections.
struct Ghosts {
  static constexpr std::uint32_t most = 4;
  long count[most + 1] = {};
  double power[most + 1] = {};
};

// Every way on from here: through, and back as long as `most` allows. `paired`: both ways are taken, as they must be.
void follow(WorldView const& view, std::uint32_t end, PathState path, std::uint32_t reflections, bool paired,
            Ghosts& out) {
  for (;;) {
    Hit const hit = view.closest(path.ray, path.from);
    if (!hit.surface.valid()) return;
    Vertex v = vertex_at(view, path, hit);
    if (v.surface.value == end) {
      ++out.count[reflections];
      out.power[reflections] += path.power;
      return;
    }
    evaluate_scattering(view, path, path.ray.dir, v);
    path.from = {v.surface, v.piece, v.contact};
    path.ray.origin = v.point;
    if (reflections < Ghosts::most) {
      PathState back = path;
      back.power *= v.reflect;
      leave_specular(view, back, v, specular_way(view, back.ray.dir, v, false, 0));
      follow(view, end, back, reflections + 1, paired, out);
      if (!paired && reflections > 0) return;
    }
    path.power *= v.transmit;
    leave_specular(view, path, v, specular_way(view, path.ray.dir, v, true, 0));
  }
}
Ghosts ghosts(World const& world, int surfaces, bool paired = true) {
  Ghosts found;
  PathState path;
  path.power = 1;
  path.ray = {{}, {0, 0, 1}};
  follow(world.view(), std::uint32_t(surfaces), path, 0, paired, found);
  return found;
}

// Sum over pairs b < a of R^2 T^(N - 2 + 2(a - b)).
double two_reflections(int n) {
  double sum = 0;
  for (int apart = 1; apart < n; ++apart)
    sum += (n - apart) * reflect * reflect * std::pow(1 - reflect, n - 2 + 2 * apart);
  return sum;
}

TEST(GhostCount, TwentySurfacesScene9) {
  World const world = stack(20);
  Ghosts const found = ghosts(world, 20);
  EXPECT_EQ(found.count[0], 1);
  EXPECT_EQ(found.count[2], 190);
  EXPECT_EQ(found.count[4], 30115);
  EXPECT_EQ(found.count[1] + found.count[3], 0);
  EXPECT_NEAR(found.power[0], std::pow(1 - reflect, 20), 1e-12);
  EXPECT_NEAR(found.power[2], two_reflections(20), 1e-12);
  EXPECT_NE(ghosts(world, 20, false).count[2], 190);  // control: a reflected ray that is never transmitted again
}

// The walk on six surfaces: each of the 15 ways with two reflections turns up, and their power is the sum of theirs.
struct Ways : Silent {
  std::uint32_t end = 0, reflections = 0;
  std::vector<std::uint32_t> way;
  std::set<std::vector<std::uint32_t>> two;
  double power = 0;
  Sampler sampled;
  void visit(PathState const& path, Vertex const& v) {
    reflections += path.hop.left_by == Event::reflect;
    way.push_back(v.surface.value);
    if (v.surface.value != end || reflections != 2) return;
    two.insert(way);
    power = path.power;
  }
  void close() {
    sampled.add(power);
    power = 0;
    reflections = 0;
    way.clear();
  }
};
TEST(GhostCount, TheWalkFindsThemAll) {
  World const world = stack(6);
  Ways ways;
  ways.end = 6;
  walk(world, 1 << 19, ways, [&] { ways.close(); });
  EXPECT_EQ(ways.two.size(), 15u);
  EXPECT_EQ(ghosts(world, 6).count[2], 15);
  expect_mean("two reflections", ways.sampled.mean(), two_reflections(6), 0.05 * two_reflections(6));
  expect_rejected("one surface more", ways.sampled.mean(), two_reflections(7));
}

}  // namespace
}  // namespace straytrace::testing
