// SPDX-License-Identifier: BSD-3-Clause
// Work divided among threads.
#include "base/process/threads.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace straytrace::testing::base_threads {
namespace {

TEST(Threads, EachPartOnce) {
  for (unsigned const threads : {0u, 1u, 3u, 64u})
    for (std::size_t const count : {0u, 1u, 2u, 1000u}) {
      std::vector<std::atomic<int>> calls(1000);
      in_parallel(count, threads, [&](std::size_t i) { ++calls[i]; });
      auto const once = std::count(calls.begin(), calls.end(), 1), never = std::count(calls.begin(), calls.end(), 0);
      EXPECT_EQ(std::size_t(once), count) << threads;
      EXPECT_EQ(std::size_t(never), 1000 - count) << threads;
    }
}

TEST(Threads, OneIsTheCaller) {
  std::atomic<int> elsewhere = 0;
  auto const caller = std::this_thread::get_id();
  in_parallel(100, 1, [&](std::size_t) { elsewhere += std::this_thread::get_id() != caller; });
  EXPECT_EQ(elsewhere, 0);
}

TEST(Threads, FailureReachesTheCaller) {
  for (unsigned const threads : {1u, 3u}) {
    std::atomic<int> calls = 0;
    EXPECT_THROW(in_parallel(1000, threads,
                             [&](std::size_t i) {
                               ++calls;
                               if (i == 5) throw std::runtime_error("part 5");
                             }),
                 std::runtime_error);
    EXPECT_GE(calls, 6);
  }
}

TEST(ThreadTeam, EachPartOfEachWorkOnce) {
  for (unsigned const threads : {0u, 1u, 3u, 16u}) {
    ThreadTeam team(threads);
    for (std::size_t const count : {1000u, 0u, 1u, 2u, 1000u, 7u}) {
      std::vector<std::atomic<int>> calls(1000);
      team.run(count, [&](std::size_t i) { ++calls[i]; });
      auto const once = std::count(calls.begin(), calls.end(), 1), never = std::count(calls.begin(), calls.end(), 0);
      EXPECT_EQ(std::size_t(once), count) << threads;
      EXPECT_EQ(std::size_t(never), 1000 - count) << threads;
    }
  }
}

// Each of two parts waits for the other: two threads are at work.
TEST(ThreadTeam, OthersTakePart) {
  ThreadTeam team(2);
  for (int round = 0; round < 10; ++round) {
    std::atomic<int> arrived = 0;
    team.run(2, [&](std::size_t) {
      for (++arrived; arrived < 2;) std::this_thread::yield();
    });
    EXPECT_EQ(arrived, 2);
  }
}

// What one work leaves is there for the next, whoever did which part.
TEST(ThreadTeam, WorksFollowEachOther) {
  ThreadTeam team(3);
  std::vector<int> values(100), sums(100);
  for (int round = 1; round <= 100; ++round) {
    team.run(100, [&](std::size_t i) { values[i] = round; });
    team.run(100, [&](std::size_t i) { sums[i] += values[99 - i]; });
  }
  EXPECT_EQ(std::count(sums.begin(), sums.end(), 100 * 101 / 2), 100);
}

}  // namespace
}  // namespace straytrace::testing::base_threads
