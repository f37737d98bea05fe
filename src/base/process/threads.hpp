// SPDX-License-Identifier: BSD-3-Clause
// Work divided among threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <limits>
#include <thread>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace {

unsigned thread_count(unsigned wanted);  // 0: one for each core that this process may use

// Calls work(0) to work(count - 1), each once, on `threads` threads (0: all cores) including the calling one, in no
// fixed order. Throws what `work` throws, one of several, once all threads have ended.
void in_parallel(std::size_t count, unsigned threads, std::function<void(std::size_t)> const& work);

// Threads that stay for many divided works, each too short to start threads for it.

class ThreadTeam {
 public:
  explicit ThreadTeam(unsigned threads);  // 0: one for each core that this process may use
  ~ThreadTeam();
  ThreadTeam(ThreadTeam const&) = delete;
  ThreadTeam& operator=(ThreadTeam const&) = delete;

  // As in_parallel; from one thread at a time. Threads that wake too late, on a busy machine, are not waited for.
  void run(std::size_t count, std::function<void(std::size_t)> const& work);

 private:
  static constexpr int closed = std::numeric_limits<int>::min() / 2;

  void dismiss();
  void serve();
  bool enter();
  void leave();
  void take_part();

  std::function<void(std::size_t)> const* work_ = nullptr;
  std::size_t count_ = 0;
  std::atomic<std::size_t> next_{0};
  std::atomic<unsigned> round_{0};
  std::atomic<int> inside_{closed};  // threads that take part, besides the caller; closed on top when none may enter
  std::atomic<bool> over_{false};
  std::vector<std::jthread> others_;
};

}  // namespace straytrace
