// SPDX-License-Identifier: BSD-3-Clause
// Where the histories of one block add up. Scores of one history are summed before they are squared, histories are
// added in order, so a block's bits depend on scene and seed only.
#pragma once

#include <unordered_map>
#include <vector>

#include "trace/tally/history_tally.hpp"

namespace straytrace {

// Addresses kept for replay, of one block and of very many: what one block keeps does for 256, then their number grows
// with that of the blocks (records_kept()). Part of the run-file schema.
constexpr std::size_t records_per_class = 512, most_records = 4096;

// Sorts by priority, drops what lies below the threshold and all but the largest, remembers the threshold.
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

}  // namespace straytrace
