// SPDX-License-Identifier: BSD-3-Clause
// Threads that do one divided work after the other, where each is too short to start threads for it.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace straytrace {

class ThreadTeam {
 public:
  explicit ThreadTeam(unsigned threads);  // 0: one for each core that this process may use
  ~ThreadTeam();
  ThreadTeam(ThreadTeam const&) = delete;
  ThreadTeam& operator=(ThreadTeam const&) = delete;

  // As in_parallel; from one thread at a time.
  void run(std::size_t count, std::function<void(std::size_t)> const& work);

 private:
  void serve();
  void take_part();

  std::function<void(std::size_t)> const* work_ = nullptr;  // null: go home
  std::size_t count_ = 0;
  std::atomic<std::size_t> next_{0};
  std::atomic<unsigned> round_{0}, busy_{0};
  std::vector<std::jthread> others_;
};

}  // namespace straytrace
