// SPDX-License-Identifier: BSD-3-Clause
// Where the histories of one block add up. Scores of one history are summed before they are squared, histories are
// added in order, so a block's bits depend on scene and seed only.
#pragma once

#include <unordered_map>
#include <vector>

#include "trace/history/path.hpp"
#include "trace/result.hpp"
#include "trace/tally/route.hpp"

namespace straytrace {

constexpr std::size_t records_per_class = 512;  // addresses kept for replay; part of the run-file schema

void keep_largest(ClassSums&);  // sorts by priority, drops all but the largest, remembers the threshold

class BlockSink {
 public:
  BlockSink(WorldView const& world, std::uint64_t seed, std::size_t groups, int replica);

  void begin(std::uint64_t history);
  void end();          // adds the history's totals
  BlockSums finish();  // closes the block

  void emitted(PathState const& path, Vertex const&) { emitted_ = path.emitted; }
  // Every score: a mode (goal < world.lit.size) or a receiver.
  void visit(PathState const& path, Vertex const& vertex);
  void score(PathState const& path, Vertex const& vertex, std::uint32_t goal, std::uint32_t number, Vertex const& y,
             double coupling);
  void score_through(PathState const& path, Vertex const& vertex, Vertex const& z, Chain const& chain,
                     std::uint32_t receiver, Vertex const& end, double power);
  void score_lit(PathState const& path, std::uint32_t source, Vertex const& z, Chain const& chain,
                 std::uint32_t receiver, Vertex const& end, double power);
  void wagered(double variance) { sums_.window_variance += variance; }
  void absorbed(GroupId group, double power);  // after the visit to the group; no group: in a medium
  void book(Fate fate, double power) { ledger_[static_cast<int>(fate)] += power; }

 private:
  void add(PathState const& path, Route const& route, std::uint32_t number, double coupling);
  void add_to_maps(PathState const& path, std::uint32_t receiver, Vertex const& y, std::uint64_t route, bool by_itself,
                   double power);
  struct Total {
    std::uint64_t route;
    std::uint32_t port;
    double sum;
  };
  struct Arrival {
    std::uint32_t group;
    double power, absorbed;
  };

  WorldView const& world_;
  std::uint64_t seed_, history_ = 0;
  int replica_;
  double emitted_ = 0;
  double ledger_[fate_count] = {};
  double in_media_ = 0;  // absorbed there by this history
  std::vector<Total> totals_;
  std::vector<double> received_;  // by receiver, of this history
  std::vector<Arrival> arrivals_;
  std::unordered_map<std::uint64_t, ClassSums> classes_;
  BlockSums sums_;
};

}  // namespace straytrace
