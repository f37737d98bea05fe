// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>

#include "base/errors.hpp"
#include "trace/result.hpp"
#include "trace/tally/replay.hpp"
#include "world/model/world.hpp"

namespace straytrace::trace {
namespace {

auto place(PhaseSensitivityProduct const& p) { return std::tuple(p.replica, p.first, p.second); }

PhaseSensitivityProduct& product_at(std::vector<PhaseSensitivityProduct>& list, PhaseSensitivityProduct const& like) {
  auto const at = std::lower_bound(list.begin(), list.end(), like,
                                   [](auto const& a, auto const& b) { return place(a) < place(b); });
  if (at != list.end() && place(*at) == place(like)) return *at;
  return *list.insert(at, {like.replica, like.first, like.second});
}

void add_products(std::vector<PhaseSensitivityProduct>& into, std::vector<PhaseSensitivityProduct> const& from,
                  double factor) {
  for (PhaseSensitivityProduct const& p : from) {
    PhaseSensitivityProduct& own = product_at(into, p);
    for (std::size_t i = 0; i < p.sum.size(); ++i) own.sum[i] += factor * p.sum[i];
  }
}

bool too_many(std::vector<PhaseSensitivityProduct> const& products) {
  std::array<std::size_t, replica_count> pairs = {};
  return std::ranges::any_of(products, [&](PhaseSensitivityProduct const& p) {
    return ++pairs[p.replica] > PhaseSensitivitySums::most_pairs;
  });
}

}  // namespace

void PhaseSensitivitySums::give_up() {
  *this = {};
  given_up = true;
}

void PhaseSensitivitySums::add(std::size_t replica, double path_weight,
                               std::vector<PhaseSensitivity> const& phase_sensitivities) {
  if (given_up) return;
  ++paths;
  weight[replica] += path_weight;
  for (auto a = phase_sensitivities.begin(); a != phase_sensitivities.end(); ++a)
    for (auto b = a; b != phase_sensitivities.end(); ++b) {
      PhaseSensitivityProduct& own = product_at(products, {std::uint32_t(replica), a->body, b->body});
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j) own.sum[6 * i + j] += path_weight * a->d[i] * b->d[j];
    }
  if (too_many(products)) give_up();
}

void PhaseSensitivitySums::add(PhaseSensitivitySums const& other, double factor) {
  if (given_up || other.given_up) return give_up();
  paths += other.paths;
  for (std::size_t r = 0; r < replica_count; ++r) weight[r] += factor * other.weight[r];
  add_products(products, other.products, factor);
  if (too_many(products)) give_up();
}

namespace {

constexpr std::size_t phase_sensitivities_per_block = 128;

struct Candidate {
  double priority;  // coupling over the root of that of its route in the block, over its random number
  std::uint64_t route;
  ScoreAddress score;
};

bool drawn_before(Candidate const& a, Candidate const& b) {
  if (a.priority != b.priority) return a.priority > b.priority;
  return std::tuple(a.route, a.score.history, a.score.event, a.score.connection) <
         std::tuple(b.route, b.score.history, b.score.event, b.score.connection);
}

}  // namespace

void sum_phase_sensitivities(SteeredWorld const& world, std::uint64_t seed, std::size_t replica, BlockSums& block) {
  std::vector<Candidate> drawn;
  for (auto const& [route, sums] : block.classes) {
    if (sums.port >= first_receiver_end || !(sums.moments.sum > 0)) continue;
    double const light = std::sqrt(sums.moments.sum);
    std::size_t const most =
        std::min(sums.kept.size(), phase_sensitivities_per_block + 1);  // of which one is the threshold
    for (std::size_t i = 0; i < most; ++i) drawn.push_back({sums.kept[i].priority / light, route, sums.kept[i]});
  }
  double threshold = 0;
  if (drawn.size() > phase_sensitivities_per_block) {
    std::nth_element(drawn.begin(), drawn.begin() + phase_sensitivities_per_block, drawn.end(), drawn_before);
    threshold = drawn[phase_sensitivities_per_block].priority;
    drawn.resize(phase_sensitivities_per_block);
  }
  std::ranges::sort(drawn, drawn_before);
  Replay replay(world, seed);
  for (Candidate const& c : drawn) {
    auto const path = replay(c.score.history, c.score.event, c.score.connection);
    if (!path || path->coupling != c.score.coupling)
      throw NumericalError(
          fmt::format("history {} event {} does not replay to the same score", c.score.history, c.score.event));
    ClassSums& sums = block.classes.at(c.route);
    sums.phase_sensitivities.add(replica, std::max(c.score.coupling, threshold * std::sqrt(sums.moments.sum)),
                                 path->phase_sensitivities);
  }
}

std::vector<PhaseSensitivityProduct> phase_sensitivity_moments(CouplingClass const& c,
                                                               PhaseSensitivitySums const& drawn, bool all_kept,
                                                               std::uint64_t histories, std::uint64_t block_size) {
  PhaseSensitivitySums kept;
  for (PathRecord const& r : c.records)
    kept.add(r.history / block_size % replica_count, r.weight, r.phase_sensitivities);
  auto const total = [](PhaseSensitivitySums const& s) {
    return std::accumulate(s.weight.begin(), s.weight.end(), 0.0);
  };
  double const of_kept = total(kept), of_drawn = all_kept ? 0 : total(drawn), mean = c.coupling.mean;
  if (kept.given_up || !(of_kept > 0) || !(mean > 0)) return {};
  PhaseSensitivitySums both;
  double const share = of_drawn > 0 ? double(drawn.paths) / double(drawn.paths + kept.paths) : 0;
  both.add(kept, (1 - share) / of_kept);
  if (share > 0) both.add(drawn, share / of_drawn);
  if (both.given_up) return {};

  std::set<std::pair<BodyId, BodyId>> pairs;
  for (PhaseSensitivityProduct const& p : both.products) pairs.insert({p.first, p.second});
  if (pairs.size() > PhaseSensitivitySums::most_pairs) return {};
  std::vector<PhaseSensitivityProduct> out;
  for (std::uint32_t r = 0; r < replica_count; ++r)
    for (auto const& [first, second] : pairs) out.push_back({r, first, second});
  for (PhaseSensitivityProduct const& p : both.products)
    for (PhaseSensitivityProduct& to : out) {
      if (to.first != p.first || to.second != p.second) continue;
      double const factor = c.replica_sum[to.replica] / double(histories) - mean * both.weight[to.replica] +
                            (to.replica == p.replica ? mean : 0);
      for (std::size_t i = 0; i < p.sum.size(); ++i) to.sum[i] += factor * p.sum[i];
    }
  return out;
}

bool add_moments(std::vector<PhaseSensitivityProduct>& into, std::vector<PhaseSensitivityProduct> const& from) {
  add_products(into, from, 1);
  if (!too_many(into)) return true;
  into.clear();
  return false;
}

}  // namespace straytrace::trace
