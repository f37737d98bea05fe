// SPDX-License-Identifier: BSD-3-Clause
// The page of a run while it is traced (straytrace run --live).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "io/loopback_server.hpp"
#include "session/interrupt.hpp"
#include "session/model.hpp"
#include "session/options.hpp"
#include "session/session.hpp"
#include "trace/run/trace.hpp"

namespace straytrace::session {

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
