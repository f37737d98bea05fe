// SPDX-License-Identifier: BSD-3-Clause
#include "base/process/thread_team.hpp"

#include "base/process/threads.hpp"

namespace straytrace {

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
