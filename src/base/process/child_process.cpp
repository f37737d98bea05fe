// SPDX-License-Identifier: BSD-3-Clause
#include "base/process/child_process.hpp"

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <new>
#include <spawn.h>
#include <unistd.h>

namespace straytrace {
namespace {

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> all;
  for (std::string& t : texts) all.push_back(t.data());
  all.push_back(nullptr);
  return all;
}

// Output of a pipe until nobody can write to it any more.
std::string read_all(int descriptor) {
  std::string bytes;
  std::array<char, 65536> buffer = {};
  for (;;) {
    ssize_t const got = ::read(descriptor, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return bytes;
    bytes.append(buffer.data(), std::size_t(got));
  }
}

constexpr int no_memory = 3, failed = 4;  // exit status of the copy

// Only in sanitized builds: an error of a library in this copy must not count as a finding of the fuzzer.
extern "C" __attribute__((weak)) void __sanitizer_set_death_callback(void (*)());

void keep_within(Bounds bounds) {
  rlim_t const seconds = sanitized ? std::min<rlim_t>(bounds.seconds, 5) : bounds.seconds;
  rlimit const no_dump{0, 0}, time{seconds, seconds + 1};  // SIGXCPU first, then SIGKILL
  ::setrlimit(RLIMIT_CORE, &no_dump);
  ::setrlimit(RLIMIT_CPU, &time);
  if (sanitized) {  // no limit of addresses; the limit of time also limits the memory
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
    ::dup2(nowhere, STDERR_FILENO);  // hide messages of libraries; why_it_ended() reports the failure
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

FinishedChild run_child(std::vector<std::string> arguments, std::vector<std::string> variables) {
  std::array<int, 2> ends = {};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return {errno, -1, ""};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  pid_t child = 0;
  FinishedChild result;
  result.start_error = ::posix_spawnp(&child, arguments[0].c_str(), &actions, nullptr, pointers(arguments).data(),
                                      pointers(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (result.start_error == 0) {
    result.output = read_all(ends[0]);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  }
  ::close(ends[0]);
  return result;
}

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
