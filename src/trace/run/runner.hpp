// SPDX-License-Identifier: BSD-3-Clause
// Runs blocks on threads, and adds what others have run.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>

#include "base/math/constants.hpp"
#include "trace/run/block_queue.hpp"
#include "trace/run/trace.hpp"

namespace straytrace {

// Others who run blocks of the same handout; called by the thread that called Runner::run.
class RemoteWorkers {
 public:
  virtual ~RemoteWorkers() = default;
  // Hands out blocks and adds what was done. `stop`: no more of them, and those under way come to an end.
  virtual void serve(BlockQueue&, bool stop, std::function<void(SumTree)> const& add) = 0;
  virtual bool idle() const = 0;
};

// Threads take blocks from the handout and add them to the tree, whose bits do not depend on the order.
class Runner {
 public:
  Runner(World const&, TraceSettings const&, Backend const&, SumTree done);

  // Runs the blocks of `range` that are missing; false when stopped before. Throws what a thread or helper has thrown.
  bool run(BlockRange range, RemoteWorkers* workers = nullptr);

  bool interrupted() const { return settings_.stop && settings_.stop->load(); }
  bool out_of_time() const { return seconds() > settings_.max_seconds; }
  SumTree const& tree() const { return tree_; }  // between runs
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  double error() const { return error_; }  // of the stop rule at the last look
  void saw(double error, std::uint64_t blocks);
  std::uint64_t wanted_blocks = 0;             // for the progress
  std::function<void(SumTree)> at_checkpoint;  // from time to time while blocks are missing

 private:
  using Clock = std::chrono::steady_clock;
  void work(BlockQueue&);
  void add(SumTree const&);
  void watch(BlockQueue&, RemoteWorkers*, unsigned const& working);
  void checkpoint(BlockQueue const&);
  void report();

  World const& world_;
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

}  // namespace straytrace
