// SPDX-License-Identifier: BSD-3-Clause
#include "base/process/threads.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace straytrace {

unsigned thread_count(unsigned wanted) { return wanted ? wanted : std::max(1u, std::thread::hardware_concurrency()); }

void in_parallel(std::size_t count, unsigned threads, std::function<void(std::size_t)> const& work) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  auto const loop = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    } catch (...) {
      next = count;
      std::scoped_lock const lock(mutex);
      failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < std::min<std::size_t>(thread_count(threads), count); ++i) others.emplace_back(loop);
    loop();
  }
  if (failure) std::rethrow_exception(failure);
}

ThreadTeam::ThreadTeam(unsigned threads) {
  try {
    for (unsigned i = 1; i < thread_count(threads); ++i) others_.emplace_back([this] { serve(); });
  } catch (...) {  // no more threads: those that have started must not wait when they are joined
    dismiss();
    throw;
  }
}

ThreadTeam::~ThreadTeam() { dismiss(); }

void ThreadTeam::dismiss() {
  over_ = true;
  ++round_;
  round_.notify_all();
}

void ThreadTeam::run(std::size_t count, std::function<void(std::size_t)> const& work) {
  work_ = &work;
  count_ = count;
  next_ = 0;
  inside_ = 0;
  ++round_;
  round_.notify_all();
  take_part();
  for (int inside = inside_ += closed; inside != closed; inside = inside_) inside_.wait(inside);
}

void ThreadTeam::serve() {
  for (unsigned seen = 0;;) {
    round_.wait(seen);
    seen = round_;
    if (over_) return;
    if (!enter()) continue;
    take_part();
    leave();
  }
}

bool ThreadTeam::enter() {
  int inside = inside_;
  while (inside >= 0)
    if (inside_.compare_exchange_weak(inside, inside + 1)) return true;
  return false;
}

void ThreadTeam::leave() {
  if (--inside_ == closed) inside_.notify_one();
}

void ThreadTeam::take_part() {
  for (std::size_t i = next_++; i < count_; i = next_++) (*work_)(i);
}

}  // namespace straytrace
