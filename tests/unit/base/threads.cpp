// SPDX-License-Identifier: BSD-3-Clause
// Work divided among threads.
#include "base/process/threads.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
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

}  // namespace
}  // namespace straytrace::testing::base_threads
