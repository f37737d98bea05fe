// SPDX-License-Identifier: BSD-3-Clause
// How many sub-paths each receiver has, and how often the walk aims after its first hop (docs/theory/sampling.md,
// eq. 1.20 to 1.23): a short separate run with all techniques predicts variance and cost with fewer of them.
#include <algorithm>
#include <array>
#include <cmath>

#include "trace/importance/steering_tables.hpp"
#include "trace/step/step.hpp"

namespace straytrace::trace {
namespace {

// Numbers of histories that nothing else uses.
constexpr std::uint64_t first_of_choice = 5ull << 61;
constexpr std::size_t rounds = 16, histories_tried = 1 << 13;
// Numbers of sub-paths over that with which the pilot runs. The last one is the least of receivers that see through
// glass or mirrors: light that a walk hardly finds may be missing from the pilot.
constexpr std::array<double, 4> sub_paths_tried{1, 0.25, 0, 0.05};
constexpr std::size_t no_sub_paths = 2, few_sub_paths = 3;
// Probabilities of aiming after the first hop over that of the tables. None is 0: light that the pilot misses could
// then have any weight.
constexpr std::array<double, 3> aims_tried{1, 0.5, 0.25};
using PerAim = std::array<double, aims_tried.size()>;
constexpr PerAim as_aimed{1, 1, 1};

// Scores of one history on one port or receiver, with the weights that they have with fewer sub-paths.
struct Scores {
  double walk = 0, sub_paths = 0;  // of sub-paths: in the histories that have them
};

// Sums of one port or receiver over histories.
struct Scored {
  double sum = 0;
  struct Found {
    double square = 0;      // of histories
    double neighbours = 0;  // products of each history and the one before
    double moment = 0;      // of single scores (eq. 1.20)
    PerAim aimed{};         // what `square` gains where the walk aims less often (eq. 1.21)
  };
  std::array<Found, sub_paths_tried.size()> found{};
  void add(Scored const& other, double sign) {
    sum += sign * other.sum;
    for (std::size_t i = 0; i < found.size(); ++i) {
      found[i].square += sign * other.found[i].square;
      found[i].neighbours += sign * other.found[i].neighbours;
      found[i].moment += sign * other.found[i].moment;
      for (std::size_t k = 0; k < aims_tried.size(); ++k) found[i].aimed[k] += sign * other.found[i].aimed[k];
    }
  }
  // Relative variance of one of n histories (eq. 1.22).
  double variance(std::size_t sub_paths, std::size_t aims, double n) const {
    constexpr double least_variance = 1e-6;  // below it only the cost counts
    Found const& f = found[sub_paths];
    double const square = std::fmax(f.square, f.moment) + f.aimed[aims] - f.neighbours;
    return std::fmax(n * square / (sum * sum), least_variance);
  }
};

// Sides of surfaces where beams start: the first hop of a walk leaves them.
std::vector<bool> emitting_sides(WorldView const& view) {
  std::vector<bool> emits(view.steering.sides.size);
  for (std::size_t e = 0; e < view.emitters.size && view.steering.on(); ++e) {
    Footprint const& lit = view.lit[view.emitters[e]];
    if (lit.free) continue;
    for (std::size_t i = view.steering.first_of_surface[lit.surface.value];
         i < view.steering.first_of_surface[lit.surface.value + 1]; ++i)
      emits[2 * view.steering.strips[i].patch] = emits[2 * view.steering.strips[i].patch + 1] = true;
  }
  return emits;
}

// Siblings are followed depth first, so the vertices before the present one always belong to the same path.
class ChoiceSink : public NullSink {
 public:
  explicit ChoiceSink(WorldView const& view)
      : view_(view),
        emits_(emitting_sides(view)),
        scores_(goal_count(view)),
        before_(goal_count(view)),
        scored_(goal_count(view)) {}

  void visit(PathState const& path, Vertex const&) {
    close_from(path.order);
    PerAim here = passed_.empty() ? as_aimed : passed_.back();
    for (std::size_t k = 0; k < aims_tried.size(); ++k) {
      here[k] *= density_over(path.hop, aims_tried[k]);
      visits[k] += 1 / here[k];
    }
    passed_.push_back(here);
    behind_.resize(passed_.size() * goals());
  }
  void shares(Shares const& shares) { shares_ = shares; }
  void score(PathState const& path, Vertex const&, std::uint32_t goal, std::uint32_t, Vertex const&, double power) {
    add(goal, power, path.order, false);
  }
  void score_through(PathState const& path, Vertex const&, Vertex const&, Chain const&, std::uint32_t goal,
                     Vertex const&, double power) {
    add(goal, power, path.order, true);
  }
  void score_lit(PathState const&, std::uint32_t, Vertex const&, Chain const&, std::uint32_t goal, Vertex const&,
                 double power) {
    add(goal, power, 0, true);
  }
  // Adds the history that has ended to sums by goal.
  void end_history(std::vector<Scored>& sums) {
    close_from(1);
    for (std::size_t g = 0; g < sums.size(); ++g) {
      for (std::size_t i = 0; i < sub_paths_tried.size(); ++i) {
        double const times = sub_paths_tried[i], walk = scores_[g][i].walk, sub = scores_[g][i].sub_paths;
        double const mean = walk + times * sub;
        scored_[g].found[i].square = walk * walk + 2 * times * walk * sub + times * sub * sub;
        scored_[g].found[i].neighbours = mean * before_[g][i];
        before_[g][i] = mean;
      }
      scored_[g].sum = before_[g][0];
      sums[g].add(scored_[g], 1);
      scored_[g] = {};
      scores_[g] = {};
    }
  }
  PerAim visits{};  // expected number of vertices

 private:
  std::size_t goals() const { return goal_count(view_); }
  // Density of the hop over the one that it would have with `aims` times the probability of aiming.
  double density_over(Hop const& hop, double aims) const {
    if (!(hop.pdf > 0) || hop.side == WorldView::none || emits_[hop.side]) return 1;
    double const now = hop.pdf / hop.lobe;
    return now / (hop.law_pdf + aims * (now - hop.law_pdf));
  }
  // The vertices of this order and above have no more scores behind them.
  void close_from(std::uint32_t order) {
    while (passed_.size() >= order && !passed_.empty()) {
      std::size_t const last = passed_.size() - 1;
      PerAim const here = passed_[last], before = last > 0 ? passed_[last - 1] : as_aimed;
      for (std::size_t g = 0; g < goals(); ++g)
        for (std::size_t i = 0; i < sub_paths_tried.size(); ++i) {
          double const sum = behind_[last * goals() + g][i];
          if (last > 0) behind_[(last - 1) * goals() + g][i] += sum;
          for (std::size_t k = 0; k < aims_tried.size(); ++k)
            scored_[g].found[i].aimed[k] += (here[k] - before[k]) * sum * sum;
        }
      passed_.pop_back();
      behind_.resize(passed_.size() * goals());
    }
  }
  void add(std::uint32_t goal, double power, std::uint32_t order, bool sub_path) {
    for (std::size_t i = 0; i < sub_paths_tried.size(); ++i) {
      double const times = sub_paths_tried[i], changed = power * shares_.change(sub_path, times);
      scored_[goal].found[i].moment += power * power * shares_.moment(times);
      Scores& scores = scores_[goal][i];
      (sub_path ? scores.sub_paths : scores.walk) += changed;
      if (order > 0) behind_[(order - 1) * goals() + goal][i] += sub_path ? times * changed : changed;
    }
    shares_ = Shares();
  }
  WorldView const& view_;
  std::vector<bool> const emits_;
  std::vector<PerAim> passed_;  // products of those of all hops up to each vertex of the path
  std::vector<std::array<double, sub_paths_tried.size()>> behind_;  // scores there and later, by vertex and goal
  // By goal, of this history and the last one.
  std::vector<std::array<Scores, sub_paths_tried.size()>> scores_;
  std::vector<std::array<double, sub_paths_tried.size()>> before_;  // means over its having sub-paths
  std::vector<Scored> scored_;
  Shares shares_;
};

// Rays and connections: of a vertex of the walk, and of the sub-paths of each goal. A sub-path and a connection to it
// evaluate two BSDF models where others evaluate one.
struct PilotRun {
  double goals = 0;
  PerAim walk{};
  std::vector<double> sub_paths;                   // by goal
  std::array<std::vector<Scored>, rounds> scored;  // by goal: footprints, then receivers; histories take turns
};
void count_sub_paths(History const& history, std::vector<double>& cost) {
  double const vertices = double(history.events) + 1;
  for (std::uint32_t s = 0; s < history.sub_paths.count; ++s) {
    SubPath const& sub = history.sub_paths.sub[s];
    cost[sub.goal] += 2 * (double(sub.count) + 1 + vertices * double(sub.count));
  }
}
PilotRun run_all_techniques(WorldView const& view) {
  PilotRun run{double(goals_of(view).size()), {}, std::vector<double>(goal_count(view)), {}};
  ChoiceSink sink(view);
  History history;
  run.scored.fill(std::vector<Scored>(goal_count(view)));
  for (std::uint64_t h = 0; h < histories_tried; ++h) {
    trace_history(view, 0, first_of_choice + h, history, sink);
    count_sub_paths(history, run.sub_paths);
    sink.end_history(run.scored[h % rounds]);
  }
  for (std::size_t k = 0; k < aims_tried.size(); ++k)
    run.walk[k] = (1 + run.goals) * (double(histories_tried) + sink.visits[k]);
  return run;
}

// What is used: of each goal the number of sub-paths, and of the walk how often it aims.
struct Choice {
  std::vector<std::size_t> sub_paths;
  std::size_t aims = 0;
};
double cost_of(PilotRun const& run, Choice const& choice) {
  double cost = run.walk[choice.aims];
  for (std::size_t g = 0; g < run.sub_paths.size(); ++g)
    cost += sub_paths_tried[choice.sub_paths[g]] * run.sub_paths[g];
  return cost;
}
// Sum of the logarithms of the variances of all goals that the pilot has found, in all rounds but one.
double log_variances(PilotRun const& run, Choice const& choice, std::vector<Scored> const& all, std::size_t without) {
  double sum = 0;
  for (std::size_t g = 0; g < all.size(); ++g) {
    Scored rest = all[g];
    rest.add(run.scored[without][g], -1);
    if (rest.sum > 0)
      sum += std::log(rest.variance(choice.sub_paths[g], choice.aims, double(histories_tried) * (rounds - 1) / rounds));
  }
  return sum;
}
// How much better `b` is than `a`: minus the change of eq. 1.23, less two standard errors (jackknife).
double gain(PilotRun const& run, Choice const& a, Choice const& b) {
  std::vector<Scored> all(a.sub_paths.size());
  for (auto const& round : run.scored)
    for (std::size_t g = 0; g < all.size(); ++g) all[g].add(round[g], 1);
  constexpr double n = rounds;
  double sum = 0, sum2 = 0;
  for (std::size_t i = 0; i < rounds; ++i) {
    double const change = log_variances(run, a, all, i) - log_variances(run, b, all, i);
    sum += change / n;
    sum2 += change * change / n;
  }
  double const error = std::sqrt(std::fmax(sum2 - sum * sum, 0) * (n - 1));
  return sum + run.goals * std::log(cost_of(run, a) / cost_of(run, b)) - 2 * error;
}

// The choices that differ from `now` for one receiver or in how often the walk aims.
std::vector<Choice> neighbours(WorldView const& view, Choice const& now) {
  std::vector<Choice> all;
  for (std::uint32_t r = 0; r < view.receivers.size; ++r) {
    if (!(view.receivers[r].sub_paths > 0)) continue;
    for (std::size_t const number :
         {std::size_t(0), std::size_t(1), view.receivers[r].behind_glass ? few_sub_paths : no_sub_paths}) {
      all.push_back(now);
      all.back().sub_paths[goal_of_receiver(view, r)] = number;
    }
  }
  for (std::size_t k = 0; k < aims_tried.size(); ++k) all.push_back({now.sub_paths, k});
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

void aim_less(World& world, double aims) {
  std::vector<bool> const emits = emitting_sides(world.view());
  SteeringTables tables = world.steering();
  for (std::size_t i = 0; i < tables.sides.size(); ++i)
    if (!emits[i]) tables.sides[i].alpha = 1 - aims * (1 - tables.sides[i].alpha);
  world.steer(std::move(tables));
}

}  // namespace

void choose_techniques(World& world) {
  WorldView view = world.view();
  if (view.receivers.size == 0) return;
  view.halo = {};  // whose field may not be known yet
  view.block_size = histories_tried;
  PilotRun const run = run_all_techniques(view);
  Choice choice{std::vector<std::size_t>(goal_count(view)), 0};
  while (improve(view, run, choice)) {
  }
  for (std::uint32_t r = 0; r < view.receivers.size; ++r)
    world.set_sub_paths(r, sub_paths_tried[choice.sub_paths[goal_of_receiver(view, r)]] * view.receivers[r].sub_paths);
  if (choice.aims > 0) aim_less(world, aims_tried[choice.aims]);
}

}  // namespace straytrace::trace
