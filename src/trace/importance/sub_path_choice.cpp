// SPDX-License-Identifier: BSD-3-Clause
// Which receivers have sub-paths (docs/theory/sampling.md, eq. 1.20). Light that connections find well, such as that of
// a lit surface in front of a receiver, has a larger error with them.
#include <array>
#include <cmath>

#include "trace/importance/steering_tables.hpp"
#include "trace/step/step.hpp"

namespace straytrace::trace {
namespace {

// Numbers of histories that nothing else uses.
constexpr std::uint64_t first_of_choice = 5ull << 61;
constexpr int rounds = 16, histories_of_round = 256;
// Of receivers that see through glass or mirrors: light that a walk hardly finds may be missing from the pilot.
constexpr double least_behind_glass = 0.05;

// Of one receiver in one history.
struct Scores {
  double total = 0;
  double without = 0;  // squares of the scores over the share of the walk (eq. 1.20)
};

class ChoiceSink : public NullSink {
 public:
  explicit ChoiceSink(WorldView const& view) : view_(view), scores_(view.receivers.size) {}

  void share_of_walk(double share) { share_ = share; }
  void score(PathState const&, Vertex const&, std::uint32_t goal, std::uint32_t, Vertex const&, double power) {
    if (goal >= view_.lit.size) add(goal - std::uint32_t(view_.lit.size), power);
  }
  void score_through(PathState const&, Vertex const&, Vertex const&, Chain const&, std::uint32_t receiver,
                     Vertex const&, double power) {
    add(receiver, power);
  }
  void score_lit(PathState const&, std::uint32_t, Vertex const&, Chain const&, std::uint32_t receiver, Vertex const&,
                 double power) {
    add(receiver, power);
  }
  // Of the history that has ended.
  std::vector<Scores> taken() {
    std::vector<Scores> all(scores_.size());
    std::swap(all, scores_);
    return all;
  }

 private:
  void add(std::uint32_t receiver, double power) {
    Scores& s = scores_[receiver];
    s.total += power;
    s.without += power * power / std::fmax(share_, 1e-12);
  }
  WorldView const& view_;
  std::vector<Scores> scores_;
  double share_ = 1;
};

// Means over the histories of one round.
struct PilotRound {
  double mean = 0, second = 0, without = 0;
  double variance() const { return second - mean * mean; }
  double bound() const { return without - mean * mean; }
};
using PilotRounds = std::array<PilotRound, rounds>;

// Rays and connections of a history: without sub-paths, and those of the sub-paths of a receiver.
struct Cost {
  double walk = 0;
  std::vector<double> more;
};

void count_cost(WorldView const& view, History const& history, Cost& cost) {
  double const vertices = double(history.events) + 1;
  cost.walk += vertices * double(1 + view.lit.size + view.receivers.size);
  for (std::uint32_t s = 0; s < history.sub_paths.count; ++s) {
    SubPath const& sub = history.sub_paths.sub[s];
    cost.more[sub.receiver] += double(sub.count) + 1 + vertices * double(sub.count);
  }
}

// Rounds with all strategies (`cost`: the cost of the sub-paths of each receiver besides), or without sub-paths.
std::vector<PilotRounds> tried(WorldView const& view, Cost& cost) {
  ChoiceSink sink(view);
  History history;
  std::vector<PilotRounds> found(view.receivers.size);
  for (std::uint64_t h = 0; h < rounds * histories_of_round; ++h) {
    trace_history(view, 0, first_of_choice + h, history, sink);
    count_cost(view, history, cost);
    std::vector<Scores> const scores = sink.taken();
    for (std::size_t r = 0; r < found.size(); ++r) {
      PilotRound& round = found[r][h / histories_of_round];
      round.mean += scores[r].total / histories_of_round;
      round.second += scores[r].total * scores[r].total / histories_of_round;
      round.without += scores[r].without / histories_of_round;
    }
  }
  return found;
}

// Whether the variance times the cost is smaller without sub-paths, by more than two standard errors. A variance found
// without them may lack rare, large scores. It counts as not less than its part that the scores with all strategies
// show (eq. 1.20).
bool better_without(PilotRounds const& with, PilotRounds const& without, double cost, double more) {
  double found = 0, bound = 0;
  for (int i = 0; i < rounds; ++i) {
    found += without[i].variance();
    bound += with[i].bound();
  }
  double sum = 0, sum2 = 0;
  for (int i = 0; i < rounds; ++i) {
    double const other = found > bound ? without[i].variance() : with[i].bound();
    double const gain = with[i].variance() * (cost + more) - other * cost;
    sum += gain;
    sum2 += gain * gain;
  }
  double const gain = sum / rounds, error = std::sqrt((sum2 / rounds - gain * gain) / (rounds - 1));
  return gain > 2 * error;
}

}  // namespace

void choose_sub_paths(World& world) {
  WorldView view = world.view();
  if (!view.both_ends) return;
  view.halo = {};  // whose field may not be known yet
  std::vector<double> sub_paths;
  for (Receiver const& r : world.receivers()) sub_paths.push_back(r.sub_paths);
  Cost cost{0, std::vector<double>(sub_paths.size())}, unused = cost;
  std::vector<PilotRounds> const with = tried(view, cost);
  for (std::uint32_t r = 0; r < sub_paths.size(); ++r) world.set_sub_paths(r, 0);
  view = world.view();
  view.halo = {};
  std::vector<PilotRounds> const without = tried(view, unused);
  for (std::uint32_t r = 0; r < sub_paths.size(); ++r) {
    bool const drop = better_without(with[r], without[r], cost.walk, cost.more[r]);
    double const least = world.receivers()[r].behind_glass ? std::fmin(least_behind_glass, sub_paths[r]) : 0;
    world.set_sub_paths(r, drop ? least : sub_paths[r]);
  }
}

}  // namespace straytrace::trace
