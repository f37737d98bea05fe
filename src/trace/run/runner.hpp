// SPDX-License-Identifier: BSD-3-Clause
// Runs blocks on threads and adds the sums of blocks run elsewhere.
#pragma once

#include <algorithm>
#include <bit>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "base/math/constants.hpp"
#include "trace/result.hpp"
#include "trace/run/trace.hpp"

namespace straytrace::trace {

// Blocks still to be run, in ascending order; blocks given back come first. Used by several threads at once.
class BlockQueue {
 public:
  explicit BlockQueue(std::vector<BlockRange> const& missing) : missing_(missing.begin(), missing.end()) {
    for (BlockRange const& range : missing_) left_ += range.size();
  }
  // The next block; none when all have been taken.
  std::optional<std::uint64_t> take() {
    std::scoped_lock const lock(mutex_);
    if (left_ == 0) return {};
    --left_;
    std::uint64_t const block = missing_.front().first++;
    if (missing_.front().size() == 0) missing_.pop_front();
    return block;
  }
  // The next range of at most `most` blocks that is a node of the sum tree; the blocks before it stay.
  std::optional<BlockRange> take_node(std::uint64_t most) {
    std::scoped_lock const lock(mutex_);
    for (std::uint64_t size = std::bit_floor(std::max<std::uint64_t>(most, 1)); left_ > 0; size /= 2)
      for (auto at = missing_.begin(); at != missing_.end(); ++at) {
        std::uint64_t const first = (at->first + size - 1) / size * size, end = first + size;
        if (end > at->end) continue;
        BlockRange const before{at->first, first};
        at->first = end;
        if (at->size() == 0) at = missing_.erase(at);
        if (before.size() > 0) missing_.insert(at, before);
        left_ -= size;
        return BlockRange{first, end};
      }
    return {};
  }
  // Returns blocks that were taken but not run.
  void give_back(BlockRange range) {
    std::scoped_lock const lock(mutex_);
    missing_.push_front(range);
    left_ += range.size();
  }
  std::uint64_t left() const {
    std::scoped_lock const lock(mutex_);
    return left_;
  }
  void end() {  // drops all remaining blocks
    std::scoped_lock const lock(mutex_);
    missing_.clear();
    left_ = 0;
  }

 private:
  mutable std::mutex mutex_;
  std::deque<BlockRange> missing_;  // none of them empty
  std::uint64_t left_ = 0;
};

// Other processes that run blocks of the same queue; called by the thread that called Runner::run.
class RemoteWorkers {
 public:
  virtual ~RemoteWorkers() = default;
  // Sends blocks and adds returned sums. `stop`: sends no more and ends the blocks in progress.
  virtual void serve(BlockQueue&, bool stop, std::function<void(SumTree)> const& add) = 0;
  virtual bool idle() const = 0;
};

// Threads take blocks from the queue and add them to the tree, whose bits do not depend on the order.
class Runner {
 public:
  Runner(SteeredWorld const&, TraceSettings const&, Backend const&, SumTree done);

  // Runs the missing blocks of `range`; false if stopped before. Rethrows exceptions of threads and workers.
  bool run(BlockRange range, RemoteWorkers* workers = nullptr);

  bool interrupted() const { return settings_.stop && settings_.stop->load(); }
  bool out_of_time() const { return seconds() > settings_.max_seconds; }
  SumTree const& tree() const { return tree_; }  // between runs
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  double error() const { return error_; }  // of the stop rule at the last check
  void set_error(double error, std::uint64_t blocks);
  std::uint64_t wanted_blocks = 0;             // for the progress
  std::function<void(SumTree)> at_checkpoint;  // called from time to time while blocks are missing

 private:
  using Clock = std::chrono::steady_clock;
  void work(BlockQueue&);
  // Sums of a node of the tree. Threads merge siblings at the same time: they are then in no tree until it has their
  // parent.
  void add(unsigned level, std::uint64_t index, BlockSums);
  void watch(BlockQueue&, RemoteWorkers*, unsigned const& working);
  void checkpoint(BlockQueue const&);
  void report();

  SteeredWorld const& world_;
  TraceSettings const& settings_;
  Backend const& backend_;
  SumTree tree_;
  Clock::time_point start_ = Clock::now();
  std::mutex mutex_;  // of all below, and of the tree
  std::condition_variable wake_;
  std::uint64_t blocks_, first_of_session_, rays_ = 0;
  double last_checkpoint_ = 0, last_report_ = 0;  // s since the start
  double error_;
  std::uint64_t error_histories_;
};

}  // namespace straytrace::trace
