// SPDX-License-Identifier: BSD-3-Clause
// Live pages: of a run while it is traced, and of a run file whose inputs change.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/errors.hpp"
#include "base/namespaces.hpp"
#include "io/loopback_server.hpp"
#include "scene/scene.hpp"
#include "session/interrupt.hpp"
#include "session/model.hpp"
#include "session/options.hpp"
#include "session/session.hpp"
#include "trace/run/trace.hpp"

namespace straytrace::session {

// The page of a run while it is traced (straytrace run --live).

// The address of a live page: printed on stderr, and opened in the browser.

// Prints the address, also with --quiet. `open`: gives it to the browser of the system by a file that only this user
// can read, since arguments of programs are public; the file goes with the object.
class LiveAddress {
 public:
  LiveAddress(std::string const& address, bool open);
  ~LiveAddress();
  LiveAddress(LiveAddress const&) = delete;
  LiveAddress& operator=(LiveAddress const&) = delete;

 private:
  std::string file_;  // empty: none
};

// The picture of a scene that follows its files (straytrace view --live).

// Serves the last good picture, and above it what is wrong with the scene since.
class LiveView {
 public:
  LiveView(std::string title, std::uint16_t port);  // 0: a free one
  std::string address() const { return server_->address("live"); }

  void show(std::string picture, std::string const& warnings);  // a page of view_page()
  void show_problems(std::string const& text);

 private:
  HttpReply answer(HttpRequest const&) const;

  std::string const page_;
  mutable std::mutex mutex_;  // of all below
  std::string picture_, problems_, warnings_;
  std::size_t pictures_ = 0, changes_ = 0;
  std::unique_ptr<LoopbackServer> server_;  // last: it answers from all the above
};

// The files of a scene on disk.
class SceneFiles {
 public:
  explicit SceneFiles(std::string main_file);

  void follow(FileTexts const&);                 // all that the scene consists of
  void follow(std::vector<std::string> const&);  // more, by name
  // Waits until one of them has changed and nothing changes any more; false: a signal came.
  bool wait_for_change(InterruptGuard const&);

 private:
  using Stamp = std::pair<std::filesystem::file_time_type, std::uintmax_t>;
  void add(std::string const& name);
  std::map<std::filesystem::path, Stamp> stamps() const;

  std::filesystem::path main_;
  std::map<std::filesystem::path, Stamp> seen_;
};

// Up to where a run is traced: the numbers of --histories and --until.
struct LiveTarget {
  std::uint64_t histories = 0;
  std::string until;  // empty: by number alone
};
// "2e6", "h_total < 1 %" or "10 min". Throws InputError for what the model cannot meet, or has met.
LiveTarget parse_live_target(std::string const& text, Model const&, std::uint64_t traced_histories);

// Serves the page. Curves and routes are those of the blocks merged so far; the page never changes a result. The model
// must outlive it.
class LiveRun {
 public:
  LiveRun(Model const&, std::uint16_t port);  // 0: a free one
  std::string address() const { return server_->address("live"); }
  TraceControl const& control() const { return control_; }

  bool extended() const;  // the page has sent a target that wait() has not returned yet
  void show_writing();    // its buttons act again after show_report()
  // The page shows this report. `early`: stopped before the target.
  void show_report(std::string html, TraceResult const&, bool early);
  // The next target of the page; none when it was closed, or a signal came.
  std::optional<LiveTarget> wait(InterruptGuard const&);

 private:
  enum class Phase : std::uint8_t { preparing, tracing, writing, finished };
  struct ErrorPoint {
    double histories = 0, error = 0;
  };

  HttpReply answer(HttpRequest const&);
  HttpReply extend(std::string const& text);
  HttpReply stop();
  std::string state() const;  // as JSON
  void show_progress(TraceProgress const&);
  void show_result(TraceResult const&);
  std::string result_json(TraceResult const&);

  Model const& model_;
  StopRule error_rule_;  // of the error that is shown: that of the model, or the total or the receivers
  TraceControl control_;
  std::string const page_;
  mutable std::mutex mutex_;  // of all below
  Phase phase_ = Phase::preparing;
  TraceProgress progress_;
  std::string result_, report_, target_text_;
  std::size_t results_ = 0;  // how many there were
  bool early_ = false, closed_ = false;
  std::optional<LiveTarget> target_;
  std::vector<ErrorPoint> errors_;
  std::unique_ptr<LoopbackServer> server_;  // last: it answers from all the above
};

}  // namespace straytrace::session
