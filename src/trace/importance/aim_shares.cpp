// SPDX-License-Identifier: BSD-3-Clause
// How often sub-paths of a receiver start towards each mirror or glass that it sees (docs/theory/sampling.md, eq. 1.28
// and 1.29): a short separate run finds from where they bring light.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "trace/importance/importance.hpp"
#include "trace/step/step.hpp"

namespace straytrace::trace {
namespace {

// Numbers of histories that nothing else uses.
constexpr std::uint64_t first_of_shares = 9ull << 60, histories_of_shares = 2048, block_of_shares = 256;
// Squares of scores that count as if they were equal: with fewer, the run says nothing.
constexpr double enough_scores = 8;
// The weights of the power heuristic change with the shares, so the run is repeated until they hardly do.
constexpr int most_runs = 4;
constexpr double hardly = 0.05;
// Least shares, whatever the run has found, which may lack rare light: of starts by the cosine law, and of those
// towards all aims. Where an aim shows a surface that a beam lights, the spot may be small and bright, and the aim
// keeps its equal share.
constexpr double least_by_cosine = 1 - Receiver::most_aimed, least_aimed = 0.25;

// Whether the least shares leave anything to choose.
bool has_choice(Receiver const& r) {
  return r.sub_paths > 0 &&
         std::any_of(r.aim, r.aim + r.aims, [](Receiver::Aim const& aim) { return !aim.shows_beam; });
}

// Sums over one history what sub-paths score, by goal.
class SubPathScores : public NullSink {
 public:
  explicit SubPathScores(WorldView const& view) : sums(goal_count(view)) {}
  void score_through(PathState const&, Vertex const&, Vertex const&, Chain const&, std::uint32_t goal, Vertex const&,
                     double power) {
    sums[goal] += power;
  }
  void score_lit(PathState const&, std::uint32_t, Vertex const&, Chain const&, std::uint32_t goal, Vertex const&,
                 double power) {
    sums[goal] += power;
  }
  std::vector<double> sums;
};

// By the cosine law, then towards each aim.
using Ways = std::array<double, Receiver::most_aims + 1>;

// One sub-path with a score: its square, and the density of its start by each way over that by all with their shares.
struct Start {
  double square;
  Ways density;
};
Start start_of_sub_path(WorldView const& view, Receiver const& r, SubPath const& sub, double score) {
  Ray const out{sub.end.point, sub.end.frame.to_world(sub.end.wi)};
  Start start{score * score, {cosine_density(r)}};
  double all = r.cosine_share * start.density[0];
  for (std::uint32_t i = 0; i < r.aims; ++i) {
    start.density[i + 1] = aim_density(view, r.aim[i].surface, out, sub.end.cosine());
    all += r.aim[i].share * start.density[i + 1];
  }
  for (double& density : start.density) density /= all;
  return start;
}

// By receiver.
std::vector<std::vector<Start>> starts_tried(World const& world, int run) {
  WorldView view = world.view();
  view.halo = {};  // whose field may not be known yet
  view.block_size = block_of_shares;
  std::vector<std::vector<Start>> starts(view.receivers.size);
  SubPathScores sink(view);
  History history;
  for (std::uint64_t h = 0; h < histories_of_shares; ++h) {
    trace_history(view, 0, first_of_shares + std::uint64_t(run) * histories_of_shares + h, history, sink);
    for (std::uint32_t s = 0; s < history.sub_paths.count; ++s) {
      SubPath const& sub = history.sub_paths.sub[s];
      if (!is_receiver(view, sub.goal) || !(sink.sums[sub.goal] > 0)) continue;
      Receiver const& r = receiver_of(view, sub.goal);
      if (has_choice(r))
        starts[place_of(view, sub.goal)].push_back(start_of_sub_path(view, r, sub, sink.sums[sub.goal]));
    }
    std::ranges::fill(sink.sums, 0);
  }
  return starts;
}

// Squares in units of the largest; false: too few matter.
bool in_units_of_the_largest(std::vector<Start>& starts) {
  double largest = 0, sum = 0, sum2 = 0;
  for (Start const& s : starts) largest = std::fmax(largest, s.square);
  if (!(largest > 0 && largest < infinity)) return false;
  for (Start& s : starts) {
    s.square /= largest;
    sum += s.square;
    sum2 += s.square * s.square;
  }
  return sum * sum >= enough_scores * sum2;
}

// Least shares by way.
Ways least_shares(Receiver const& r) {
  Ways least{least_by_cosine};
  for (std::uint32_t i = 0; i < r.aims; ++i)
    least[i + 1] = (r.aim[i].shows_beam ? Receiver::most_aimed : least_aimed) / r.aims;
  return least;
}

// The shares with the least second moment (eq. 1.29) that are at least those given, by steps that never increase it:
// what a share has beyond its least is multiplied by the square root of the derivative with respect to it.
Ways best_shares(std::vector<Start> const& starts, Ways const& least, std::size_t ways) {
  constexpr int steps = 100;
  double const free = 1 - std::accumulate(least.begin(), least.end(), 0.0);
  Ways share = least;
  for (std::size_t k = 0; k < ways; ++k) share[k] += free / double(ways);
  for (int step = 0; step < steps; ++step) {
    Ways slope{};
    for (Start const& s : starts) {
      double density = 0;
      for (std::size_t k = 0; k < ways; ++k) density += share[k] * s.density[k];
      for (std::size_t k = 0; k < ways; ++k) slope[k] += s.square * s.density[k] / (density * density);
    }
    double sum = 0;
    for (std::size_t k = 0; k < ways; ++k) sum += slope[k] = (share[k] - least[k]) * std::sqrt(slope[k]);
    for (std::size_t k = 0; k < ways; ++k) share[k] = least[k] + free * slope[k] / sum;
  }
  return share;
}

// Sets the shares of all receivers; false: they have hardly changed.
bool improve_shares(World& world, int run) {
  std::vector<std::vector<Start>> starts = starts_tried(world, run);
  bool changed = false;
  for (std::uint32_t i = 0; i < starts.size(); ++i) {
    if (!in_units_of_the_largest(starts[i])) continue;
    Receiver const& r = world.receivers()[i];
    Ways const best = best_shares(starts[i], least_shares(r), r.aims + 1);
    for (std::uint32_t k = 0; k < r.aims; ++k) changed = changed || std::fabs(best[k + 1] - r.aim[k].share) > hardly;
    world.set_aim_shares(i, {best.data() + 1, r.aims});
  }
  return changed;
}

}  // namespace

void choose_aim_shares(World& world) {
  if (std::ranges::none_of(world.receivers(), has_choice)) return;
  for (int run = 0; run < most_runs && improve_shares(world, run); ++run) {
  }
}

}  // namespace straytrace::trace
