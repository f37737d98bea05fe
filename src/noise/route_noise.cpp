// SPDX-License-Identifier: BSD-3-Clause
#include "noise/route_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/constants.hpp"

namespace straytrace {
namespace {

constexpr std::uint64_t block_histories = 4096;

// Mean coupling without the histories of one replica.
double mean_without(CouplingTable const& table, CouplingClass const& c, std::size_t replica, double total) {
  return (total - c.replica_sum[replica]) / static_cast<double>(table.histories - table.replica_histories[replica]);
}

// Weights of the basis spectra, of all records and of those of each replica.
struct Histogram {
  explicit Histogram(std::size_t size) : all(size) {}
  void add(std::size_t replica, std::span<StrengthNodes::Share const> shares, double weight) {
    std::vector<double>& own = of[replica];
    own.resize(all.size());
    for (StrengthNodes::Share const& s : shares) {
      all[s.basis] += weight * s.weight;
      own[s.basis] += weight * s.weight;
    }
  }
  std::vector<double> all;
  std::array<std::vector<double>, replica_count> of;
};

Bins sum_of(std::span<double const> weight, std::vector<StrengthNodes::Basis> const& basis,
            Bins StrengthNodes::Basis::*part) {
  Bins sum(basis.empty() ? 0 : (basis.front().*part).size());
  for (std::size_t b = 0; b < weight.size(); ++b)
    for (std::size_t i = 0; weight[b] != 0 && i < sum.size(); ++i) sum[i] += weight[b] * (basis[b].*part)[i];
  return sum;
}

void scale(Bins& bins, double factor) {
  for (double& b : bins) b = std::max(0.0, b * factor);
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

RouteSpectrum route_spectrum(CouplingTable const& table, CouplingClass const& c, std::size_t first,
                             StrengthNodes const& nodes, std::span<double const> mean_square_phase) {
  RouteSpectrum route;
  route.exact = c.deterministic();
  Histogram histogram(nodes.basis().size());
  std::array<double, replica_count> own = {};
  double weight = 0;
  EffectiveNumber power, noise;
  std::vector<StrengthNodes::Share> shares;
  for (std::size_t i = 0; i < c.records.size(); ++i) {
    double const w = c.records[i].weight, strength = mean_square_phase[first + i];
    std::size_t const replica = replica_of(c.records[i].history);
    nodes.shares(first + i, shares);
    histogram.add(replica, shares, w);
    own[replica] += w;
    weight += w;
    route.mean_square_phase += w * strength;
    power.add(w);
    noise.add(w * strength / (1 + strength));  // wrapped fringes have a largest power
  }
  route.paths_of_power = power.value();
  route.paths_of_noise = noise.value();
  route.psd = sum_of(histogram.all, nodes.basis(), &StrengthNodes::Basis::psd);
  route.linear = sum_of(histogram.all, nodes.basis(), &StrengthNodes::Basis::linear);
  if (!(weight > 0)) return route;
  route.mean_square_phase /= weight;
  if (nodes.sampled()) {
    route.drawn.assign(route.psd.size(), 0);
    nodes.add_variance(histogram.all, route.drawn);
    scale(route.drawn, std::pow(c.coupling.mean / weight, 2));
  }
  Bins const sum = route.psd;
  scale(route.psd, c.coupling.mean / weight);
  scale(route.linear, c.coupling.mean / weight);
  if (route.exact) return route;

  double const total = std::accumulate(c.replica_sum.begin(), c.replica_sum.end(), 0.0);
  for (std::size_t r = 0; r < replica_count; ++r) {
    if (table.replica_histories[r] == 0 || table.replica_histories[r] == table.histories) continue;
    double const left = weight - own[r];
    bool const alone = left <= 1e-12 * weight;  // no record elsewhere: only the mean changes
    Bins& psd = route.without[r] = sum;
    if (!alone) {
      Bins const of_replica = sum_of(histogram.of[r], nodes.basis(), &StrengthNodes::Basis::psd);
      for (std::size_t i = 0; i < of_replica.size(); ++i) psd[i] -= of_replica[i];
    }
    scale(psd, mean_without(table, c, r, total) / (alone ? weight : left));
  }
  return route;
}

}  // namespace straytrace
