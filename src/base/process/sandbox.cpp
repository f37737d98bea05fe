// SPDX-License-Identifier: BSD-3-Clause
#include "base/process/sandbox.hpp"

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <new>
#include <string_view>
#include <unistd.h>

#include "base/errors.hpp"
#include "base/process/child_process.hpp"
#include "base/process/sanitized.hpp"

namespace straytrace {
namespace {

constexpr int no_memory = 3, failed = 4;  // how the copy ends

// Of sanitized builds: what a library does wrong here is no finding of the fuzzer that this is a copy of.
extern "C" __attribute__((weak)) void __sanitizer_set_death_callback(void (*)());

void keep_within(Bounds bounds) {
  rlim_t const seconds = sanitized ? std::min<rlim_t>(bounds.seconds, 5) : bounds.seconds;
  rlimit const no_dump{0, 0}, time{seconds, seconds + 1};  // it is told before it is killed
  ::setrlimit(RLIMIT_CORE, &no_dump);
  ::setrlimit(RLIMIT_CPU, &time);
  if (sanitized) {  // which reserves terabytes of addresses; little is taken in little time
    if (__sanitizer_set_death_callback) __sanitizer_set_death_callback(nullptr);
    return;
  }
  rlimit limit = {};
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  if (pages == 0 || ::getrlimit(RLIMIT_AS, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_cur, pages * std::size_t(::sysconf(_SC_PAGESIZE)) + bounds.memory);
  ::setrlimit(RLIMIT_AS, &limit);
}

void write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    ssize_t const done = ::write(descriptor, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) ::_exit(failed);
    bytes.remove_prefix(std::size_t(done));
  }
}

[[noreturn]] void be_the_copy(std::function<std::string()> const& work, Bounds bounds, int to) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (int const nowhere = ::open("/dev/null", O_WRONLY); nowhere >= 0 && !sanitized)
    ::dup2(nowhere, STDERR_FILENO);  // last words of libraries; how it ended is told in ours
  for (int deadly : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU}) std::signal(deadly, SIG_DFL);
  keep_within(bounds);
  try {
    write_all(to, work());
  } catch (std::bad_alloc const&) {
    ::_exit(no_memory);
  } catch (std::exception const&) {
    ::_exit(failed);
  }
  ::_exit(0);
}

[[noreturn]] void no_copy() {
  throw NumericalError(fmt::format("cannot start the process that reads a file of the user: {}", std::strerror(errno)));
}

std::string why_it_ended(int status, Bounds bounds) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) return fmt::format("it takes more than {} s", bounds.seconds);
  if (WIFSIGNALED(status)) return ::strsignal(WTERMSIG(status));
  if (WEXITSTATUS(status) == 0) return "";
  return WEXITSTATUS(status) == no_memory ? fmt::format("it takes more than {} MB of memory", bounds.memory >> 20)
                                          : "the library that reads it failed";
}

}  // namespace

SandboxResult run_sandboxed(std::function<std::string()> const& work, Bounds bounds) {
  std::array<int, 2> ends = {};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) no_copy();
  pid_t const copy = ::fork();
  if (copy == 0) be_the_copy(work, bounds, ends[1]);
  int const error = errno;
  ::close(ends[1]);
  SandboxResult result;
  if (copy > 0) result.bytes = read_all(ends[0]);
  ::close(ends[0]);
  if (errno = error; copy < 0) no_copy();
  int status = 0;
  while (::waitpid(copy, &status, 0) < 0 && errno == EINTR) {
  }
  result.why = why_it_ended(status, bounds);
  if (!result.why.empty()) result.bytes.clear();
  return result;
}

}  // namespace straytrace
