// SPDX-License-Identifier: BSD-3-Clause
#include "base/memory/storage.hpp"

#include <cstdlib>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace straytrace {

std::shared_ptr<void> large_block(std::size_t bytes) {
  constexpr std::size_t page = std::size_t{1} << 21;
  std::size_t const whole = (bytes + page - 1) / page * page;
  void* const block = std::aligned_alloc(page, whole > 0 ? whole : page);
  if (!block) throw std::bad_alloc();
#if defined(__linux__)
  madvise(block, whole, MADV_HUGEPAGE);  // optional: without it everything works, but slower
#endif
  return {block, std::free};
}

}  // namespace straytrace
