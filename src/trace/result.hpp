// SPDX-License-Identifier: BSD-3-Clause
// The result of a trace: sums over histories that merge exactly, and the energy balance.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/memory/host_device.hpp"
#include "trace/coupling.hpp"

namespace straytrace::trace {

class SteeredWorld;
struct BlockSums;

// Second moments of the phase sensitivities of a route, as sums over histories: they need no kept paths, so their error
// falls with the number of histories without limit (docs/theory/errors.md, Second moments of the phase sensitivities).
// Of a sample of paths with unbiased weights: the expectation of the sums over many blocks is that of all paths.
struct PhaseSensitivitySums {
  // More pairs of bodies than that in one replica are too many to be summed; part of the run-file schema.
  static constexpr std::size_t most_pairs = 32;

  std::uint64_t paths = 0;                        // drawn
  std::array<double, replica_count> weight = {};  // sum of their weights, by replica
  std::vector<PhaseSensitivityProduct> products;  // ascending by replica, first and second body
  bool given_up = false;                          // too many pairs, or blocks that did not sum them: all else is empty

  void add(std::size_t replica, double weight,
           std::vector<PhaseSensitivity> const& phase_sensitivities);  // a path, phase sensitivities ascending by body
  void add(PhaseSensitivitySums const& other, double factor = 1);
  void give_up();
};

constexpr std::size_t tail_size = 200;  // largest totals kept per bin; part of the run-file schema

template <class Sums>
STRAY_HD void add_total(Sums& m, double total, std::uint64_t history) {
  if (total == 0) return;
  double const square = total * total;
  m.sum += total;
  m.sum2 += square;
  m.sum3 += square * total;
  m.sum4 += square * square;
  ++m.scored;
  if (std::fabs(total) > m.largest) {
    m.largest = std::fabs(total);
    m.largest_history = history;
  }
}

// Power sums of a history's TOTAL in a bin: scores of one history are added before they are squared.
struct Moments {
  double sum = 0, sum2 = 0, sum3 = 0, sum4 = 0;
  double block_sum2 = 0;  // over blocks, of the block's sum
  double largest = 0;     // largest history total
  std::uint64_t largest_history = 0, scored = 0;
  double first_sum = 0;      // of the first blocks, as many as first_part() says; NaN: not known
  std::vector<double> tail;  // the largest totals, descending, independent of order
  void add(double total, std::uint64_t history);
  void add_score(double total, std::uint64_t history);  // with its place in the tail
  void close_block();                                   // the sums are those of one whole block
};
Moments merged(Moments const& left, Moments const& right);
// Number of the first blocks that are compared with the rest (docs/theory/errors.md, halves). The tree of sums has the
// sums of its nodes only, so the border lies between two nodes, the nearest to the middle: 1/3 to 2/3 of the blocks,
// half of them at powers of two. A function of the number of blocks: threads and resuming do not matter.
std::uint64_t first_part(std::uint64_t blocks);
// Blocks are the independent units from 32 blocks on (docs/theory/errors.md); below, the spread of the histories.
Estimate estimate(Moments const&, std::uint64_t histories, std::uint64_t blocks);
// That of a route or of a receiver, whose error is at least the score of one history: where strata deal the same scores
// to every block, the blocks say nothing about a rare history that was not drawn (docs/theory/errors.md).
Estimate estimate_of_light(Moments const&, std::uint64_t histories, std::uint64_t blocks);
// Why an estimate with enough scores is still unreliable: more scores, or more routes summed with it, do not soon
// repair its error bar. Empty: no reason, or too few scores to decide.
std::string tail_objection(Estimate const&);

// Light that ends on a receiver is summed like light that rejoins a port; this distinguishes the two in
// ClassSums::port.
constexpr std::uint32_t first_receiver_end = 0x80000000u;

// Sums over blocks of each cell's block total, and of its square: the error of a cell comes from the blocks.
struct MapSums {
  std::vector<double> sum, sum2;
};
// Coherent light of one route on a receiver: per pixel the power, and the power times cos and sin of its phase
// (R4.02).
struct FieldSums {
  std::vector<double> power, real, imaginary;
};
struct ReceiverSums {
  Moments power;                              // of all light received, by any route
  MapSums image, angles, quadrants;           // W per W of the main mode and history; rows from the lower left
  std::map<std::uint64_t, FieldSums> fields;  // by route
};

struct ScoreAddress {
  std::uint64_t history = 0;
  std::uint32_t event = 0, connection = 0;
  double coupling = 0, priority = 0;  // priority = coupling / uniform(record stream)
};

// Keeps the k largest priorities (priority sampling, docs/theory/errors.md): independent of order, so merging is exact.
struct ClassSums {
  std::uint32_t port = 0;
  Moments moments;
  std::array<double, replica_count> replica_sum = {};
  std::vector<ScoreAddress> kept;  // descending priority, ties by address
  double off_list = 0;             // part of the sum whose last hop of the walk met no listed target
  double threshold = 0;            // largest priority not kept; a kept score counts as max(coupling, threshold)
  PhaseSensitivitySums phase_sensitivities;  // of paths drawn block by block
};

// Columns of the energy balance: absorbed + escaped + truncated + roulette + sampling = emitted for every history, to
// rounding. `roulette` (weight window) and `sampling` are zero on average.
enum class BalanceTerm : std::uint8_t { absorbed, escaped, truncated, roulette, sampling };
constexpr int balance_term_count = 5;
char const* name_of(BalanceTerm);

// Numbers of blocks, from the first to before the end.
struct BlockRange {
  std::uint64_t first = 0, end = 0;
  std::uint64_t size() const { return end - first; }
  bool operator==(BlockRange const& o) const { return first == o.first && end == o.end; }
};

// One of several parts of a run that are traced separately: 7/200. All of them hold each block once.
struct Slice {
  std::uint64_t number = 1, of = 1;
  bool whole() const { return of == 1; }
  BlockRange blocks(std::uint64_t all) const;  // may be empty, where there are more slices than blocks
};

struct BlockSums {
  std::uint64_t histories = 0, blocks = 0;
  std::array<std::uint64_t, replica_count> replica_blocks = {};  // of SumTree::total(): how its blocks share replicas
  std::uint64_t bounces = 0, rays = 0;                           // surface events; closest-hit queries
  std::uint64_t lost = 0;                      // geometry errors (NaN, no surface where one must be), never silent
  std::map<std::uint64_t, ClassSums> classes;  // by route hash
  Moments emitted;
  std::array<Moments, balance_term_count> energy_balance = {};
  double window_variance = 0;  // of the sum of `window`, from the odds of each roulette
  std::vector<ReceiverSums> receivers;
  std::vector<Moments> arrived;   // power arriving on each group, per emitted history
  std::vector<Moments> absorbed;  // by each group, then in all media: they sum to the column `absorbed`
};
BlockSums merged(BlockSums left, BlockSums const& right);
// Sums of the parent of node `index` of a level of the tree below, from those of that node and of its sibling.
BlockSums merged_siblings(std::uint64_t index, BlockSums sums, BlockSums sibling);

// Sums live on the nodes of the binary tree over block numbers. A node is its left child plus its right child, so its
// bits do not depend on the order or source of additions (docs/develop/architecture.md).
class SumTree {
 public:
  void add(unsigned level, std::uint64_t index, BlockSums sums);  // covers blocks [index << level, (index+1) << level)
  // The sums of the other child of the node's parent, which leave the tree; none if it does not have them.
  std::optional<BlockSums> take_sibling(unsigned level, std::uint64_t index);
  BlockSums total() const;                            // left to right, in block order
  std::vector<BlockRange> done() const;               // ascending, neighbours joined
  std::vector<BlockRange> missing(BlockRange) const;  // its missing part
  std::map<std::pair<std::uint64_t, unsigned>, BlockSums> const& nodes() const {
    return nodes_;
  }  // {first block, level}

 private:
  std::map<std::pair<std::uint64_t, unsigned>, BlockSums> nodes_;
};

// by_checkpoint: not stopped, an intermediate result; by_gaps: parts were missing at the merge.
enum class Stopped : std::uint8_t { by_histories, by_error, by_signal, by_time, by_checkpoint, by_gaps };

struct TraceResult {
  SumTree tree;  // for merging and resuming
  BlockSums total;
  CouplingTable coupling;  // with replayed records
  Slice slice;
  std::uint64_t all_blocks = 0;  // of the requested run, with all its slices
  Stopped stopped = Stopped::by_histories;
  std::string stop_rule;          // as the user wrote it
  std::uint32_t good_checks = 0;  // looks in a row at which the rule held
  double seconds = 0;             // wall clock; goes to /timing only
  std::vector<std::string> warnings;
  bool checkpointed() const { return stopped >= Stopped::by_signal; }
};

// Draws paths of a traced block, at most 128 on all routes to ports together (part of the run-file schema), and
// adds their phase sensitivities to the sums. A route is drawn in proportion to the root of its light, and within it a
// path in proportion to its coupling: priority sampling (docs/theory/errors.md) of coupling over the root of that of
// the route in the block. `replica`: of the block. The draws are a function of the scores of the block.
void sum_phase_sensitivities(SteeredWorld const&, std::uint64_t seed, std::size_t replica, BlockSums& block);

// The moments of a row of the coupling table, from `drawn` and stored paths, weighted by their numbers. Where all
// scores are stored, only from these. T_r: contribution of replica r to the mean; with A_r and B_r its sums of weights
// and products, its contribution is T_r B/A + T (B_r - A_r B/A)/A: the ratio to first order.
std::vector<PhaseSensitivityProduct> phase_sensitivity_moments(CouplingClass const&, PhaseSensitivitySums const& drawn,
                                                               bool all_kept, std::uint64_t histories,
                                                               std::uint64_t block_size);

// Adds rows as lever_moments() makes them; false when the pairs of bodies are too many, and `into` is then empty.
bool add_moments(std::vector<PhaseSensitivityProduct>& into, std::vector<PhaseSensitivityProduct> const& from);

}  // namespace straytrace::trace
