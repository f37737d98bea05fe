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

#include "base/process/child_process.hpp"

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
// `from` occurs in the text exactly once; otherwise the test would check something else.
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
  bool paced = false;                  // it waits when it is a page of stderr ahead of said()
};

class Program {
 public:
  explicit Program(Words const& words, Launch const& how = {}) {
    Words all{"timeout", "--foreground", "-k", "5", std::to_string(how.seconds), STRAY_PROGRAM};
    all.insert(all.end(), words.begin(), words.end());
    if (how.paced) open_pipe();
    child_ = ::fork();
    if (child_ == 0) become(all, how);
    if (how.paced) ::close(pipe_[1]);
  }
  Program(Program const&) = delete;
  Program& operator=(Program const&) = delete;
  ~Program() {
    if (child_ > 0) wait();
    if (pipe_[0] >= 0) ::close(pipe_[0]);
  }

  void interrupt() const { ::kill(child_, SIGINT); }
  std::string said() {  // on stderr, so far
    if (pipe_[0] >= 0) return heard();
    std::ifstream in(folder_ / "err");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  // Waits for these words on stderr; false: it has ended without them or exceeded its time.
  bool says(std::string const& words) {
    for (bool running = true; running; ::usleep(20000)) {
      running = runs();
      if (said().find(words) != std::string::npos) return true;
    }
    return false;
  }
  Finished wait() {
    if (pipe_[0] >= 0) ::fcntl(pipe_[0], F_SETFL, 0);  // until the other end is closed
    std::string const all = said();
    int status = 0;
    while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    child_ = -1;
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128, text_of(folder_ / "out"),
            pipe_[0] >= 0 ? all : text_of(folder_ / "err")};
  }

 private:
  void open_pipe() {
    ASSERT_EQ(::pipe2(pipe_, O_CLOEXEC), 0);
    ASSERT_GT(::fcntl(pipe_[0], F_SETPIPE_SZ, 4096), 0);
    ::fcntl(pipe_[0], F_SETFL, O_NONBLOCK);
  }
  bool runs() const {
    siginfo_t ended{};
    return ::waitid(P_PID, id_t(child_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 && ended.si_pid == 0;
  }
  std::string heard() {
    char more[4096];
    for (ssize_t n = 1; n != 0;) {
      n = ::read(pipe_[0], more, sizeof more);
      if (n > 0) heard_.append(more, std::size_t(n));
      if (n < 0 && errno != EINTR) break;
    }
    return heard_;
  }
  [[noreturn]] void become(Words& words, Launch const& how) const {
    std::vector<char*> arguments;
    for (std::string& w : words) arguments.push_back(w.data());
    arguments.push_back(nullptr);
    int const out = ::open((folder_ / "out").c_str(), O_CREAT | O_WRONLY, 0600),
              err = how.paced ? pipe_[1] : ::open((folder_ / "err").c_str(), O_CREAT | O_WRONLY, 0600),
              in = ::open("/dev/null", O_RDONLY);
    ::dup2(in, STDIN_FILENO);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(err, STDERR_FILENO);
    if (!how.picture) ::setenv("STRAYTRACE_PYTHON", "/bin/false", 1);
    if (::chdir(how.in.c_str()) == 0) ::execvp(arguments[0], arguments.data());
    ::_exit(127);
  }

  Folder folder_;
  pid_t child_ = -1;
  int pipe_[2] = {-1, -1};
  std::string heard_;
};

inline Finished straytrace(Words const& words, Launch const& how = {}) { return Program(words, how).wait(); }

}  // namespace straytrace::testing
