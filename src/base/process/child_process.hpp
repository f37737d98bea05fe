// SPDX-License-Identifier: BSD-3-Clause
// Other programs, started without a shell, copies of this process that run libraries on untrusted files, the Python
// side, and libraries loaded on request.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/errors.hpp"
#include "base/namespaces.hpp"

namespace straytrace {

// Other programs, started without a shell, and copies of this process that run libraries on untrusted files.

// Whether this build has sanitizers, which are slow and reserve terabytes of addresses.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool sanitized = true;
#elif defined(__has_feature)
inline constexpr bool sanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool sanitized = false;
#endif

struct FinishedChild {
  int start_error = 0;  // errno when the program could not be started
  int status = -1;      // exit status
  std::string output;   // both streams
};
// arguments[0] is the program, looked up in PATH when it names no folder; `variables`: "NAME=value". Its standard input
// is empty.
FinishedChild run_child(std::vector<std::string> arguments, std::vector<std::string> variables);

struct SandboxResult {
  std::string bytes;
  std::string why;  // reason for a failure: "it takes more than 1024 MB", "Segmentation fault"; empty: success
};

struct Bounds {
  std::size_t memory;     // bytes beyond those of this process
  std::uint64_t seconds;  // of processor time
};

// Result of `work`, run in a copy of the process, so that a hostile file may crash a library or exhaust the memory.
// Other effects of `work` are lost. Throws NumericalError when the process cannot be copied.
SandboxResult run_sandboxed(std::function<std::string()> const& work, Bounds);

// Values as bytes, between two copies of this program.
class Packer {
 public:
  template <class T>
  void value(T const& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<char const*>(&v), sizeof v);
  }
  void count(std::uint64_t n) { value(n); }
  void add(std::string_view text) { count(text.size()), bytes_ += text; }
  template <class T>
  void add(std::vector<T> const& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    count(values.size());
    bytes_.append(reinterpret_cast<char const*>(values.data()), values.size() * sizeof(T));
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// Returns what Packer added, in the same order. Throws InputError when the bytes end early: a library that a file has
// corrupted may have written them. `bytes` must outlive the object.
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : left_(bytes) {}

  template <class T>
  T value() {
    T v;
    copy(&v, sizeof v);
    return v;
  }
  std::uint64_t count() { return value<std::uint64_t>(); }
  std::string text() { return std::string(next(count(), 1)); }
  template <class T>
  std::vector<T> values() {
    std::string_view const bytes = next(count(), sizeof(T));
    std::vector<T> all(bytes.size() / sizeof(T));
    if (!bytes.empty()) std::memcpy(all.data(), bytes.data(), bytes.size());
    return all;
  }

 private:
  std::string_view next(std::uint64_t many, std::size_t size) {
    if (many > left_.size() / size)
      throw InputError("the data that a library read are truncated", "copy the file again, or make it again");
    std::string_view const bytes = left_.substr(0, many * size);
    left_.remove_prefix(bytes.size());
    return bytes;
  }
  void copy(void* to, std::size_t size) { std::memcpy(to, next(size, 1).data(), size); }
  std::string_view left_;
};

// A variable of the environment; empty: not set.
inline std::string environment_variable(char const* name) {
  char const* const value = std::getenv(name);
  return value ? value : "";
}

// Modules of python/straytrace, run as programs.

// $STRAYTRACE_PYTHON, or else: `system` the Python of the system, which has Debian's packages; otherwise that of PATH,
// which an active environment of conda or venv replaces.
enum class PythonChoice : bool { path, system };

struct PythonChild : FinishedChild {
  std::string python;       // the interpreter
  bool has_package = true;  // false: the folder python/straytrace was not found, and nothing was started
};
// python -m words[0] words[1] ...
PythonChild run_python(std::vector<std::string> words, PythonChoice);

// A temporary folder, gone with the object. InputError where none can be made.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(std::string const& purpose);  // for the message: "the picture"
  ~TemporaryFolder();
  TemporaryFolder(TemporaryFolder const&) = delete;
  TemporaryFolder& operator=(TemporaryFolder const&) = delete;
  std::string path(std::string const& name) const { return folder_ + "/" + name; }

 private:
  std::string folder_;
};

// Shared libraries that the program loads on request.

// By which this program is started: its own file; of packages that bring their own loader, the starter next to that.
std::filesystem::path program_file();

// One of this build: in the folder of the program or in ../lib/straytrace. Empty: there is none.
std::string installed_library(std::string const& name);

// A symbol of a library, which is never unloaded: objects of its classes may outlive the loader. InputError with this
// remedy if the library cannot be loaded or has no such symbol.
void* library_symbol(std::string const& library, std::string const& symbol, std::string const& remedy);

}  // namespace straytrace
