// SPDX-License-Identifier: BSD-3-Clause
#include "noise/route_noise.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "base/constants.hpp"

namespace straytrace {
namespace {

constexpr std::uint64_t block_histories = 4096;

// Mean coupling without the histories of one replica.
double mean_without(CouplingTable const& table, CouplingClass const& c, std::size_t replica, double total) {
  return (total - c.replica_sum[replica]) / static_cast<double>(table.histories - table.replica_histories[replica]);
}

void add(Bins& to, double factor, Bins const& what) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * what[i];
}

class EffectiveNumber {
 public:
  void add(double x) {
    sum_ += x;
    squares_ += x * x;
  }
  double value() const { return squares_ > 0 ? sum_ * sum_ / squares_ : 0; }

 private:
  double sum_ = 0, squares_ = 0;
};

}  // namespace

std::size_t replica_of(std::uint64_t history) { return history / block_histories % replica_count; }

double jackknife_variance(std::span<double const> without) {
  auto const n = static_cast<double>(without.size());
  if (n < 2) return not_a_number;
  double const mean = std::accumulate(without.begin(), without.end(), 0.0) / n;
  double sum = 0;
  for (double x : without) sum += (x - mean) * (x - mean);
  return (n - 1) / n * sum;
}

RouteSpectrum route_spectrum(CouplingTable const& table, CouplingClass const& c, std::span<std::uint32_t const> cell,
                             std::span<Bins const> cell_psd, std::span<double const> strength) {
  std::size_t const bins = cell_psd.empty() ? 0 : cell_psd.front().size();
  RouteSpectrum route;
  route.psd.assign(bins, 0);
  route.exact = c.deterministic();
  std::map<std::uint32_t, double> all;
  std::array<std::map<std::uint32_t, double>, replica_count> share;  // weight per replica and cell
  double weight = 0;
  EffectiveNumber power, noise;
  for (std::size_t i = 0; i < c.records.size(); ++i) {
    double const w = c.records[i].weight;
    all[cell[i]] += w;
    share[replica_of(c.records[i].history)][cell[i]] += w;
    weight += w;
    power.add(w);
    noise.add(w * strength[cell[i]] / (1 + strength[cell[i]]));  // wrapped fringes have a largest power
  }
  route.paths_of_power = power.value();
  route.paths_of_noise = noise.value();
  if (!(weight > 0)) return route;
  Bins sum(bins);
  for (auto const& [k, w] : all) {
    add(sum, w, cell_psd[k]);
    route.mean_square_phase += w / weight * strength[k];
  }
  add(route.psd, c.coupling.mean / weight, sum);
  if (route.exact) return route;

  double const total = std::accumulate(c.replica_sum.begin(), c.replica_sum.end(), 0.0);
  for (std::size_t r = 0; r < replica_count; ++r) {
    if (table.replica_histories[r] == 0 || table.replica_histories[r] == table.histories) continue;
    double left = weight;
    for (auto const& [k, w] : share[r]) left -= w;
    bool const alone = left <= 1e-12 * weight;  // no record elsewhere: only the mean changes
    Bins& psd = route.without[r] = sum;
    if (!alone)
      for (auto const& [k, w] : share[r]) add(psd, -w, cell_psd[k]);
    double const factor = mean_without(table, c, r, total) / (alone ? weight : left);
    for (double& p : psd) p = std::max(0.0, p * factor);
  }
  return route;
}

}  // namespace straytrace
