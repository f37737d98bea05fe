// SPDX-License-Identifier: BSD-3-Clause
#include "session/interrupt.hpp"

namespace straytrace::session {
namespace {

std::atomic<bool> stop_requested{false}, signal_came{false};
std::atomic<bool> const* flag_in_use = &stop_requested;
int guards = 0;

}  // namespace

InterruptGuard::InterruptGuard(std::atomic<bool> const* flag) {
  if (guards++ > 0) return;
  if (flag) {
    flag_in_use = flag;
    return;
  }
  stop_requested = signal_came = false;
  struct sigaction action {};
  action.sa_handler = [](int) { stop_requested = signal_came = true; };
  for (std::size_t i = 0; i < signals.size(); ++i) {
    bool const from_batch_system = signals[i] == SIGUSR1 || signals[i] == SIGUSR2;  // may come several times
    // Restarted, a line that waits for a slow reader of stderr is not lost.
    action.sa_flags = static_cast<int>(SA_RESTART | (from_batch_system ? 0u : SA_RESETHAND));
    sigaction(signals[i], &action, &before_[i]);
  }
}

InterruptGuard::~InterruptGuard() {
  if (--guards > 0) return;
  if (flag_in_use != &stop_requested) {
    flag_in_use = &stop_requested;
    return;
  }
  for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &before_[i], nullptr);
}

std::atomic<bool> const& InterruptGuard::stop() const { return *flag_in_use; }

bool InterruptGuard::signalled() const { return signal_came; }

void InterruptGuard::request_stop() { stop_requested = true; }

void InterruptGuard::revoke_request() {
  stop_requested = false;
  if (signal_came) stop_requested = true;
}

}  // namespace straytrace::session
