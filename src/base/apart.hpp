// SPDX-License-Identifier: BSD-3-Clause
// Work by libraries that a hostile file may crash or make take all memory: done in a copy of the process.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace straytrace {

struct Apart {
  std::string bytes;
  std::string why;  // there are none: "it takes more than 1024 MB", "Segmentation fault"; empty: done
};

// What `work` returns, while it may take `memory` more bytes. Nothing else of what it does is seen here.
Apart done_apart(std::function<std::string()> const& work, std::size_t memory);

}  // namespace straytrace
