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
#include <dlfcn.h>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <new>
#include <spawn.h>
#include <string_view>
#include <unistd.h>

#include "base/errors.hpp"

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

extern char** environ;

namespace straytrace {
namespace {

namespace fs = std::filesystem;

std::string interpreter(PythonChoice choice) {
  if (std::string const chosen = environment_variable("STRAYTRACE_PYTHON"); !chosen.empty()) return chosen;
  std::string const system = "/usr/bin/python3";
  return choice == PythonChoice::system && ::access(system.c_str(), X_OK) == 0 ? system : "python3";
}

bool holds_package(fs::path const& folder) {
  std::error_code ignored;
  return fs::exists(folder / "straytrace" / "plots" / "__main__.py", ignored);
}

std::string package_folder() {
  if (std::string const chosen = environment_variable("STRAYTRACE_PYTHONPATH"); !chosen.empty()) return chosen;
  std::error_code unknown;
  fs::path above = fs::read_symlink("/proc/self/exe", unknown).parent_path();
  for (; !above.empty(); above = above.parent_path()) {
    if (holds_package(above)) return above;  // as pip installs it
    if (holds_package(above / "python")) return above / "python";
    if (holds_package(above / "share/straytrace/python")) return above / "share/straytrace/python";
    if (above == above.root_path()) break;
  }
#ifdef STRAYTRACE_SOURCE_PYTHON
  if (holds_package(STRAYTRACE_SOURCE_PYTHON)) return STRAYTRACE_SOURCE_PYTHON;
#endif
  return "";
}

std::vector<std::string> child_environment(std::string const& folder) {
  std::string path = folder;
  if (std::string const old = environment_variable("PYTHONPATH"); !old.empty()) path += ":" + old;
  std::vector<std::string> all = {"PYTHONPATH=" + path, "PYTHONDONTWRITEBYTECODE=1", "MPLBACKEND=Agg"};
  for (char** entry = environ; *entry; ++entry) {
    std::string_view const text = *entry;
    if (!text.starts_with("PYTHONPATH=") && !text.starts_with("PYTHONDONTWRITEBYTECODE=") &&
        !text.starts_with("MPLBACKEND="))
      all.emplace_back(text);
  }
  return all;
}

}  // namespace

PythonChild run_python(std::vector<std::string> words, PythonChoice choice) {
  PythonChild child{{}, interpreter(choice), true};
  std::string const folder = package_folder();
  if (folder.empty()) {
    child.has_package = false;
    return child;
  }
  words.insert(words.begin(), {child.python, "-m"});
  static_cast<FinishedChild&>(child) = run_child(std::move(words), child_environment(folder));
  return child;
}

TemporaryFolder::TemporaryFolder(std::string const& purpose) {
  std::error_code none;
  std::string name = (fs::temp_directory_path(none) / "straytrace-XXXXXX").string();
  if (none || ::mkdtemp(name.data()) == nullptr)
    throw InputError(
        fmt::format("cannot make a folder in '{}' for {}",
                    none ? environment_variable("TMPDIR") : fs::path(name).parent_path().string(), purpose),
        "set TMPDIR to another one");
  folder_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

std::filesystem::path program_file() {
  std::error_code ignored;
  std::filesystem::path const running = std::filesystem::read_symlink("/proc/self/exe", ignored);
  bool const by_loader = running.filename().string().starts_with("ld-linux");
  return by_loader ? running.parent_path() / "straytrace" : running;
}

std::string installed_library(std::string const& name) {
  std::error_code ignored;
  std::filesystem::path const program = program_file().parent_path();
  for (auto const& place : {program / name, program / ".." / "lib" / "straytrace" / name})
    if (std::filesystem::exists(place, ignored)) return place.lexically_normal().string();
  return {};
}

void* library_symbol(std::string const& library, std::string const& symbol, std::string const& remedy) {
  void* const loaded = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!loaded) throw InputError(dlerror(), remedy);
  void* const found = dlsym(loaded, symbol.c_str());
  if (!found) throw InputError(fmt::format("'{}' is not an engine of straytrace", library), remedy);
  return found;
}

}  // namespace straytrace
