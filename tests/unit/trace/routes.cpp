// SPDX-License-Identifier: BSD-3-Clause
// Which class a score falls into, what the class records about its paths, and replay of scores from their addresses.
#include <array>
#include <set>
#include <unordered_set>

#include "support/trace_support.hpp"
#include "trace/tally/coupling_table.hpp"
#include "trace/tally/history_tally.hpp"
#include "trace/tally/replay.hpp"

namespace straytrace::testing {
namespace {

// Two facing Lambertian discs; the lower one is lit by beam 0, the upper one by as many beams as there are `profiles`.
World facing_discs(std::vector<Profile> const& profiles, bool emit_from_all = false) {
  World world;
  std::uint32_t const white = lambertian_optic(world, 0.5), black = black_optic(world);
  SurfaceId const low =
      world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, white, black, world.add_body("low", {}), world.add_group("low"));
  SurfaceId const high = world.add_surface(Disk{{0, 0, 1}, {0, 0, -1}, 0, 1}, white, black,
                                           world.add_body("high", {0, 0, 1}), world.add_group("high"));
  Footprint source = spot(low, {}, {0, 0, -1}, Profile::even, 1, world.add_port("low"));
  world.add_footprint(source);
  std::uint32_t beam = 0;
  for (Profile const profile : profiles) {
    Footprint f =
        spot(high, {0, 0, 1}, {0, 0, 1}, profile, 1, world.add_port("high " + std::to_string(beam)), beam + 1);
    ++beam;
    f.emits = emit_from_all;
    world.add_footprint(f);
  }
  world.limits.max_order = 2;
  world.finish();
  return world;
}

double port_sum(TraceResult const& r, std::string const& port) {
  double sum = 0;
  for (CouplingClass const& c : r.coupling.classes)
    if (r.coupling.ports[c.port.value] == port) sum += c.coupling.mean;
  return sum;
}

// Beams that light one and the same surface do not take light from each other.
TEST(Routes, BeamsSharingASurfaceKeepTheirLight) {
  std::uint64_t const n = 1 << 16;
  double const alone = port_sum(run_histories(facing_discs({Profile::even}), n), "high 0");
  TraceResult const shared = run_histories(facing_discs({Profile::even, Profile::even}), n);
  EXPECT_NEAR(port_sum(shared, "high 0"), alone, 5e-3 * alone);
  EXPECT_NEAR(port_sum(shared, "high 1"), alone, 5e-3 * alone);
}

// C_rev belongs to the pair of beams at the two ends, so routes over the same groups are kept apart (eq. 1.5).
TEST(Routes, SourceBeamsAreKeptApart) {
  TraceResult const r = run_histories(facing_discs({Profile::even}, true), 1 << 17);
  std::multiset<std::pair<std::string, double>> found;
  for (CouplingClass const& c : r.coupling.classes) found.insert({route_name(r.coupling, c), c.reverse});
  EXPECT_EQ(found.count({"low·S > high·S", 1}), 1u);
  EXPECT_EQ(found.count({"low·S > high·S > low·S", 2}), 1u);
  World shared = facing_discs({Profile::even}, true);
  Footprint second = spot({0}, {}, {0, 0, -1}, Profile::gaussian, 0.3, shared.footprints()[0].port, 7);
  second.receives = false;  // beam 7 lights the lower disc as well, its light rejoins beam 0
  shared.add_footprint(second);
  shared.finish();
  TraceResult const mixed = run_histories(shared, 1 << 17);
  int two_ways = 0, one_way = 0;
  for (CouplingClass const& c : mixed.coupling.classes)
    if (route_name(mixed.coupling, c) == "low·S > high·S > low·S") ++(c.reverse == 2 ? two_ways : one_way);
  EXPECT_EQ(two_ways, 1);
  EXPECT_EQ(one_way, 1);
}

// All routes of up to five vertices over ten groups have different names.
TEST(Routes, HashesDiffer) {
  std::unordered_set<std::uint64_t> seen;
  std::vector<std::uint64_t> last{0};
  std::size_t count = 0;
  for (int length = 1; length <= 4; ++length) {
    std::vector<std::uint64_t> next;
    for (std::uint64_t const route : last)
      for (std::uint32_t g = 0; g < 10; ++g)
        for (Event const e : {Event::scatter, Event::reflect}) next.push_back(extended(route, GroupId{g}, e));
    seen.insert(next.begin(), next.end());
    count += next.size();
    last = std::move(next);
  }
  EXPECT_EQ(seen.size(), count);
  // control: a name that forgets the order of the vertices
  auto const sum = [](std::uint32_t a, std::uint32_t b) {
    return extended(0, GroupId{a}, Event::scatter) + extended(0, GroupId{b}, Event::scatter);
  };
  EXPECT_EQ(sum(1, 2), sum(2, 1));
}

// Analog hits and connections belong to one route; the limit on lengths makes `other`.
TEST(Routes, NamesAndLengths) {
  World world = facing_discs({Profile::even});
  world.limits.max_order = 4;
  world.limits.route_vertices = 3;
  TraceResult const r = run_histories(world, 1 << 17);
  std::multiset<std::string> names;
  for (CouplingClass const& c : r.coupling.classes) names.insert(route_name(r.coupling, c));
  EXPECT_EQ(names, (std::multiset<std::string>{"low·S", "low·S > high·S", "low·S > high·S > low·S", "other > high 0",
                                               "other > low"}));
  for (CouplingClass const& c : r.coupling.classes) {  // a row `other` lists its routes
    EXPECT_EQ(c.folded.empty(), !c.steps.empty());
    if (!c.steps.empty()) continue;
    EXPECT_EQ(c.folded_routes, 1u);
    EXPECT_EQ(c.folded.front().mean, c.coupling.mean);
    EXPECT_EQ(c.folded.front().why, "more vertices than 'route_vertices' names");
    ASSERT_EQ(c.members.size(), 1u);
    EXPECT_TRUE(c.members.front().steps.empty());
  }
  double sum = 0;
  for (CouplingClass const& c : r.coupling.classes) sum += c.coupling.mean;
  world.limits.route_vertices = 9;
  double all = 0;
  for (CouplingClass const& c : run_histories(world, 1 << 17).coupling.classes) all += c.coupling.mean;
  EXPECT_NEAR(sum, all, 1e-12 * all);  // names do not change the light
}

// The paths of a row `other` name their routes: those of their replays. Control: the route of the next path.
TEST(Routes, PathsInOtherKnowTheirRoutes) {
  World world = facing_discs({Profile::even, Profile::even}, true);
  world.limits.max_order = 6;
  world.limits.route_vertices = 9;
  TraceResult const r = run_histories(world, 1 << 10);  // too few for routes of many vertices
  std::size_t paths = 0, differ = 0;
  std::set<std::uint32_t> met;
  for (CouplingClass const& c : r.coupling.classes) {
    for (PathRecord const& p : c.records) {
      EXPECT_EQ(p.member == no_member, !c.steps.empty());
      if (p.member == no_member) continue;
      ASSERT_LT(p.member, c.members.size());
      auto const path = replay(SteeredWorld::as_given(world), 1, p.history, p.event, p.connection);
      ASSERT_TRUE(path);
      std::vector<PathStep> steps;
      for (auto const& v : path->vertices) steps.push_back({v.group, v.event});
      auto const is_route = [&](std::uint32_t member) {
        return c.members[member].steps == steps || c.members[member].steps == backwards(steps);
      };
      EXPECT_TRUE(is_route(p.member)) << route_name(r.coupling, c);
      differ += !is_route((p.member + 1) % std::uint32_t(c.members.size()));
      met.insert(p.member);
      ++paths;
    }
  }
  EXPECT_GT(met.size(), 1u);
  EXPECT_GT(paths, 10u);
  EXPECT_GT(differ, paths / 2);  // control
}

// Every score of some histories, made again from its address.
struct Score {
  std::uint64_t history;
  std::uint32_t event, number, lit, vertices;
  double coupling;
};
struct Scores : Silent {
  WorldView view;
  std::vector<Score> all;
  void score(PathState const& p, Vertex const& v, std::uint32_t lit, std::uint32_t number, Vertex const& y, double f) {
    all.push_back({p.history, p.event, number, lit, route_of(view, p, v, lit, number, y.surface).vertices, f});
  }
};
TEST(Replay, MakesEveryScoreAgain) {
  World const world = facing_discs({Profile::even, Profile::gaussian}, true);
  Scores scores;
  scores.view = world.view();
  walk(world, 500, scores, [] {});
  ASSERT_GT(scores.all.size(), 1000u);
  std::set<std::array<std::uint64_t, 3>> addresses;
  int control_found = 0;
  for (Score const& s : scores.all) {
    EXPECT_TRUE(addresses.insert({s.history, s.event, s.number}).second) << "two scores with one address";
    auto const path = replay(SteeredWorld::as_given(world), 1, s.history, s.event, s.number);
    ASSERT_TRUE(path);
    EXPECT_EQ(path->coupling, s.coupling);
    EXPECT_EQ(path->goal, s.lit);
    ASSERT_EQ(path->vertices.size(), s.vertices);
    double length_sum = 0;
    for (std::size_t i = 1; i < path->vertices.size(); ++i) {
      length_sum += length(path->vertices[i].point - path->vertices[i - 1].point);
      EXPECT_NEAR(length(path->vertices[i].in - path->vertices[i - 1].out), 0, 1e-14);
    }
    EXPECT_NEAR(path->path_length, length_sum, 1e-12);
    EXPECT_EQ(path->vertices.back().event, Event::couple);
    auto const other = replay(SteeredWorld::as_given(world), 2, s.history, s.event, s.number);  // control: another seed
    control_found += other && other->coupling == s.coupling;
  }
  EXPECT_LT(control_found, int(scores.all.size()) / 2);
  EXPECT_FALSE(replay(SteeredWorld::as_given(world), 1, 0, 77, 1));
  EXPECT_FALSE(replay(SteeredWorld::as_given(world), 1, 0, 0, 999));
}

}  // namespace
}  // namespace straytrace::testing
