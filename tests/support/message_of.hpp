// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "base/errors.hpp"

namespace straytrace::test {

// Message of the InputError that an action throws; "no error" without one.
inline std::string message_of(std::function<void()> const& action) {
  try {
    action();
  } catch (InputError const& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace straytrace::test
