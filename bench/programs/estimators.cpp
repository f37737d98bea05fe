// SPDX-License-Identifier: BSD-3-Clause
// The ways to sample, each on the same scenes of docs/theory/sampling.md: bench_estimators SECONDS TURNS prints a
// JSON line for each scene, quantity, way and seed. bench/estimators.py compares them.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <time.h>
#include <vector>

#include "scene/scene.hpp"
#include "support/baffled_tube.hpp"
#include "support/trace_received.hpp"

namespace straytrace::bench {
namespace {

using testing::SampleMean;

double processor_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

struct Quantity {
  std::string name;
  std::function<SampleMean(World&, TraceResult const&)> of;
};
struct Way {
  std::string name;
  std::function<World()> world;
  std::vector<Quantity> quantities;
  bool first_hit = false;  // on a ring: also that class
};
struct Scene {
  std::string name;
  std::vector<Way> ways;
};

// Power that arrives on a group, W per W of the beam.
Quantity arriving(std::string const& name, std::string const& group) {
  return {name, [group](World& world, TraceResult const& r) {
            SampleMean const share = testing::arrived(world, r, group);
            double const emitted = r.total.emitted.sum / double(r.total.histories);
            return testing::scaled(share, emitted);
          }};
}
Quantity power(std::string const& name, std::uint32_t receiver) {
  return {name, [receiver](World&, TraceResult const& r) {
            Estimate const& e = r.coupling.received_power[receiver];
            return testing::sample_mean(e, (long long)r.total.histories);
          }};
}

World steered(World world, bool windows) {
  ImportanceSettings settings;
  settings.window = windows;
  world.steer(make_importance(world, settings));
  return world;
}
World with_sub_paths(World world) {
  find_covered_receivers(world);
  return world;
}
// As a run prepares it.
World by_default(World world) {
  steer(world, 1);
  return world;
}

// Scores of receiver 0 by paths whose first hit was on a group: a class of routes without end, which no table has.
class FirstHit : public testing::Silent {
 public:
  FirstHit(WorldView const& view, GroupId group) : view_(view), group_(group) {}
  void visit(PathState const& path, Vertex const& vertex) {
    if (path.order == 1) by_group_ = view_.surfaces[vertex.surface.value].group.value == group_.value;
  }
  void score(PathState const&, Vertex const&, std::uint32_t goal, std::uint32_t, Vertex const&, double power) {
    if (by_group_ && goal == goal_of_receiver(view_, 0)) block_ += power;
  }
  void score_through(PathState const& path, Vertex const&, Vertex const& z, Chain const&, std::uint32_t goal,
                     Vertex const&, double power) {
    bool const first = path.order > 0 ? by_group_ : view_.surfaces[z.surface.value].group.value == group_.value;
    if (first && goal == goal_of_receiver(view_, 0)) block_ += power;
  }
  void close_history() {
    by_group_ = false;
    if (++histories_ % largest_block != 0) return;
    sum_ += block_;
    sum2_ += block_ * block_;
    block_ = 0;
  }
  // From the spread of whole blocks.
  SampleMean result() const {
    double const blocks = double(histories_ / largest_block), mean = sum_ / blocks;
    return {mean / largest_block, std::sqrt((sum2_ / blocks - mean * mean) / (blocks - 1)) / largest_block,
            (long long)histories_};
  }

 private:
  WorldView const view_;
  GroupId group_;
  bool by_group_ = false;
  std::uint64_t histories_ = 0;
  double block_ = 0, sum_ = 0, sum2_ = 0;
};

// Scene 11.
Scene tube_of_4_km() {
  std::vector<Quantity> const all{power("mirror to itself", 0), power("photodiode behind a ring", 1)};
  auto const open = [] { return testing::baffled_tube(); };
  return {"4 km tube",
          {{"analog: the law, waiting for hits",
            [] { return testing::baffled_tube(false); },
            {arriving("mirror to itself", "mirror"), arriving("photodiode behind a ring", "photodiode")}},
           {"law + connections", open, all, true},
           {"targets at the first hop + connections",
            [open] {
              World world = open();
              world.steer(testing::first_hop_only(make_importance(world)));
              return world;
            },
            all, true},
           {"targets at every hop + connections", [open] { return steered(open(), false); }, all, true},
           {"targets at every hop + connections + windows", [open] { return steered(open(), true); }, all, true},
           {"law + connections + sub-paths", [open] { return with_sub_paths(open()); }, all, true},
           {"default", [open] { return by_default(open()); }, all, true}}};
}

// Scene 12: a laser lights a square, which lights a second one at right angles, which lights the receiver. A thin plate
// of index 1 before the receiver changes nothing but that nothing can be connected to it.
World two_squares(bool plate, bool backwards) {
  World world;
  std::uint32_t const white = testing::lambertian_optic(world, 0.8), black = testing::black_optic(world);
  BodyId const body = world.add_body("all", {});
  auto const square = [&](char const* name, Vec3 centre, Vec3 normal, double side) {
    Rectangle r = testing::rectangle(side, side);
    r.place({centre, {0, 1, 0}, cross(normal, {0, 1, 0}), normal});
    world.add_surface(r, white, black, body, world.add_group(name));
  };
  square("A", {0.5, 0, 0}, {0, 0, 1}, 0.4);
  square("B", {0, 0, 0.7}, {1, 0, 0}, 1);
  testing::receive_on(world, "receiver",
                      world.add_surface(testing::disk(0, 0.05, {{1, 0, 0.7}, {-1, 0, 0}}), black, black, body,
                                        world.add_group("receiver")));
  if (plate) {
    std::uint32_t const bare = testing::glass_optic(world), volume = world.add_volume({1, 0});
    BodyId const glass = world.add_body("glass", {});
    for (double const side : {-1.0, 1.0}) {
      Rectangle r = testing::rectangle(3, 3);
      r.place({{0.75 + side * 2e-3, 0, 0.7}, {0, 1, 0}, {0, 0, -side}, {side, 0, 0}});
      world.add_surface(r, bare, bare, glass, world.add_group("glass"), volume);
    }
  }
  world.add_footprint(testing::free_beam(world.add_group("laser"), {0.5, 0, 1}, {0, 0, -1}, Profile::point, 0));
  world.limits.max_order = 12;
  world.finish();
  if (backwards) find_covered_receivers(world);
  return world;
}

Scene squares() {
  std::vector<Quantity> const watts{power("receiver", 0)};
  return {
      "two squares",
      {{"analog: the law, waiting for hits", [] { return two_squares(true, false); }, watts},
       {"adjoint: sub-paths from the receiver", [] { return two_squares(true, true); }, watts},
       {"law + connections", [] { return two_squares(false, false); }, watts},
       {"targets at every hop + connections + windows", [] { return steered(two_squares(false, false), true); }, watts},
       {"law + connections + sub-paths", [] { return two_squares(false, true); }, watts},
       {"default", [] { return by_default(two_squares(false, false)); }, watts}}};
}

// Scene 5: transmission of a diffuse tube, ten radii long, that absorbs half of the light at each bounce.
World tube_of_ten_radii() {
  World world;
  BodyId const body = world.add_body("tube", {});
  std::uint32_t const black = testing::black_optic(world);
  SurfaceId const mouth = world.add_surface(testing::disk(0, 1), testing::lambertian_optic(world, 1e-6), black, body,
                                            world.add_group("mouth"));
  world.add_surface(testing::cylinder(1, 0, 10), black, testing::lambertian_optic(world, 0.5), body,
                    world.add_group("wall"));
  testing::receive_on(
      world, "exit",
      world.add_surface(testing::disk(0, 1, {{0, 0, 10}, {0, 0, -1}}), black, black, body, world.add_group("exit")));
  world.add_footprint(testing::spot(mouth, {}, {0, 0, -1}, Profile::even, 1));
  world.limits.max_order = 20000;
  world.finish();
  return world;
}

Scene short_tube() {
  std::vector<Quantity> const exit{power("exit", 0)};
  return {"diffuse tube of 10 radii",
          {{"analog: the law, waiting for hits", tube_of_ten_radii, {arriving("exit", "exit")}},
           {"law + connections", tube_of_ten_radii, exit},
           {"targets at every hop + connections + windows", [] { return steered(tube_of_ten_radii(), true); }, exit},
           {"law + connections + sub-paths", [] { return with_sub_paths(tube_of_ten_radii()); }, exit},
           {"default", [] { return by_default(tube_of_ten_radii()); }, exit}}};
}

struct Spent {
  double seconds, setup;
  int turn;
  std::uint64_t histories;
};
void print(Scene const& scene, std::string const& way, std::string const& quantity, SampleMean s, Spent const& t,
           std::uint64_t rays) {
  bool const found = s.mean > 0 && s.std_error > 0;
  nlohmann::json line{{"scene", scene.name},  {"quantity", quantity}, {"way", way},   {"turn", t.turn},
                      {"seconds", t.seconds}, {"setup", t.setup},     {"rays", rays}, {"paths", t.histories}};
  line["value"] = found ? s.mean : 0;
  line["error"] = found ? s.std_error : 0;
  std::printf("%s\n", line.dump().c_str());
}

// The hard class of scene 11: from the mirror to a ring, and by any number of other surfaces back to the mirror.
void measure_first_hit(Scene const& scene, Way const& way, World& world, Spent spent) {
  FirstHit rings(world.view(), world.add_group("rings"));
  double const begin = processor_seconds();
  std::uint64_t const histories = spent.histories / largest_block * largest_block;
  testing::walk(
      world, histories, rings, [&] { rings.close_history(); }, std::uint64_t(spent.turn));
  spent.seconds = processor_seconds() - begin;
  print(scene, way.name, "first hit on a ring", rings.result(), spent, 0);
}

void measure(Scene const& scene, Way const& way, double seconds, int turns) {
  double const start = processor_seconds();
  World world = way.world();
  double const setup = processor_seconds() - start;
  constexpr std::uint64_t pilot = 1 << 15;
  double const before = processor_seconds();
  testing::run_histories(world, pilot, 1000, 1);
  double const each = (processor_seconds() - before) / double(pilot);
  auto const histories = std::max<std::uint64_t>(pilot * 4, std::uint64_t(seconds / each));
  for (int turn = 1; turn <= turns; ++turn) {
    double const begin = processor_seconds();
    TraceResult const r = testing::run_histories(world, histories, std::uint64_t(turn), 1);
    double const spent = processor_seconds() - begin;
    Spent const t{spent, setup, turn, r.total.histories};
    for (Quantity const& q : way.quantities) print(scene, way.name, q.name, q.of(world, r), t, r.total.bounces);
    if (way.first_hit) measure_first_hit(scene, way, world, t);
  }
}

}  // namespace
}  // namespace straytrace::bench

int main(int argc, char** argv) {
  using namespace straytrace::bench;
  if (argc != 3) return std::fprintf(stderr, "usage: bench_estimators SECONDS TURNS\n"), 2;
  for (Scene const& scene : {tube_of_4_km(), squares(), short_tube()})
    for (Way const& way : scene.ways) measure(scene, way, std::atof(argv[1]), std::atoi(argv[2]));
}
