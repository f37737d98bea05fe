// SPDX-License-Identifier: BSD-3-Clause
// How many sub-paths each receiver has (docs/theory/sampling.md, eq. 1.20, 1.25 and 1.26): a short separate run with
// all of them predicts variance and cost with fewer.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "trace/importance/steering_tables.hpp"
#include "trace/step/step.hpp"

namespace straytrace::trace {
namespace {

// Numbers of histories that nothing else uses.
constexpr std::uint64_t first_of_choice = 5ull << 61;
// Blocks of the pilot are independent. More of them would be smaller and show less of what dealt numbers gain.
constexpr std::size_t blocks_tried = 32, block_tried = 256, histories_tried = blocks_tried * block_tried;
// Numbers of sub-paths over that with which the pilot runs. The last one is the least of receivers that see through
// glass or mirrors: light that a walk hardly finds may be missing from the pilot.
constexpr std::array<double, 4> sub_paths_tried{1, 0.25, 0, 0.05};
constexpr std::size_t no_sub_paths = 2, few_sub_paths = 3;

// Scores of one history on one goal, with the weights that they have with fewer sub-paths.
struct Scores {
  double walk = 0, sub_paths = 0;  // of sub-paths: in the histories that have them
};

// Sums of one goal over histories.
struct Scored {
  struct Found {
    double square = 0, neighbours = 0;  // of histories; products of each and the one before
    double moment = 0;                  // of single scores (eq. 1.20)
    double block_sum = 0, block_square = 0;
    void add(Found const& other, double sign) {
      square += sign * other.square;
      neighbours += sign * other.neighbours;
      moment += sign * other.moment;
      block_sum += sign * other.block_sum;
      block_square += sign * other.block_square;
    }
  };
  std::array<Found, sub_paths_tried.size()> found{};
  void add(Scored const& other, double sign) {
    for (std::size_t i = 0; i < found.size(); ++i) found[i].add(other.found[i], sign);
  }
  double sum() const { return found[0].block_sum; }
  // Relative variance of a history in n blocks (eq. 1.25).
  double variance(std::size_t sub_paths, double n) const {
    constexpr double least_variance = 1e-6;  // below it only the cost counts
    Found const& f = found[sub_paths];
    double const apart = f.square - f.neighbours;
    double const between = (f.block_square - f.block_sum * f.block_sum / n) * n / (n - 1);
    double const left = apart > 0 ? std::fmin(between / apart, 1) : 1;  // by the numbers dealt in a block
    double const largest = std::fmax(f.square, f.moment) - f.neighbours;
    return std::fmax(n * double(block_tried) * left * largest / (sum() * sum()), least_variance);
  }
};

class ChoiceSink : public NullSink {
 public:
  explicit ChoiceSink(WorldView const& view)
      : scores_(goal_count(view)), last_(goal_count(view)), scored_(goal_count(view)) {}

  void shares(Shares const& shares) { shares_ = shares; }
  void score(PathState const&, Vertex const&, std::uint32_t goal, std::uint32_t, Vertex const&, double power) {
    add(goal, power, false);
  }
  void score_through(PathState const&, Vertex const&, Vertex const&, Chain const&, std::uint32_t goal, Vertex const&,
                     double power) {
    add(goal, power, true);
  }
  void score_lit(PathState const&, std::uint32_t, Vertex const&, Chain const&, std::uint32_t goal, Vertex const&,
                 double power) {
    add(goal, power, true);
  }
  void end_history() {
    for (std::size_t g = 0; g < scored_.size(); ++g) {
      for (std::size_t i = 0; i < sub_paths_tried.size(); ++i) {
        double const times = sub_paths_tried[i], walk = scores_[g][i].walk, sub = scores_[g][i].sub_paths;
        double const mean = walk + times * sub;
        Scored::Found& found = scored_[g].found[i];
        found.square += walk * walk + 2 * times * walk * sub + times * sub * sub;
        found.neighbours += mean * last_[g][i];
        found.block_sum += mean;
        found.block_square += times * (1 - times) * sub * sub;  // of having a sub-path or not
        last_[g][i] = mean;
      }
      scores_[g] = {};
    }
  }
  // The sums of the block that has ended, by goal.
  std::vector<Scored> end_block() {
    for (Scored& of_goal : scored_)
      for (Scored::Found& found : of_goal.found) found.block_square += found.block_sum * found.block_sum;
    return std::exchange(scored_, std::vector<Scored>(scored_.size()));
  }

 private:
  void add(std::uint32_t goal, double power, bool sub_path) {
    for (std::size_t i = 0; i < sub_paths_tried.size(); ++i) {
      double const times = sub_paths_tried[i];
      scored_[goal].found[i].moment += power * power * shares_.moment(times);
      Scores& scores = scores_[goal][i];
      (sub_path ? scores.sub_paths : scores.walk) += power * shares_.change(sub_path, times);
    }
    shares_ = Shares();
  }
  std::vector<std::array<Scores, sub_paths_tried.size()>> scores_;  // by goal, of this history
  std::vector<std::array<double, sub_paths_tried.size()>> last_;    // mean over having sub-paths of the last history
  std::vector<Scored> scored_;                                      // of this block
  Shares shares_;
};

// Rays and connections: of a vertex of the walk, and of the sub-paths of each goal. A sub-path and a connection to it
// evaluate two BSDF models where others evaluate one.
struct PilotRun {
  double goals = 0, walk = 0;
  std::vector<double> sub_paths;                         // by goal
  std::array<std::vector<Scored>, blocks_tried> scored;  // by goal
};
void count_cost(History const& history, PilotRun& run) {
  double const vertices = double(history.events) + 1;
  run.walk += (1 + run.goals) * vertices;
  for (std::uint32_t s = 0; s < history.sub_paths.count; ++s) {
    SubPath const& sub = history.sub_paths.sub[s];
    run.sub_paths[sub.goal] += 2 * (double(sub.count) + 1 + vertices * double(sub.count));
  }
}
PilotRun run_all_techniques(WorldView const& view) {
  PilotRun run{double(goals_of(view).size()), 0, std::vector<double>(goal_count(view)), {}};
  ChoiceSink sink(view);
  History history;
  for (std::uint64_t h = 0; h < histories_tried; ++h) {
    trace_history(view, 0, first_of_choice + h, history, sink);
    count_cost(history, run);
    sink.end_history();
    if ((h + 1) % block_tried == 0) run.scored[h / block_tried] = sink.end_block();
  }
  return run;
}

// By goal, an index of sub_paths_tried.
using Choice = std::vector<std::size_t>;
double cost_of(PilotRun const& run, Choice const& choice) {
  double cost = run.walk;
  for (std::size_t g = 0; g < choice.size(); ++g) cost += sub_paths_tried[choice[g]] * run.sub_paths[g];
  return cost;
}
// Sum of the logarithms of the variances of all goals that the pilot has found, in all blocks but one.
double log_variances(PilotRun const& run, Choice const& choice, std::vector<Scored> const& all, std::size_t without) {
  double sum = 0;
  for (std::size_t g = 0; g < all.size(); ++g) {
    Scored rest = all[g];
    rest.add(run.scored[without][g], -1);
    if (rest.sum() > 0) sum += std::log(rest.variance(choice[g], blocks_tried - 1));
  }
  return sum;
}
// How much better `b` is than `a`: minus the change of eq. 1.26, less two standard errors (jackknife).
double gain(PilotRun const& run, Choice const& a, Choice const& b) {
  std::vector<Scored> all(a.size());
  for (auto const& block : run.scored)
    for (std::size_t g = 0; g < all.size(); ++g) all[g].add(block[g], 1);
  constexpr double n = blocks_tried;
  double sum = 0, sum2 = 0;
  for (std::size_t i = 0; i < blocks_tried; ++i) {
    double const change = log_variances(run, a, all, i) - log_variances(run, b, all, i);
    sum += change / n;
    sum2 += change * change / n;
  }
  double const error = std::sqrt(std::fmax(sum2 - sum * sum, 0) * (n - 1));
  return sum + run.goals * std::log(cost_of(run, a) / cost_of(run, b)) - 2 * error;
}

// The choices that differ from `now` for one receiver.
std::vector<Choice> neighbours(WorldView const& view, Choice const& now) {
  std::vector<Choice> all;
  for (std::uint32_t r = 0; r < view.receivers.size; ++r) {
    if (!(view.receivers[r].sub_paths > 0)) continue;
    for (std::size_t const number :
         {std::size_t(0), std::size_t(1), view.receivers[r].behind_glass ? few_sub_paths : no_sub_paths}) {
      all.push_back(now);
      all.back()[goal_of_receiver(view, r)] = number;
    }
  }
  return all;
}
// Takes the best of them; false: none is certainly better.
bool improve(WorldView const& view, PilotRun const& run, Choice& now) {
  Choice const before = now;
  double most = 0;
  for (Choice const& other : neighbours(view, before)) {
    double const found = gain(run, before, other);
    if (!(found > most)) continue;
    most = found;
    now = other;
  }
  return most > 0;
}

}  // namespace

void choose_sub_paths_of_receivers(World& world) {
  WorldView view = world.view();
  if (std::ranges::none_of(world.receivers(), [](Receiver const& r) { return r.sub_paths > 0; })) return;
  view.halo = {};  // whose field may not be known yet
  view.block_size = block_tried;
  PilotRun const run = run_all_techniques(view);
  Choice choice(goal_count(view));
  while (improve(view, run, choice)) {
  }
  for (std::uint32_t r = 0; r < view.receivers.size; ++r)
    world.set_sub_paths(r, sub_paths_tried[choice[goal_of_receiver(view, r)]] * view.receivers[r].sub_paths);
}

}  // namespace straytrace::trace
