// SPDX-License-Identifier: BSD-3-Clause
// Sums of one block. Scores of one history are summed before they are squared, and histories are added in order, so the
// bits of a block depend on scene and seed only.
#pragma once

#include <array>
#include <unordered_map>
#include <vector>

#include "trace/tally/history_tally.hpp"

namespace straytrace::trace {

// Addresses kept for replay: as many as for one block up to 256 blocks, then in proportion to the blocks up to
// the limit (records_kept()). Part of the run-file schema.
constexpr std::size_t records_per_class = 512, most_records = 4096;

// Keeps the largest priorities not below the threshold, in any order, and raises the threshold to the largest dropped.
void drop_smallest(ClassSums&);
// The same, sorted.
void keep_largest(ClassSums&);

class BlockSink {
 public:
  BlockSink(WorldView const& world, std::size_t groups, int replica);

  void add(HistoryTally const&);  // in the order of histories
  BlockSums finish();             // closes the block

 private:
  ClassSums& sums_of(std::uint64_t route);
  void add_records(HistoryTally const&);
  void add_to_maps(HistoryCells const&);

  int replica_;
  std::vector<double> received_;  // by receiver, of one history
  std::unordered_map<std::uint64_t, ClassSums> classes_;
  struct Found {
    std::uint64_t route = 0;
    ClassSums* sums = nullptr;  // null: none yet
  };
  std::array<Found, 64> found_;  // the last class with these lowest bits
  BlockSums sums_;
};

}  // namespace straytrace::trace
