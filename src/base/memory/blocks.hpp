// SPDX-License-Identifier: BSD-3-Clause
// Histories are dealt to sources and summed in blocks of consecutive numbers.
#pragma once

#include <cstdint>

namespace straytrace {

// Histories. Part of the run-file schema: the size of blocks decides on the result.
constexpr std::uint64_t largest_block = 4096, smallest_block = 8;
constexpr std::uint64_t enough_blocks = 32;  // for an error from their spread

// Of a run of so many histories: the largest of 4096, 512, 64 and 8 that makes `enough_blocks` of them, the last one
// filled up. Filled up, their number gives the same size.
constexpr std::uint64_t block_size_of(std::uint64_t histories) {
  std::uint64_t size = largest_block;
  while (size > smallest_block && histories <= (enough_blocks - 1) * size) size /= 8;
  return size;
}

// The blocks that so many histories fill, the last one filled up.
constexpr std::uint64_t blocks_of(std::uint64_t histories, std::uint64_t block_size) {
  return (histories + block_size - 1) / block_size;
}

}  // namespace straytrace
