// SPDX-License-Identifier: BSD-3-Clause
// The straytrace program as a child process, and folders for what it writes.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <unistd.h>
#include <vector>

#include "base/sanitized.hpp"

namespace straytrace::testing {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

inline std::string const source_folder = STRAY_SOURCE_DIR;
inline std::string const virgo_arm = source_folder + "/examples/virgo_arm.yaml";
// The same arm without the library, written out: for tests that change its text.
inline std::string const written_arm = source_folder + "/tests/scenes/virgo_arm.yaml";
inline std::string const storm = source_folder + "/examples/storm.yaml";
inline std::string const et_hf = source_folder + "/tests/scenes/et_hf_backscatter.yaml";

inline std::string text_of(fs::path const& file) {
  std::ifstream in(file, std::ios::binary);
  EXPECT_TRUE(in) << "cannot read " << file;
  return {std::istreambuf_iterator<char>(in), {}};
}
inline void write_text(fs::path const& file, std::string const& text) { std::ofstream(file, std::ios::binary) << text; }
// `from` stands in the text exactly once; anything else would make the test check something else.
inline std::string edited(std::string text, std::string const& from, std::string const& to) {
  std::size_t const at = text.find(from);
  EXPECT_NE(at, text.npos) << "not there: " << from;
  EXPECT_EQ(text.find(from, at + 1), text.npos) << "there twice: " << from;
  return at == text.npos ? text : text.replace(at, from.size(), to);
}

class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "straytrace-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  Folder(Folder const&) = delete;
  Folder& operator=(Folder const&) = delete;
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  std::string operator/(std::string const& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }

 private:
  fs::path path_;
};

struct Finished {
  int code = -1;
  std::string out, err;
};

struct Launch {
  std::string in = ".";                // working folder
  bool picture = false;                // report.png takes longer than most runs of these tests
  int seconds = sanitized ? 600 : 60;  // then it is killed, and the code is 124 or 137
};

class Program {
 public:
  explicit Program(Words const& words, Launch const& how = {}) {
    Words all{"timeout", "--foreground", "-k", "5", std::to_string(how.seconds), STRAY_PROGRAM};
    all.insert(all.end(), words.begin(), words.end());
    child_ = ::fork();
    if (child_ == 0) become(all, how);
  }
  Program(Program const&) = delete;
  Program& operator=(Program const&) = delete;
  ~Program() {
    if (child_ > 0) wait();
  }

  void interrupt() const { ::kill(child_, SIGINT); }
  std::string said() const {  // on stderr, so far
    std::ifstream in(folder_ / "err");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  Finished wait() {
    int status = 0;
    while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    child_ = -1;
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128, text_of(folder_ / "out"), text_of(folder_ / "err")};
  }

 private:
  [[noreturn]] void become(Words& words, Launch const& how) const {
    std::vector<char*> arguments;
    for (std::string& w : words) arguments.push_back(w.data());
    arguments.push_back(nullptr);
    int const out = ::open((folder_ / "out").c_str(), O_CREAT | O_WRONLY, 0600),
              err = ::open((folder_ / "err").c_str(), O_CREAT | O_WRONLY, 0600), in = ::open("/dev/null", O_RDONLY);
    ::dup2(in, STDIN_FILENO);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(err, STDERR_FILENO);
    if (!how.picture) ::setenv("STRAYTRACE_PYTHON", "/bin/false", 1);
    if (::chdir(how.in.c_str()) == 0) ::execvp(arguments[0], arguments.data());
    ::_exit(127);
  }

  Folder folder_;
  pid_t child_ = -1;
};

inline Finished straytrace(Words const& words, Launch const& how = {}) { return Program(words, how).wait(); }

}  // namespace straytrace::testing
