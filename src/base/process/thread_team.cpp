// SPDX-License-Identifier: BSD-3-Clause
#include "base/process/thread_team.hpp"

#include "base/process/threads.hpp"

namespace straytrace {

ThreadTeam::ThreadTeam(unsigned threads) {
  for (unsigned i = 1; i < thread_count(threads); ++i) others_.emplace_back([this] { serve(); });
}

ThreadTeam::~ThreadTeam() {
  work_ = nullptr;
  ++round_;
  round_.notify_all();
}

void ThreadTeam::run(std::size_t count, std::function<void(std::size_t)> const& work) {
  work_ = &work;
  count_ = count;
  next_ = 0;
  busy_ = unsigned(others_.size());
  ++round_;
  round_.notify_all();
  take_part();
  for (unsigned busy = busy_; busy > 0; busy = busy_) busy_.wait(busy);
}

void ThreadTeam::serve() {
  for (unsigned seen = 0;;) {
    round_.wait(seen);
    ++seen;
    if (!work_) return;
    take_part();
    if (--busy_ == 0) busy_.notify_one();
  }
}

void ThreadTeam::take_part() {
  for (std::size_t i = next_++; i < count_; i = next_++) (*work_)(i);
}

}  // namespace straytrace
