// SPDX-License-Identifier: BSD-3-Clause
// How often sub-paths of a receiver start towards each mirror or glass that it sees (docs/theory/sampling.md, eq. 1.28
// and 1.29): a short separate run finds from where they bring light.
#include <algorithm>
#include <array>
#include <cmath>

#include "trace/importance/importance.hpp"
#include "trace/step/step.hpp"

namespace straytrace::trace {
namespace {

// Numbers of histories that nothing else uses.
constexpr std::uint64_t first_of_shares = 9ull << 60, histories_of_shares = 2048, block_of_shares = 256;
constexpr std::size_t enough_starts = 32;  // with a score
// The weights of the power heuristic change with the shares, so the run is repeated until they hardly do.
constexpr int most_runs = 4;
constexpr double hardly = 0.05;
// What a share is at least, whatever the run has found: it may lack rare light.
constexpr double least_of_aim = 0.02, least_by_cosine = 1 - Receiver::most_aimed;

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
    start.density[i + 1] = aim_density(view, r.aim[i], out, sub.end.cosine());
    all += r.aim_share[i] * start.density[i + 1];
  }
  for (double& density : start.density) density /= all;
  return start;
}

// By receiver.
std::vector<std::vector<Start>> starts_tried(World const& world) {
  WorldView view = world.view();
  view.halo = {};  // whose field may not be known yet
  view.block_size = block_of_shares;
  std::vector<std::vector<Start>> starts(view.receivers.size);
  SubPathScores sink(view);
  History history;
  for (std::uint64_t h = 0; h < histories_of_shares; ++h) {
    trace_history(view, 0, first_of_shares + h, history, sink);
    for (std::uint32_t s = 0; s < history.sub_paths.count; ++s) {
      SubPath const& sub = history.sub_paths.sub[s];
      if (!is_receiver(view, sub.goal) || !(sink.sums[sub.goal] > 0)) continue;
      Receiver const& r = receiver_of(view, sub.goal);
      if (r.aims > 0) starts[place_of(view, sub.goal)].push_back(start_of_sub_path(view, r, sub, sink.sums[sub.goal]));
    }
    std::ranges::fill(sink.sums, 0);
  }
  return starts;
}

// The shares with the least second moment (eq. 1.29), by steps that never increase it: each share is multiplied by the
// square root of the derivative with respect to it.
Ways best_shares(std::vector<Start> const& starts, std::size_t ways) {
  constexpr int steps = 100;
  Ways share{};
  std::fill_n(share.begin(), ways, 1 / double(ways));
  for (int step = 0; step < steps; ++step) {
    Ways slope{};
    for (Start const& s : starts) {
      double density = 0;
      for (std::size_t k = 0; k < ways; ++k) density += share[k] * s.density[k];
      for (std::size_t k = 0; k < ways; ++k) slope[k] += s.square * s.density[k] / (density * density);
    }
    double sum = 0;
    for (std::size_t k = 0; k < ways; ++k) sum += share[k] *= std::sqrt(slope[k]);
    for (double& s : share) s /= sum;
  }
  return share;
}

// Sets the shares of all receivers; false: they have hardly changed.
bool improve_shares(World& world) {
  std::vector<std::vector<Start>> const starts = starts_tried(world);
  bool changed = false;
  for (std::uint32_t i = 0; i < starts.size(); ++i) {
    if (starts[i].size() < enough_starts) continue;
    Receiver const& r = world.receivers()[i];
    Ways const best = best_shares(starts[i], r.aims + 1);
    double const free = 1 - least_by_cosine - r.aims * least_of_aim;
    std::array<double, Receiver::most_aims> shares{};
    for (std::uint32_t k = 0; k < r.aims; ++k) {
      shares[k] = least_of_aim + free * best[k + 1];
      changed = changed || std::fabs(shares[k] - r.aim_share[k]) > hardly;
    }
    world.set_aim_shares(i, shares);
  }
  return changed;
}

}  // namespace

void choose_aim_shares(World& world) {
  if (std::ranges::none_of(world.receivers(), [](Receiver const& r) { return r.aims > 0 && r.sub_paths > 0; })) return;
  for (int run = 0; run < most_runs && improve_shares(world); ++run) {
  }
}

}  // namespace straytrace::trace
