// SPDX-License-Identifier: BSD-3-Clause
// A device leaves the bits of the host: every scene, shape and law, traced by the emulation of a device
// (host_emulation.cpp), which runs the kernels, sorts and sums of a device on the host. See docs/develop/device.md.
#include <gtest/gtest.h>

#include <mutex>
#include <thread>

#include "contract/geometry/instances.hpp"
#include "device/blocks.hpp"
#include "device/laws.hpp"
#include "support/mesh_shapes.hpp"
#include "support/trace_support.hpp"
#include "trace/importance/importance.hpp"
#include "trace/tally/block_sink.hpp"

namespace straytrace::testing {
namespace {

// The blocks of a world on a device, requested by as many threads at once.
std::vector<std::string> on_device(World const& world, std::vector<std::uint64_t> const& blocks, BatchCounts& counts,
                                   std::uint32_t room = 0) {
  auto const backend = device_backend("emulation", load_engine(engine_tested()),
                                      {room, [&](BatchCounts const& c) { counts.run_again += c.run_again; }});
  std::vector<std::string> found(blocks.size());
  std::vector<std::jthread> callers;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    callers.emplace_back(
        [&, i] { found[i] = bytes_of(backend->run_block(SteeredWorld::as_given(world), 7, blocks[i])); });
  callers.clear();
  return found;
}
std::vector<std::string> on_host(World const& world, std::vector<std::uint64_t> const& blocks) {
  auto const backend = make_backend("cpu");
  std::vector<std::string> found;
  for (std::uint64_t const b : blocks)
    found.push_back(bytes_of(backend->run_block(SteeredWorld::as_given(world), 7, b)));
  return found;
}

void expect_same(World const& world, std::vector<std::uint64_t> const& blocks) {
  BatchCounts counts;
  auto const device = on_device(world, blocks, counts), host = on_host(world, blocks);
  for (std::size_t i = 0; i < blocks.size(); ++i) EXPECT_TRUE(device[i] == host[i]) << "block " << blocks[i];
  EXPECT_LT(counts.run_again, blocks.size() * largest_block / 4);
}

class Example : public ::testing::TestWithParam<char const*> {};

TEST_P(Example, LeavesTheBitsOfTheHost) {
  World const world = example(GetParam());
  expect_same(world, {3});
}
INSTANTIATE_TEST_SUITE_P(Device, Example,
                         ::testing::Values("arm_tube", "bench", "cad_bench", "end_bench", "et_hf_arm", "pipe",
                                           "two_mirrors", "virgo_arm", "benches/michelson", "benches/output_isolator",
                                           "benches/pick_off", "benches/rb1_telescope", "benches/two_tone_wall"));

TEST(Device, PathsBelowTheCrossoverLeaveTheBitsOfTheHost) {
  World const world = arm_in_halo();
  EXPECT_GT(world.halo().cells.size(), 1000u);
  expect_same(world, {3});
}

// Every shape, and every law on some of them, in a bright room with a lit mirror and a camera; paths that split.
class Room {
 public:
  Room() : body_(world.add_body("all", {})), optics_(optics_of_all_laws(world)) {
    add_shapes(static_cast<ShapeTypes*>(nullptr));
    Optic bright;
    bright.laws = 2;
    bright.law[0] = world.add_law(Lambertian{0.6});
    bright.law[1] = world.add_law(Lambertian{0.2});
    std::uint32_t const wall = world.add_optic(bright), mirror = power_law_optic(world, 0.01, 2, 1e-5, 0.9);
    world.add_surface(sphere(12), wall, wall, body_, world.add_group("wall"));
    SurfaceId const lit =
        world.add_surface(disk(0, 0.3, {{0, 0, -3}, {0, 0, 1}}), mirror, wall, body_, world.add_group("mirror"));
    SurfaceId const chip =
        world.add_surface(disk(0, 0.5, {{0, 3, 3}, {0, -1, 0}}), wall, wall, body_, world.add_group("camera"));
    world.add_footprint(spot(lit, {0, 0, -3}, {0, 0, -1}, Profile::gaussian, 0.05, world.add_port("port")));
    Receiver camera;
    camera.surface = chip;
    camera.frame = facing_along({0, 3, 3}, {0, -1, 0});
    camera.columns = camera.rows = 8;
    camera.half_width = camera.half_height = 0.5;
    camera.angle_bins = 6;
    camera.quadrants = true;
    camera.quadrant_frame = camera.frame;
    world.add_receiver("camera", camera);
    world.limits.max_order = 40;
    world.limits.children = 2;
    world.finish();
    steer(world);
  }

  World world;

 private:
  template <class... S>
  void add_shapes(std::tuple<S...>*) {
    (add_shape<S>(), ...);
  }
  template <class S>
  void add_shape() {
    if constexpr (std::is_same_v<S, TriangleMesh>)
      for (int i = 0; i < 2; ++i) add(rock(i));
    else
      add(instances<S>().front());
  }
  TriangleMesh rock(int number) {
    Pose const pose = facing_along({0, 0, 0}, unit({0.1 * number, 0.2, 1}));
    return mesh_of(bumpy(8, 0.1), pose, 0.4);
  }
  template <class S>
  void add(S shape) {
    double const turn = 0.618 * placed_, height = -6 + 0.7 * placed_;
    SinCos const at = sincos_turn(turn - std::floor(turn));
    shape.place(facing_along({6 * at.cos, 6 * at.sin, height}, unit({at.sin, 0.3, at.cos})));
    std::uint32_t const optic = optics_[placed_ % optics_.size()];
    world.add_surface(shape, optic, optic, body_, world.add_group(S::key));
    ++placed_;
  }

  BodyId body_;
  std::vector<std::uint32_t> optics_;
  std::size_t placed_ = 0;
};

TEST(Device, EveryShapeAndLaw) {
  Room room;
  expect_same(room.world, {0, 9});
  room.world.polarised = true;
  expect_same(room.world, {2});
  room.world.limits.brute_force = true;
  expect_same(room.world, {2});
}

// Little room: what does not fit is run on the host, and nothing else changes.
TEST(Device, OverflowIsRunOnTheHost) {
  Room const room;
  BatchCounts none, some, many;
  auto const host = on_host(room.world, {4});
  EXPECT_TRUE(on_device(room.world, {4}, none) == host);
  EXPECT_TRUE(on_device(room.world, {4}, some, 40) == host);
  EXPECT_TRUE(on_device(room.world, {4}, many, 2) == host);
  EXPECT_GT(some.run_again, none.run_again);
  EXPECT_GT(many.run_again, some.run_again);
  EXPECT_LE(many.run_again, largest_block);
}

// Which block a history is in, and nothing else, decides where it counts: blocks in any company are the same.
TEST(Device, BlocksThatRunTogether) {
  Room const room;
  BatchCounts counts;
  std::vector<std::uint64_t> const blocks{1000000, 3, 2, 77};
  EXPECT_TRUE(on_device(room.world, blocks, counts) == on_host(room.world, blocks));
}

// Controls of the check itself: an order of adding up that is not that of the histories, and a bit of each kind of sum.
TEST(Device, OtherBitsAreSeen) {
  Room const room;
  WorldView const view = room.world.view();
  BlockSink backwards(view, room.world.groups().size(), 4);
  for (std::uint64_t h = 5 * largest_block; h-- > 4 * largest_block;) {
    HistoryTally tally(view, 7);
    tally.begin(h);
    trace_history(view, 7, h, tally);
    backwards.add(tally);
  }
  BlockSums const whole = make_backend("cpu")->run_block(SteeredWorld::as_given(room.world), 7, 4);
  std::string const host = bytes_of(whole);
  EXPECT_FALSE(bytes_of(backwards.finish()) == host);
  auto const seen = [&](auto const& change) {
    BlockSums other = whole;
    double& number = change(other);
    number = std::nextafter(number, infinity);
    return bytes_of(other) != host;
  };
  EXPECT_TRUE(seen([](BlockSums& b) -> double& { return b.classes.begin()->second.kept.back().priority; }));
  EXPECT_TRUE(seen([](BlockSums& b) -> double& { return b.classes.begin()->second.moments.tail.back(); }));
  EXPECT_TRUE(seen([](BlockSums& b) -> double& { return b.receivers[0].image.sum[5]; }));
  EXPECT_TRUE(seen([](BlockSums& b) -> double& { return b.receivers[0].angles.sum2[5]; }));
  EXPECT_TRUE(seen([](BlockSums& b) -> double& { return b.absorbed.back().sum; }));
}

}  // namespace
}  // namespace straytrace::testing
