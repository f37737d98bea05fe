// SPDX-License-Identifier: BSD-3-Clause
// Work in a copy of the process: what it returns comes back, what it breaks stays there.
#include <gtest/gtest.h>

#include <csignal>
#include <ctime>
#include <stdexcept>
#include <vector>

#include "base/process/child_process.hpp"

namespace straytrace {
namespace {

constexpr Bounds bounds{std::size_t{1} << 28, 1};

TEST(SandboxResult, BytesComeBack) {
  std::string const large(3 << 20, 'x');
  SandboxResult const done = run_sandboxed([&] { return large; }, bounds);
  EXPECT_EQ(done.why, "");
  EXPECT_TRUE(done.bytes == large);
}

TEST(SandboxResult, WhatBreaksStaysThere) {
  int here = 1;
  EXPECT_EQ(run_sandboxed([&] { return std::string(std::size_t(++here), 'x'); }, bounds).bytes, "xx");
  EXPECT_EQ(here, 1);
  auto const why = [](auto work) { return run_sandboxed(work, bounds).why; };
  EXPECT_EQ(why([]() -> std::string {
              ::raise(SIGSEGV);
              return "x";
            }),
            "Segmentation fault");
  EXPECT_EQ(why([]() -> std::string {
              ::raise(SIGABRT);
              return "x";
            }),
            "Aborted");
  EXPECT_EQ(why([]() -> std::string { throw std::runtime_error("x"); }), "the library that reads it failed");
  EXPECT_EQ(why([]() -> std::string { throw std::bad_alloc(); }), "it takes more than 256 MB of memory");
  EXPECT_EQ(why([]() -> std::string {
              while (std::clock() >= 0) {
              }
              return "never";
            }),
            "it takes more than 1 s");
}

}  // namespace
}  // namespace straytrace
