// SPDX-License-Identifier: BSD-3-Clause
// Work by libraries that a hostile file may crash or make take all memory: done in a copy of the process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace straytrace {

struct SandboxResult {
  std::string bytes;
  std::string why;  // there are none: "it takes more than 1024 MB", "Segmentation fault"; empty: done
};

struct Bounds {
  std::size_t memory;     // bytes more than this process has
  std::uint64_t seconds;  // of processor time
};

// What `work` returns. Nothing else of what it does is seen here. Throws NumericalError where no copy can be made.
SandboxResult run_sandboxed(std::function<std::string()> const& work, Bounds);

}  // namespace straytrace
