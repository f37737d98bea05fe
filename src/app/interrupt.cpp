// SPDX-License-Identifier: BSD-3-Clause
#include "app/interrupt.hpp"

namespace straytrace {
namespace {

std::atomic<bool> stop_requested{false};
int guards = 0;

}  // namespace

InterruptGuard::InterruptGuard() {
  if (guards++ > 0) return;
  stop_requested = false;
  struct sigaction action {};
  action.sa_handler = [](int) { stop_requested = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, &before_int_);
  sigaction(SIGTERM, &action, &before_term_);
}

InterruptGuard::~InterruptGuard() {
  if (--guards > 0) return;
  sigaction(SIGINT, &before_int_, nullptr);
  sigaction(SIGTERM, &before_term_, nullptr);
}

std::atomic<bool> const& InterruptGuard::stop() const { return stop_requested; }

}  // namespace straytrace
