// SPDX-License-Identifier: BSD-3-Clause
// Which class a score falls into, and what the class knows about its paths.
#include <set>

#include "trace/tally/replay.hpp"
#include "trace/tally/route.hpp"
#include "trace_support.hpp"

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

}  // namespace
}  // namespace straytrace::testing
