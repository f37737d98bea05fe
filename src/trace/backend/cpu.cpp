// SPDX-License-Identifier: BSD-3-Clause
#include "trace/backend/cpu.hpp"

#include "trace/step/flight.hpp"
#include "trace/tally/block_sink.hpp"

namespace straytrace {
namespace {

class Cpu final : public Backend {
 public:
  std::string_view name() const override { return "cpu"; }
  BlockSums run_block(World const& world, std::uint64_t seed, std::uint64_t block) const override {
    WorldView const view = world.view();
    BlockSink sink(view, world.groups().size(), int(block % replica_count));
    Flight<HistoryTally> flight(view, seed);
    flight.run(block * view.block_size, (block + 1) * view.block_size,
               [&](HistoryTally const& tally) { sink.add(tally); });
    return sink.finish();
  }
};

}  // namespace

std::unique_ptr<Backend> cpu_backend() { return std::make_unique<Cpu>(); }

}  // namespace straytrace
