// SPDX-License-Identifier: BSD-3-Clause
#include "trace/run/runner.hpp"

#include <exception>
#include <thread>

#include "base/process/threads.hpp"

namespace straytrace::trace {
namespace {

constexpr double report_seconds = 0.5;  // between reports of progress
constexpr std::chrono::milliseconds with_workers{2}, alone{500};

std::uint64_t blocks_in(SumTree const& tree) {
  std::uint64_t blocks = 0;
  for (BlockRange const& range : tree.done()) blocks += range.size();
  return blocks;
}

}  // namespace

Runner::Runner(SteeredWorld const& world, TraceSettings const& settings, Backend const& backend, SumTree done)
    : world_(world),
      settings_(settings),
      backend_(backend),
      tree_(std::move(done)),
      blocks_(blocks_in(tree_)),
      first_of_session_(blocks_),
      error_(settings.error_before),
      error_histories_(settings.histories_before) {}

void Runner::set_error(double error, std::uint64_t blocks) {
  error_ = error;
  error_histories_ = blocks * world_.block_size;
}

bool Runner::run(BlockRange range, RemoteWorkers* remote) {
  BlockQueue block_queue(tree_.missing(range));
  unsigned const threads = thread_count(settings_.threads);
  unsigned working = threads;
  std::exception_ptr failure;
  {
    std::vector<std::jthread> workers;
    for (unsigned i = 0; i < threads; ++i)
      workers.emplace_back([&] {
        std::exception_ptr mine;
        try {
          work(block_queue);
        } catch (...) {
          mine = std::current_exception();
          block_queue.end();
        }
        std::scoped_lock const lock(mutex_);
        if (mine) failure = mine;
        --working;
        wake_.notify_all();
      });
    try {
      watch(block_queue, remote, working);
    } catch (...) {
      block_queue.end();
      throw;
    }
  }
  if (failure) std::rethrow_exception(failure);
  report();
  return tree_.missing(range).empty();
}

void Runner::work(BlockQueue& block_queue) {
  while (!interrupted() && !out_of_time()) {
    std::optional<std::uint64_t> const block = block_queue.take();
    if (!block) return;
    BlockSums sums = backend_.run_block(world_, settings_.seed, *block);
    sum_phase_sensitivities(world_, settings_.seed, *block % replica_count, sums);
    add(0, *block, std::move(sums));
  }
}

void Runner::add(unsigned level, std::uint64_t index, BlockSums sums) {
  {
    std::scoped_lock const lock(mutex_);
    blocks_ += sums.blocks;
    rays_ += sums.rays;
  }
  for (;; ++level, index /= 2) {
    std::unique_lock lock(mutex_);
    std::optional<BlockSums> sibling = tree_.take_sibling(level, index);
    if (!sibling) {
      tree_.add(level, index, std::move(sums));
      return;
    }
    lock.unlock();
    sums = merged_siblings(index, std::move(sums), std::move(*sibling));
  }
}

void Runner::watch(BlockQueue& block_queue, RemoteWorkers* workers, unsigned const& working) {
  for (;;) {
    bool mine_done = false;
    {
      std::unique_lock lock(mutex_);
      mine_done = wake_.wait_for(lock, workers ? with_workers : alone, [&] { return working == 0; });
    }
    if (mine_done && (!workers || workers->idle())) return;
    if (mine_done) std::this_thread::sleep_for(with_workers);
    if (workers)
      workers->serve(block_queue, interrupted() || out_of_time(), [&](SumTree const& done) {
        for (auto const& [place, sums] : done.nodes()) add(place.second, place.first >> place.second, sums);
      });
    if (seconds() - last_report_ >= report_seconds) report();
    if (at_checkpoint && seconds() - last_checkpoint_ >= settings_.checkpoint_seconds) checkpoint(block_queue);
  }
}

// Not once all blocks are taken: the next check of a stop rule follows as soon as they are done, and a resumed run must
// check at the same number of blocks.
void Runner::checkpoint(BlockQueue const& block_queue) {
  SumTree done;
  {
    std::scoped_lock const lock(mutex_);
    if (block_queue.left() == 0) return;
    done = tree_;
  }
  double const begun = seconds();
  at_checkpoint(std::move(done));
  double const ended = seconds();
  last_checkpoint_ = ended + 9 * (ended - begun);  // checkpoints take a tenth of the time at most
}

void Runner::report() {
  last_report_ = seconds();
  if (!settings_.progress) return;
  TraceProgress p;
  {
    std::scoped_lock const lock(mutex_);
    p.histories = blocks_ * world_.block_size;
    p.seconds = last_report_;
    p.histories_per_s = double((blocks_ - first_of_session_) * world_.block_size) / p.seconds;
    p.rays_per_s = double(rays_) / p.seconds;
  }
  p.wanted_histories = wanted_blocks * world_.block_size;
  p.error = error_;
  p.error_histories = error_histories_;
  p.wanted_error = settings_.wanted_error;
  settings_.progress(p);
}

}  // namespace straytrace::trace
