// SPDX-License-Identifier: BSD-3-Clause
// The backend that tests trace with: the processor, or the engine of a device that is named by the environment variable
// STRAYTRACE_TEST_ENGINE (tests/device/run.sh).
#pragma once

#include <cstdlib>

#include "base/every_module.hpp"
#include "trace/backend/device/device_backend.hpp"

namespace straytrace::testing {

inline std::unique_ptr<Backend> test_backend() {
  char const* const library = std::getenv("STRAYTRACE_TEST_ENGINE");
  return library ? device_backend("device", load_engine(library)) : make_backend("cpu");
}

}  // namespace straytrace::testing
