// SPDX-License-Identifier: BSD-3-Clause
// A device against one core: bench_device [ENGINE [EXAMPLE...]]. One JSON line per scene.
#include <nlohmann/json.hpp>

#include <chrono>
#include <iostream>
#include <thread>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "scene/scene.hpp"
#include "trace/backend/device/device_backend.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::bench {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

World example(std::string const& name) {
  Scene const scene = read_scene(STRAY_SOURCE_DIR "/examples/" + name + ".yaml");
  World world = build_world(scene);
  scene.throw_if_problems();
  steer(world);
  return world;
}

struct Rate {
  double histories_per_s = 0, rays_per_s = 0;
};
// Blocks [first, first + count), by as many callers as the backend wants.
Rate rate_of(Backend const& backend, World const& world, std::uint64_t first, std::uint64_t count) {
  std::atomic<std::uint64_t> next = first, rays = 0;
  double const start = now();
  {
    std::vector<std::jthread> callers;
    for (unsigned i = 0; i < std::max(1u, backend.callers()); ++i)
      callers.emplace_back([&] {
        for (std::uint64_t b = next++; b < first + count; b = next++)
          rays += backend.run_block(SteeredWorld::as_given(world), 1, b).rays;
      });
  }
  double const seconds = now() - start;
  return {double(count * largest_block) / seconds, double(rays) / seconds};
}

void compare(std::string const& name, std::string const& library) {
  World const world = example(name);
  auto engine = library.empty() ? cuda_engine() : load_engine(library);
  DeviceFacts const facts = engine->facts();
  BatchCounts last;
  std::uint64_t again = 0;
  auto const device = device_backend("device", std::move(engine), {0, [&](BatchCounts const& counts) {
                                                                     last = counts;
                                                                     again += counts.run_again;
                                                                   }});
  std::uint64_t const batch = facts.blocks_at_once;
  rate_of(*device, world, 0, 2 * batch);  // memory is taken, room has grown
  again = 0;
  Rate const on_device = rate_of(*device, world, 2 * batch, 8 * batch);
  Rate const on_core = rate_of(*make_backend("cpu"), world, 0, 16);
  std::cout << nlohmann::json{{"name", name},
                              {"device", facts.name},
                              {"histories_per_s", on_device.histories_per_s},
                              {"rays_per_s", on_device.rays_per_s},
                              {"rays_per_s_of_one_core", on_core.rays_per_s},
                              {"ratio", on_device.rays_per_s / on_core.rays_per_s},
                              {"occupancy", facts.occupancy},
                              {"registers", facts.registers},
                              {"local_bytes", facts.local_bytes},
                              {"histories_under_way", facts.workers},
                              {"device_bytes", last.bytes},
                              {"run_on_host", double(again) / double(8 * batch * largest_block)}}
                   .dump()
            << std::endl;
}

}  // namespace
}  // namespace straytrace::bench

int main(int argc, char** argv) {
  using namespace straytrace;
  try {
    std::vector<std::string> names{argv + std::min(argc, 2), argv + argc};
    if (names.empty()) names = {"virgo_arm", "arm_tube", "bench", "pipe"};
    for (std::string const& name : names) bench::compare(name, argc > 1 ? argv[1] : "");
  } catch (InputError const& e) {
    std::cerr << e.what() << '\n';
    return 2;
  }
}
