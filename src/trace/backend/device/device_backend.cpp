// SPDX-License-Identifier: BSD-3-Clause
#include "trace/backend/device/device_backend.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>

#include "base/errors.hpp"
#include "base/process/child_process.hpp"
#include "trace/backend/device/world_image.hpp"
#include "trace/step/step.hpp"
#include "trace/tally/block_sink.hpp"

namespace straytrace::trace {

namespace {

HistoryRun run_on_host(WorldView const& world, std::uint64_t seed, std::uint64_t number) {
  HistoryTally tally(world, seed);
  History history;
  tally.begin(number);
  trace_history(world, seed, number, history, tally);
  return {record_of(tally), {tally.totals(), tally.scores(), tally.arrivals(), tally.cells()}};
}

// The first thread to find the device free takes the blocks that wait, as many as keep it busy, and runs them for all.
class DeviceBackend final : public Backend {
 public:
  DeviceBackend(std::string name, std::unique_ptr<DeviceEngine> engine, DeviceSettings settings)
      : name_(std::move(name)), engine_(std::move(engine)), settings_(std::move(settings)) {}

  std::string_view name() const override { return name_; }
  // While the blocks of one half of the callers run, those of the other half are merged.
  unsigned callers() const override { return 2 * blocks_at_once(); }

  BlockSums run_block(SteeredWorld const& world, std::uint64_t seed, std::uint64_t block) const override {
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

  Place wait_for(SteeredWorld const& world, std::uint64_t seed, std::uint64_t block) const {
    Place mine;
    std::unique_lock lock(mutex_);
    waiting_.push_back({block, &mine});
    arrived_.notify_one();
    for (;;) {
      changed_.wait(lock, [&] { return mine.batch || !busy_; });
      if (mine.batch) return mine;
      busy_ = true;
      wait_for_others(lock);
      std::vector<Request> const together = next_batch();
      lock.unlock();
      auto const batch = run(world, seed, together);
      lock.lock();
      for (std::uint32_t i = 0; i < together.size(); ++i) *together[i].place = {batch, i};
      busy_ = false;
      changed_.notify_all();
    }
  }

  std::uint32_t blocks_at_once() const { return engine_->facts().blocks_at_once; }
  // A batch of one block takes about as long as one of a hundred: until these are here, or no more come.
  void wait_for_others(std::unique_lock<std::mutex>& lock) const {
    constexpr std::chrono::milliseconds patience{5};
    bool more = true;
    while (more && waiting_.size() < blocks_at_once()) {
      std::size_t const here = waiting_.size();
      more = arrived_.wait_for(lock, patience, [&] { return waiting_.size() > here; });
    }
  }
  std::vector<Request> next_batch() const {
    auto const end = waiting_.begin() + std::ptrdiff_t(std::min<std::size_t>(waiting_.size(), blocks_at_once()));
    std::vector<Request> batch(waiting_.begin(), end);
    waiting_.erase(waiting_.begin(), end);
    return batch;
  }

  std::shared_ptr<Batch> run(SteeredWorld const& world, std::uint64_t seed,
                             std::vector<Request> const& together) const {
    auto const batch = std::make_shared<Batch>();
    try {
      WorldView const view = world.view();
      load(&world.world(), view);
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
  // The world is copied at its first use.
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
  mutable std::condition_variable changed_, arrived_;
  mutable std::vector<Request> waiting_;
  mutable bool busy_ = false;
  mutable World const* loaded_ = nullptr;
};

}  // namespace

std::unique_ptr<Backend> device_backend(std::string name, std::unique_ptr<DeviceEngine> engine,
                                        DeviceSettings settings) {
  return std::make_unique<DeviceBackend>(std::move(name), std::move(engine), std::move(settings));
}

namespace {

// `tail`: descending.
Moments moments_of(MomentSums const& sums, double const* tail = nullptr, std::uint32_t tails = 0) {
  Moments m;
  m.sum = sums.sum;
  m.sum2 = sums.sum2;
  m.sum3 = sums.sum3;
  m.sum4 = sums.sum4;
  m.largest = sums.largest;
  m.largest_history = sums.largest_history;
  m.scored = sums.scored;
  m.tail.assign(tail, tail + tails);
  m.close_block();
  return m;
}

MapSums& map_of(ReceiverSums& receiver, MapKind map) {
  switch (map) {
    case MapKind::angles:
      return receiver.angles;
    case MapKind::quadrants:
      return receiver.quadrants;
    default:
      return receiver.image;
  }
}

}  // namespace

BatchBlocks::BatchBlocks(World const& world, BatchSums sums) : world_(world), sums_(std::move(sums)) {}

template <class Row>
BatchBlocks::Range<Row> BatchBlocks::of_block(std::vector<Row> const& rows, std::uint32_t position) {
  auto const first = std::partition_point(rows.begin(), rows.end(), [&](Row const& r) { return r.block < position; });
  auto const last = std::partition_point(first, rows.end(), [&](Row const& r) { return r.block == position; });
  return {rows.data() + (first - rows.begin()), rows.data() + (last - rows.begin())};
}

void BatchBlocks::put_totals(std::uint32_t position, int replica, BlockSums& block) const {
  for (TotalRow const& row : of_block(sums_.routes, position)) {
    KeptRow const& kept = sums_.routes_kept[std::size_t(&row - sums_.routes.data())];
    ClassSums& route = block.classes[row.route];
    route.port = row.port;
    route.moments = moments_of(row.moments, sums_.route_tails.data() + row.first_tail, row.tails);
    route.replica_sum[replica] = route.moments.sum;
    route.kept.assign(sums_.kept.data() + kept.first, sums_.kept.data() + kept.first + kept.count);
    route.off_list = kept.off_list;
    route.threshold = kept.threshold;
  }
  for (TotalRow const& row : of_block(sums_.receivers, position))
    block.receivers[row.port - first_receiver_end].power =
        moments_of(row.moments, sums_.receiver_tails.data() + row.first_tail, row.tails);
}

void BatchBlocks::put_maps(std::uint32_t position, BlockSums& block) const {
  for (CellRow const& row : of_block(sums_.cells, position)) {
    ReceiverSums& receiver = block.receivers[row.receiver];
    if (row.map == MapKind::field) {
      FieldSums& field = receiver.fields[row.route];
      if (field.power.empty())
        field.power = field.real = field.imaginary = std::vector<double>(receiver.image.sum.size());
      field.power[row.cell] = row.power;
      field.real[row.cell] = row.real;
      field.imaginary[row.cell] = row.imaginary;
    } else {
      MapSums& map = map_of(receiver, row.map);
      map.sum[row.cell] = row.power;
      map.sum2[row.cell] = row.power * row.power;
    }
  }
}

BlockSums BatchBlocks::block(std::uint32_t position, std::uint64_t number) const {
  int const replica = int(number % replica_count);
  BlockSums block = BlockSink(world_.view(), world_.groups().size(), replica).finish();  // zeros, of the right sizes
  BlockRow const& row = sums_.blocks[position];
  block.histories = largest_block;
  block.bounces = block.rays = row.bounces;
  block.lost = row.lost;
  block.window_variance = row.window_variance;
  block.emitted = moments_of(row.column[0]);
  for (int f = 0; f < balance_term_count; ++f) block.energy_balance[f] = moments_of(row.column[1 + f]);
  block.absorbed.back() = moments_of(row.column[1 + balance_term_count]);
  for (GroupRow const& group : of_block(sums_.groups, position)) {
    block.arrived[group.group] = moments_of(group.arrived);
    block.absorbed[group.group] = moments_of(group.absorbed);
  }
  put_totals(position, replica, block);
  put_maps(position, block);
  return block;
}

std::unique_ptr<DeviceEngine> load_engine(std::string const& library) {
  auto const make = reinterpret_cast<MakeDeviceEngine>(
      library_symbol(library, "straytrace_device_engine", "build it again, or use --backend cpu"));
  try {
    return std::unique_ptr<DeviceEngine>(make(device_abi));
  } catch (std::exception const& e) {
    throw InputError(e.what(), "use --backend cpu: it gives the same result");
  }
}

namespace {

std::string cuda_library() { return installed_library("libstraytrace_cuda.so"); }

}  // namespace

bool has_cuda_engine() { return !cuda_library().empty(); }

std::unique_ptr<DeviceEngine> cuda_engine() {
  std::string const library = cuda_library();
  if (library.empty())
    throw InputError(
        "this straytrace was built without CUDA",
        "build it where nvcc is found (docs/guide/gpu.md), or use --backend cpu: it gives the same result");
  return load_engine(library);
}

}  // namespace straytrace::trace
