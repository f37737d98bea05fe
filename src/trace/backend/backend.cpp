// SPDX-License-Identifier: BSD-3-Clause
#include "trace/backend/backend.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"
#include "trace/backend/device/device_backend.hpp"
#include "trace/step/flight.hpp"
#include "trace/tally/block_sink.hpp"

namespace straytrace::trace {

std::unique_ptr<Backend> make_backend(std::string_view name) {
  if (name == "cpu") return cpu_backend();
  if (name == "cuda") return device_backend("cuda", cuda_engine());
  throw InputError(fmt::format("there is no backend '{}'", name),
                   "write cpu or cuda; mpi is for trace alone, under mpirun");
}

namespace {

class Cpu final : public Backend {
 public:
  std::string_view name() const override { return "cpu"; }
  BlockSums run_block(SteeredWorld const& world, std::uint64_t seed, std::uint64_t block) const override {
    WorldView const view = world.view();
    BlockSink sink(view, world->groups().size(), int(block % replica_count));
    thread_local std::vector<History> room = Flight<HistoryTally>::room();
    Flight<HistoryTally> flight(view, seed, room);
    flight.run(block * view.block_size, (block + 1) * view.block_size,
               [&](HistoryTally const& tally) { sink.add(tally); });
    return sink.finish();
  }
};

}  // namespace

std::unique_ptr<Backend> cpu_backend() { return std::make_unique<Cpu>(); }

}  // namespace straytrace::trace
