// SPDX-License-Identifier: BSD-3-Clause
// Where the histories of one block add up. Scores of one history are summed before they are squared, histories are
// added in order, so a block's bits depend on scene and seed only.
#pragma once

#include <unordered_map>
#include <vector>

#include "trace/tally/history_tally.hpp"

namespace straytrace {

constexpr std::size_t records_per_class = 512;  // addresses kept for replay; part of the run-file schema

void keep_largest(ClassSums&);  // sorts by priority, drops all but the largest, remembers the threshold

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
