// SPDX-License-Identifier: BSD-3-Clause
// Blocks still to be done, handed out in ascending order, those that came back first.
#pragma once

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "trace/result.hpp"

namespace straytrace {

// Used by several threads at once.
class BlockQueue {
 public:
  explicit BlockQueue(std::vector<BlockRange> missing) : missing_(std::move(missing)) {
    for (BlockRange const& range : missing_) left_ += range.size();
  }
  // The next blocks, at most so many; none when all have been taken.
  std::optional<BlockRange> take(std::uint64_t most) {
    std::scoped_lock const lock(mutex_);
    if (left_ == 0) return {};
    BlockRange& range = missing_[next_];
    BlockRange const taken{range.first, range.first + std::min(most, range.size())};
    left_ -= taken.size();
    range.first = taken.end;
    if (range.size() == 0) ++next_;
    return taken;
  }
  // Taken, but not done.
  void give_back(BlockRange range) {
    std::scoped_lock const lock(mutex_);
    missing_.insert(missing_.begin() + std::ptrdiff_t(next_), range);
    left_ += range.size();
  }
  std::uint64_t left() const {
    std::scoped_lock const lock(mutex_);
    return left_;
  }
  void end() {  // nothing more
    std::scoped_lock const lock(mutex_);
    next_ = missing_.size();
    left_ = 0;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<BlockRange> missing_;
  std::size_t next_ = 0;
  std::uint64_t left_ = 0;
};

}  // namespace straytrace
