// SPDX-License-Identifier: BSD-3-Clause
// Memory of a run does not grow with its rays (R3.09: 1e7 rays in 2 GB, 200 bytes each).
#include <sys/resource.h>
#include <sys/wait.h>

#include <unistd.h>

#include "support/trace_support.hpp"

namespace straytrace::testing {
namespace {

constexpr double allowed = 2e9 / 1e7;  // bytes per ray
constexpr std::uint32_t orders = 50;

World box() {  // two facing mirrors that lose nothing, with a wall between them
  World world;
  BodyId const body = world.add_body("box", {});
  std::uint32_t const white = lambertian_optic(world, 1);
  SurfaceId const floor = world.add_surface(Disk{{}, {0, 0, 1}, 0, 1}, white, white, body, world.add_group("floor"));
  world.add_surface(Disk{{0, 0, 1}, {0, 0, -1}, 0, 1}, white, white, body, world.add_group("lid"));
  world.add_surface(Cylinder{{}, {0, 0, 1}, 1, 0, 1}, white, white, body, world.add_group("wall"));
  world.add_footprint(spot(floor, {}, {0, 0, -1}, Profile::even, 0.3, world.add_port("floor")));
  world.limits.max_order = orders;
  world.finish();
  return world;
}

// Largest resident size, in bytes, of a process that does `work`.
template <class Work>
double peak_of(Work&& work) {
  pid_t const child = fork();
  if (child == 0) {
    try {
      work();
    } catch (...) {
      _exit(1);  // or the child would run the other tests
    }
    _exit(0);
  }
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child || status != 0) return -1;
  return 1024.0 * double(usage.ru_maxrss);
}

TEST(Memory, DoesNotGrowWithTheRaysR3_09) {
  World const world = box();
  auto const traced = [&](std::uint64_t histories) { return peak_of([&] { run_histories(world, histories); }); };
  std::uint64_t const few = 8 * largest_block, many = 24 * largest_block;
  double const rays = 2.0 * double((many - few) * orders);  // the walk, and a connection to the port at every vertex
  ASSERT_GT(2 * many * orders, 9000000u);
  double const start = peak_of([] {}), a = traced(few), b = traced(many);
  ASSERT_GT(start, 0);
  ASSERT_GT(a, 0);
  EXPECT_LT(b, 2e9);
  EXPECT_LT((b - a) / rays, 1) << "bytes per ray beyond the first " << 2 * few * orders;
  EXPECT_LT(b - start, 2e8);
  // control: a record of a few hundred bytes kept for every ray is found by the same measurement
  std::size_t const some = 400000;
  double const kept = peak_of([&] {
    std::vector<PathState> record(some);
    for (PathState& p : record) p.power = 1;
    if (record.back().power != 1) _exit(1);
  });
  EXPECT_GT((kept - start) / double(some), allowed);
}

}  // namespace
}  // namespace straytrace::testing
