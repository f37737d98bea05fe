// SPDX-License-Identifier: BSD-3-Clause
#include "trace/importance/importance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/process/threads.hpp"
#include "trace/importance/steering_tables.hpp"
#include "trace/step/halo_ends.hpp"

namespace straytrace::trace {
namespace {

class Builder {
 public:
  Builder(World const& world, ImportanceSettings const& settings)
      : world_(world), settings_(settings), tables_(make_strips(world)), goals_(goals_of(world.view())) {
    merge_strips(world, settings.most_patches, tables_);
  }

  SteeringTables build() {
    if (tables_.strips.empty()) return {};
    sides_ = exchanges(world_, tables_, goals_, settings_.samples, settings_.threads);
    worths_.assign(goals_.size(), {std::vector<double>(sides_.size(), 0), std::vector<double>(sides_.size(), 1)});
    solve_all();
    if (tables_.patches.size() > patches_with_every_line) {
      trace_every_line(world_, tables_, decisive_pairs(), settings_.samples, settings_.threads, sides_);
      solve_all();
    }
    choose_targets();
    if (settings_.pilot_histories > 0) {
      learn();
      choose_targets();
    }
    choose_connections();
    return std::move(tables_);
  }

 private:
  // All light of a goal, by its adjoints.
  double total_of(std::vector<double> const& adjoint) const {
    double total = 0;
    bool lit = false;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      if (sides_[i].by_law.empty()) continue;
      lit = true;
      total += forward_score(i, adjoint);
    }
    return lit ? total : *std::ranges::max_element(adjoint);  // only free beams: any unit will do
  }
  // In units of the total light of each goal; goals that no light reaches are omitted.
  std::vector<Worth> in_own_units() const {
    std::vector<Worth> all;
    for (Worth worth : worths_) {
      std::vector<double>& adjoint = worth.adjoint;
      double const total = total_of(adjoint);
      if (!(total > 0)) continue;
      for (double& a : adjoint) a /= total;
      all.push_back(std::move(worth));
    }
    return all;
  }
  // Where the pilot has enough paths it may raise an adjoint: the exchange neglects mirrors and glass.
  void learn() {
    constexpr std::uint64_t enough = 64;
    World steered = world_;
    steered.steer(tables_);
    Pilot const pilot = run_pilot(steered, settings_.pilot_histories);
    for (std::size_t g = 0; g < goals_.size(); ++g)
      for (std::size_t i = 0; i < sides_.size(); ++i)
        if (pilot.visits[i] >= enough && pilot.arrived[i] > 0)
          worths_[g].adjoint[i] = std::max(worths_[g].adjoint[i], pilot.scored[goals_[g]][i] / pilot.arrived[i]);
  }
  // Adjoint of one goal, and the hops of the walk that are still to come, a mean over the score: with n hops to come
  // the terms of the series count n times, B = albedo F (B + A). By the method of Gauss and Seidel, from what is known.
  void solve(std::size_t goal) {
    std::size_t const n = sides_.size();
    auto& [adjoint, hops] = worths_[goal];
    std::vector<double> counted(n);
    for (std::size_t i = 0; i < n; ++i) counted[i] = (hops[i] - 1) * adjoint[i];
    for (int sweep = 0; sweep < 40; ++sweep) {
      double change = 0, largest = 0;
      for (std::size_t i = 0; i < n; ++i) {
        double const albedo = std::min(sides_[i].albedo, 0.95), before = adjoint[i];
        auto const [coming, later] = sides_[i].diffuse.sums_of(adjoint, counted);
        adjoint[i] = sides_[i].direct[goal] + albedo * coming;
        counted[i] = albedo * (later + coming);
        change = std::max(change, std::fabs(adjoint[i] - before));
        largest = std::max(largest, adjoint[i]);
      }
      if (change <= 1e-3 * largest) break;
    }
    for (std::size_t i = 0; i < n; ++i)
      hops[i] = 1 + std::min(adjoint[i] > 0 ? counted[i] / adjoint[i] : 0, double(world_.limits.max_order));
  }
  void solve_all() {
    in_parallel(goals_.size(), settings_.threads, [&](std::size_t g) { solve(g); });
  }
  double forward_score(std::size_t side, std::vector<double> const& adjoint) const {
    double sum = 0;
    for (std::size_t j = 0; j < adjoint.size(); ++j) sum += sides_[side].by_law.share(j) * adjoint[j];
    return sum;
  }

  // Pairs of patches of which one may be a target of the other that matters: for each patch, those not before it.
  std::vector<std::vector<std::uint32_t>> decisive_pairs() const {
    std::vector<Worth> const worths = in_own_units();
    Parts const parts = parts_of(world_, tables_);
    std::vector<std::vector<std::uint32_t>> decisive(sides_.size()), pairs(tables_.patches.size());
    in_parallel(sides_.size(), settings_.threads, [&](std::size_t side) {
      std::vector<double> const efforts = efforts_of(parts, sides_[side].diffuse, worths, settings_.unseen);
      for (std::uint32_t j = 0; j < efforts.size(); ++j)
        if (efforts[j] > settings_.decisive) decisive[side].push_back(j);
    });
    for (std::uint32_t side = 0; side < sides_.size(); ++side)
      for (std::uint32_t const j : decisive[side]) pairs[std::min(side / 2, j)].push_back(std::max(side / 2, j));
    for (auto& list : pairs) {
      std::ranges::sort(list);
      list.erase(std::unique(list.begin(), list.end()), list.end());
    }
    return pairs;
  }

  void choose_targets() {
    std::vector<Worth> const worths = in_own_units();
    Parts const parts = parts_of(world_, tables_);
    std::vector<std::vector<Target>> lists(sides_.size());
    std::vector<double> levels(sides_.size(), 0);
    in_parallel(sides_.size(), settings_.threads, [&](std::size_t i) {
      PatchSide& side = tables_.sides[i] = {};
      Exchange const& exchange = sides_[i];
      bool const emits = !exchange.by_law.empty();  // few sides do: they get whole lists
      for (Worth const& w : worths) {
        side.adjoint += w.adjoint[i];
        if (emits) levels[i] += forward_score(i, w.adjoint);
      }
      Arriving const& arriving = emits ? exchange.by_law : exchange.diffuse;
      lists[i] = targets_of(efforts_of(parts, arriving, worths, settings_.unseen),
                            emits ? tables_.patches.size() : settings_.most_targets);
      if (!lists[i].empty())
        side.alpha = best_law_share(arriving, emits ? exchange.emitted : 1, lists[i], worths, i, parts.of_patch,
                                    std::max(settings_.alpha, 0.1));
    });
    tables_.targets.clear();
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      tables_.sides[i].first = std::uint32_t(tables_.targets.size());
      tables_.sides[i].count = std::uint32_t(lists[i].size());
      tables_.targets.insert(tables_.targets.end(), lists[i].begin(), lists[i].end());
    }
    double const level = std::accumulate(levels.begin(), levels.end(), 0.0);
    tables_.level = settings_.window ? level : 0;
  }

  // Connections of a mirror with itself are made more rarely where they are worth much less than all that light does
  // from there (eq. 1.27). The other tables are too coarse for that: a part in sight that eight lines miss, or the axis
  // between two mirrors, would have few and large scores.
  void choose_connections() {
    constexpr double certain = 1.0 / 8, least = 1.0 / 8;
    WorldView const view = world_.view();
    std::vector<double> totals, all(sides_.size(), 0);
    for (auto const& [adjoint, hops] : worths_) {
      totals.push_back(total_of(adjoint));
      for (std::size_t i = 0; i < sides_.size() && totals.back() > 0; ++i)
        all[i] = std::max(all[i], adjoint[i] / totals.back());
    }
    tables_.modes = std::uint32_t(view.lit.size);
    tables_.connections.assign(sides_.size() * view.lit.size, 1);
    for (std::size_t g = 0; g < goals_.size(); ++g) {
      if (is_receiver(view, goals_[g]) || !(totals[g] > 0)) continue;
      for (std::size_t i = 0; i < sides_.size(); ++i) {
        bool const with_itself = !sides_[i].by_law.empty() && surface_of_side(i) == view.lit[goals_[g]].surface;
        if (!with_itself || !(all[i] > 0)) continue;
        double const share = sides_[i].direct[g] / totals[g] / all[i];
        tables_.connections[i * view.lit.size + goals_[g]] = float(std::clamp(share / certain, least, 1.0));
      }
    }
  }
  // Of the first member: lit surfaces are not joined with others.
  SurfaceId surface_of_side(std::size_t side) const {
    return tables_.strips[tables_.members[tables_.patches[side / 2].first].strip].surface;
  }

  World const& world_;
  ImportanceSettings const& settings_;
  SteeringTables tables_;
  std::vector<std::uint32_t> goals_;  // footprints where light rejoins, then receivers
  std::vector<Exchange> sides_;       // two per patch
  std::vector<Worth> worths_;         // by goal; adjoints as score per unit of power arriving
};

}  // namespace

SteeringTables make_importance(World const& world, ImportanceSettings const& settings) {
  return Builder(world, settings).build();
}

namespace {

// Mean of power x adjoint where light below the crossover angle meets surfaces.
double halo_level(World const& world) {
  constexpr int starts = 4096;
  WorldView const view = world.view();
  double sum = 0;
  for (int i = 0; i < starts; ++i) {
    PathState path;
    Vertex vertex;
    double const golden = (i + 1) * 0.6180339887498949;
    if (!start_in_halo(view, (i + 0.5) / starts, 0.5, golden - std::floor(golden), path, vertex)) continue;
    if (vertex.side() != WorldView::none) sum += path.power * view.steering.sides[vertex.side()].adjoint;
  }
  return sum / starts;
}

}  // namespace

SteeredWorld steer(World& world, unsigned threads) {
  find_covered_receivers(world);
  if (world.limits.targets) {
    ImportanceSettings settings;
    settings.alpha = world.limits.law_share;
    settings.window = world.limits.window;
    settings.threads = threads;
    if (world.receivers().empty()) settings.pilot_histories = 0;
    world.steer(make_importance(world, settings));
  }
  if (world.steering().level > 0 && world.halo().emitted > 0) world.set_halo_level(halo_level(world));
  choose_sub_paths_of_modes(world);
  choose_aim_shares(world);
  choose_sub_paths_of_receivers(world);
  find_map_cells(world);
  return SteeredWorld(world);
}

}  // namespace straytrace::trace
