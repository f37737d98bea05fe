// SPDX-License-Identifier: BSD-3-Clause
// Which modes have sub-paths (docs/theory/sampling.md, eq. 1.20 and 1.21): those to which mirrors or glass lead light
// that the walk hardly finds. Targets and connections aim at all others well enough.
#include <array>
#include <cmath>

#include "trace/importance/steering_tables.hpp"
#include "trace/step/step.hpp"

namespace straytrace::trace {
namespace {

// Numbers of histories that nothing else uses.
constexpr std::uint64_t first_of_mode_trial = 7ull << 61;
constexpr int mode_rounds = 16, histories_of_round = 256;

// What is compared: all light in a mode, and the light of each beam that joins it, since faint beams have ports of
// their own.
class Columns {
 public:
  explicit Columns(WorldView const& view) : modes_(view.lit.size) {}
  std::size_t size() const { return modes_ * (modes_ + 1); }
  std::size_t of(std::uint32_t mode) const { return mode; }
  std::size_t of(std::uint32_t mode, std::uint32_t source) const { return modes_ * (mode + 1) + source; }

 private:
  std::size_t modes_;
};

// Means over the histories of one round.
struct PilotRound {
  double mean = 0, second = 0;
  double without = 0;  // of single scores, without sub-paths (eq. 1.20)
  double variance() const { return second - mean * mean; }
  double bound() const { return without - mean * mean; }
};
using PilotRounds = std::array<PilotRound, mode_rounds>;

class ModeSink : public NullSink {
 public:
  explicit ModeSink(WorldView const& view)
      : columns_(view), found(columns_.size()), modes_(view.lit.size), total_(columns_.size()) {}

  void shares(Shares const& shares) { shares_ = shares; }
  void score(PathState const& path, Vertex const&, std::uint32_t goal, std::uint32_t, Vertex const&, double power) {
    add(goal, path.source, power);
  }
  void score_through(PathState const& path, Vertex const&, Vertex const&, Chain const&, std::uint32_t goal,
                     Vertex const&, double power) {
    add(goal, path.source, power);
  }
  void score_lit(PathState const&, std::uint32_t source, Vertex const&, Chain const&, std::uint32_t goal, Vertex const&,
                 double power) {
    add(goal, source, power);
  }
  void end_history(std::size_t round) {
    for (auto const& [column, square] : scores_) {
      PilotRound& r = found[column][round];
      r.without += square / histories_of_round;
      r.mean += total_[column] / histories_of_round;
      r.second += total_[column] * total_[column] / histories_of_round;
      total_[column] = 0;
    }
    scores_.clear();
  }

 private:
  Columns columns_;

 public:
  std::vector<PilotRounds> found;  // by column

 private:
  void add(std::uint32_t goal, std::uint32_t source, double power) {
    if (goal < modes_) {
      add_to(columns_.of(goal), power);
      add_to(columns_.of(goal, source), power);
    }
    shares_ = Shares();
  }
  void add_to(std::size_t column, double power) {
    scores_.push_back({column, power * power * shares_.moment(0)});
    total_[column] += power;
  }
  std::size_t modes_;
  std::vector<double> total_;                           // of this history, by column
  std::vector<std::pair<std::size_t, double>> scores_;  // of this history
  Shares shares_;
};

// Rays and connections of a history: without sub-paths, and those of the sub-paths of a goal.
struct Cost {
  double walk = 0;
  std::vector<double> more;
};

void count_cost(WorldView const& view, History const& history, Cost& cost) {
  double const vertices = double(history.events) + 1;
  cost.walk += vertices * double(1 + view.lit.size + view.receivers.size);
  for (std::uint32_t s = 0; s < history.sub_paths.count; ++s) {
    SubPath const& sub = history.sub_paths.sub[s];
    cost.more[sub.goal] += double(sub.count) + 1 + vertices * double(sub.count);
  }
}

// Rounds with all strategies, and their cost.
std::vector<PilotRounds> tried(WorldView const& view, Cost& cost) {
  ModeSink sink(view);
  History history;
  for (std::uint64_t h = 0; h < mode_rounds * histories_of_round; ++h) {
    trace_history(view, 0, first_of_mode_trial + h, history, sink);
    count_cost(view, history, cost);
    sink.end_history(h / histories_of_round);
  }
  return std::move(sink.found);
}

// By how many standard errors the variance times the cost is smaller with sub-paths by the factor `least_gain`: they
// take time from all other goals. The variance without them is the part of it that scores with all strategies show
// (eq. 1.20); products of scores only add to it.
constexpr double least_gain = 4;
double sure_gain(PilotRounds const& found, double cost, double more) {
  double sum = 0, sum2 = 0;
  for (PilotRound const& round : found) {
    double const gain = round.bound() * cost - least_gain * round.variance() * (cost + more);
    sum += gain;
    sum2 += gain * gain;
  }
  double const gain = sum / mode_rounds, error = std::sqrt((sum2 / mode_rounds - gain * gain) / (mode_rounds - 1));
  return error > 0 ? gain / error : 0;
}
constexpr double sure = 3;                      // standard errors: a scene asks this of every beam and mode
constexpr double sub_paths_for_one_beam = 0.1;  // per history, of a mode that has them for the light of some beam alone

// Modes and their mean numbers of sub-paths per history. Those of a profile `point` have no density.
std::vector<std::pair<std::uint32_t, double>> modes_to_try(WorldView const& view) {
  std::vector<std::pair<std::uint32_t, double>> modes;
  for (std::uint32_t i = 0; i < view.lit.size && !view.polarised; ++i) {
    Footprint const& lit = view.lit[i];
    bool const starts = lit.receives && !lit.free && lit.profile != Profile::point;
    if (starts && !view.surfaces[lit.surface.value].clear) modes.push_back({i, 1});
  }
  return modes;
}
// Of all modes together at most one per history.
void share_among(World& world, std::vector<std::pair<std::uint32_t, double>> const& modes) {
  double sum = 0;
  for (auto const& [mode, mean] : modes) sum += mean;
  for (auto const& [mode, mean] : modes) world.set_sub_paths_of_mode(mode, sum > 1 ? 0.999 * mean / sum : mean);
}

}  // namespace

void choose_sub_paths_of_modes(World& world) {
  std::vector<std::pair<std::uint32_t, double>> modes = modes_to_try(world.view());
  if (modes.empty()) return;
  share_among(world, modes);
  WorldView view = world.view();
  view.halo = {};                                      // whose field may not be known yet
  view.block_size = mode_rounds * histories_of_round;  // not that of the run, which changes as it grows
  Cost cost{0, std::vector<double>(goal_count(view))};
  std::vector<PilotRounds> const found = tried(view, cost);
  Columns const columns(view);
  for (auto& [mode, mean] : modes) {
    auto const pays = [&, mode = mode](std::size_t column) {
      return sure_gain(found[column], cost.walk, cost.more[mode]) > sure;
    };
    mean = 0;
    for (std::uint32_t source = 0; source < view.lit.size; ++source)
      if (pays(columns.of(mode, source))) mean = sub_paths_for_one_beam;
    if (pays(columns.of(mode))) mean = 1;
  }
  share_among(world, modes);
}

}  // namespace straytrace::trace
