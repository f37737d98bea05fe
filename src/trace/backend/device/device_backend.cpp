// SPDX-License-Identifier: BSD-3-Clause
#include "trace/backend/device/device_backend.hpp"

#include <condition_variable>
#include <mutex>
#include <optional>

#include "base/message.hpp"
#include "trace/backend/cpu/cpu.hpp"
#include "trace/backend/device/world_image.hpp"
#include "trace/history/step.hpp"

namespace straytrace {
namespace {

HistoryRun run_on_host(WorldView const& world, std::uint64_t seed, std::uint64_t number) {
  HistoryTally tally(world, seed);
  History history;
  tally.begin(number);
  trace_history(world, seed, number, history, tally);
  return {record_of(tally), {tally.totals(), tally.scores(), tally.arrivals(), tally.cells()}};
}

// Whoever comes first with the device free takes all blocks that wait and runs them for everyone.
class DeviceBackend final : public Backend {
 public:
  DeviceBackend(std::string name, std::unique_ptr<DeviceEngine> engine, DeviceSettings settings)
      : name_(std::move(name)), engine_(std::move(engine)), settings_(std::move(settings)) {}

  std::string_view name() const override { return name_; }
  unsigned callers() const override { return engine_->facts().blocks_at_once; }

  BlockSums run_block(World const& world, std::uint64_t seed, std::uint64_t block) const override {
    if (world.block_size != largest_block) return cpu_backend()->run_block(world, seed, block);  // few histories in all
    Place const mine = wait_for(world, seed, block);
    if (mine.batch->failure) std::rethrow_exception(mine.batch->failure);
    return mine.batch->blocks->block(mine.position, block);
  }

 private:
  struct Batch {
    std::optional<BatchBlocks> blocks;
    std::exception_ptr failure;
  };
  struct Place {
    std::shared_ptr<Batch> batch;  // none: it waits
    std::uint32_t position = 0;
  };
  struct Request {
    std::uint64_t block = 0;
    Place* place = nullptr;
  };

  Place wait_for(World const& world, std::uint64_t seed, std::uint64_t block) const {
    Place mine;
    std::unique_lock lock(mutex_);
    waiting_.push_back({block, &mine});
    for (;;) {
      changed_.wait(lock, [&] { return mine.batch || !busy_; });
      if (mine.batch) return mine;
      busy_ = true;
      std::vector<Request> const together = std::move(waiting_);
      waiting_.clear();
      lock.unlock();
      auto const batch = run(world, seed, together);
      lock.lock();
      for (std::uint32_t i = 0; i < together.size(); ++i) *together[i].place = {batch, i};
      busy_ = false;
      changed_.notify_all();
    }
  }

  std::shared_ptr<Batch> run(World const& world, std::uint64_t seed, std::vector<Request> const& together) const {
    auto const batch = std::make_shared<Batch>();
    try {
      WorldView const view = world.view();
      load(&world, view);
      BatchOrder order{seed, {}, settings_.room};
      for (Request const& r : together) order.blocks.push_back(r.block);
      BatchCounts counts;
      batch->blocks.emplace(world,
                            engine_->run(
                                order, [&](std::uint64_t number) { return run_on_host(view, seed, number); }, counts));
      if (settings_.after_batch) settings_.after_batch(counts);
    } catch (std::exception const& e) {
      batch->failure =
          std::make_exception_ptr(NumericalError(std::string("backend ") + name_ + ": " + e.what() +
                                                 "; the same trace with --backend cpu gives the same result"));
    }
    return batch;
  }
  // The world is copied when it is first seen.
  void load(World const* world, WorldView const& view) const {
    if (loaded_ == world) return;
    WorldImage const image(view);
    void* const place = engine_->room_for_world(image.size());
    engine_->load_world(image.placed_at(place));
    loaded_ = world;
  }

  std::string name_;
  std::unique_ptr<DeviceEngine> engine_;
  DeviceSettings settings_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  mutable std::vector<Request> waiting_;
  mutable bool busy_ = false;
  mutable World const* loaded_ = nullptr;
};

}  // namespace

std::unique_ptr<Backend> device_backend(std::string name, std::unique_ptr<DeviceEngine> engine,
                                        DeviceSettings settings) {
  return std::make_unique<DeviceBackend>(std::move(name), std::move(engine), std::move(settings));
}

}  // namespace straytrace
