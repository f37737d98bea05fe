// SPDX-License-Identifier: BSD-3-Clause
// Long work that Ctrl-C can stop, and its progress on stderr.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <iostream>
#include <limits>
#include <string>
#include <unistd.h>

#include "base/namespaces.hpp"

namespace straytrace::session {

// While the outermost object lives, Ctrl-C, SIGTERM and the warning signals of batch systems (SIGUSR1, SIGUSR2) request
// a stop; a second Ctrl-C or SIGTERM ends the program at once. One thread makes them.
class InterruptGuard {
 public:
  InterruptGuard() : InterruptGuard(nullptr) {}
  // As the outermost object, with a flag: only this flag requests a stop, and signals are left alone.
  explicit InterruptGuard(std::atomic<bool> const* flag);
  ~InterruptGuard();
  InterruptGuard(InterruptGuard const&) = delete;
  InterruptGuard& operator=(InterruptGuard const&) = delete;
  std::atomic<bool> const& stop() const;
  bool signalled() const;  // by one of these signals

  // The same stop without a signal, from any thread, and what revokes it; a signal is never revoked.
  static void request_stop();
  static void revoke_request();

 private:
  static constexpr std::array signals{SIGINT, SIGTERM, SIGUSR1, SIGUSR2};
  std::array<struct sigaction, signals.size()> before_{};
};

// Remaining time of work whose share `done` grows evenly from the first call on; earlier time is ignored.
class TimeLeft {
 public:
  // Seconds; NaN before any growth.
  double at(double seconds, double done) {
    if (std::isnan(first_done_)) first_seconds_ = seconds, first_done_ = done;
    double const grown = done - first_done_;
    return grown > 0 ? (seconds - first_seconds_) / grown * (1 - done) : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  double first_seconds_ = 0, first_done_ = std::numeric_limits<double>::quiet_NaN();
};

// A moving line on a terminal; elsewhere a line every ten seconds. Nothing in the first half second.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet) : quiet_(quiet) {}
  ~ProgressLine() {
    if (drawn_) std::cerr << '\n';
  }
  ProgressLine(ProgressLine const&) = delete;
  ProgressLine& operator=(ProgressLine const&) = delete;

  // `line()` returns the text, when due.
  template <class Line>
  void at(double seconds, Line const& line) {
    if (quiet_ || seconds < 0.5) return;
    if (terminal_) {
      std::cerr << "\r\x1b[K" << line() << std::flush;
      drawn_ = true;
    } else if (seconds >= next_) {
      std::cerr << line() << '\n';
      next_ = seconds + 10;
    }
  }

 private:
  bool const quiet_, terminal_ = isatty(STDERR_FILENO) != 0;
  double next_ = 0;
  bool drawn_ = false;
};

}  // namespace straytrace::session
