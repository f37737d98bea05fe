// SPDX-License-Identifier: BSD-3-Clause
// Sums of one block. Scores of one history are summed before they are squared, and histories are added in order, so the
// bits of a block depend on scene and seed only.
#pragma once

#include <unordered_map>
#include <vector>

#include "trace/tally/history_tally.hpp"

namespace straytrace::trace {

// Addresses kept for replay: as many as for one block up to 256 blocks, then in proportion to the blocks up to
// the limit (records_kept()). Part of the run-file schema.
constexpr std::size_t records_per_class = 512, most_records = 4096;

// Sorts by priority, keeps the largest above the threshold and raises the threshold to the largest priority dropped.
void keep_largest(ClassSums&, std::size_t most = records_per_class);

class BlockSink {
 public:
  BlockSink(WorldView const& world, std::size_t groups, int replica);

  void add(HistoryTally const&);  // in the order of histories
  BlockSums finish();             // closes the block

 private:
  void add_records(HistoryTally const&);
  void add_to_maps(HistoryCells const&);

  int replica_;
  std::vector<double> received_;  // by receiver, of one history
  std::unordered_map<std::uint64_t, ClassSums> classes_;
  BlockSums sums_;
};

}  // namespace straytrace::trace
