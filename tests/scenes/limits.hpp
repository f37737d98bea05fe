// SPDX-License-Identifier: BSD-3-Clause
// Programs that are started with little memory, little room on disk, or without the rights of root.
#pragma once

#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <cstdio>
#include <functional>
#include <unistd.h>

#include "scenes/program.hpp"

namespace straytrace::testing {

// A limit that programs inherit, of this object's life. Sanitizers reserve terabytes of addresses: no limit there.
class Limit {
 public:
  Limit(int resource, rlim_t most) : resource_(resource) {
    ::getrlimit(Resource(resource_), &before_);
    rlimit const now{most, before_.rlim_max};
    if (!(sanitized && resource == RLIMIT_AS)) ::setrlimit(Resource(resource_), &now);
  }
  ~Limit() { ::setrlimit(Resource(resource_), &before_); }
  Limit(Limit const&) = delete;
  Limit& operator=(Limit const&) = delete;

 private:
  using Resource = decltype(RLIMIT_AS);
  int resource_;
  rlimit before_ = {};
};

// Runs `checks` in a process whose programs obey the permissions of files, also when it belongs to root.
inline bool without_rights(std::function<void()> const& checks) {
  pid_t const child = ::fork();
  if (child == 0) {
    for (int right : {CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH}) ::prctl(PR_CAPBSET_DROP, right, 0, 0, 0);
    checks();
    std::fflush(stdout);
    ::_exit(::testing::Test::HasFailure() ? 1 : 0);
  }
  int status = 0;
  return ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace straytrace::testing
