// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <string>

namespace straytrace {

// A variable of the environment; empty: not set.
inline std::string environment_variable(char const* name) {
  char const* const value = std::getenv(name);
  return value ? value : "";
}

}  // namespace straytrace
