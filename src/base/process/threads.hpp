// SPDX-License-Identifier: BSD-3-Clause
// Work divided among threads.
#pragma once

#include <cstddef>
#include <functional>

#include "base/namespaces.hpp"

namespace straytrace {

unsigned thread_count(unsigned wanted);  // 0: one for each core that this process may use

// Calls work(0) to work(count - 1), each once, on `threads` threads (0: all cores) including the calling one, in no
// fixed order. Throws what `work` throws, one of several, once all threads have ended.
void in_parallel(std::size_t count, unsigned threads, std::function<void(std::size_t)> const& work);

}  // namespace straytrace
