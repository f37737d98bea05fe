// SPDX-License-Identifier: BSD-3-Clause
#include "report/replicas.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace straytrace {

ReplicaPattern pattern_of(CouplingTable const& table, CouplingClass const& c) {
  auto const& histories = table.replica_histories;
  if (std::find(histories.begin(), histories.end(), 0u) != histories.end()) return {};
  double const sum = std::accumulate(c.replica_sum.begin(), c.replica_sum.end(), 0.0);
  double const mean = sum / double(std::accumulate(histories.begin(), histories.end(), std::uint64_t{}));
  ReplicaPattern off;
  double square = 0;
  for (std::size_t r = 0; r < replica_count; ++r) {
    off[r] = c.replica_sum[r] - mean * double(histories[r]);
    square += off[r] * off[r];
  }
  if (!(square > 1e-24 * sum * sum)) return {};  // equal sums: what is left is rounding
  for (double& x : off) x /= std::sqrt(square);
  return off;
}

ReplicaSum::ReplicaSum(WithError value, ReplicaPattern const& pattern) : value_(value.value), off_(pattern) {
  bool const alone = std::all_of(pattern.begin(), pattern.end(), [](double x) { return x == 0; });
  if (alone) independent_ = value.sigma * value.sigma;
  for (double& x : off_) x *= value.sigma;
}

void ReplicaSum::add(ReplicaSum const& other) {
  value_ += other.value_;
  independent_ += other.independent_;
  for (std::size_t r = 0; r < replica_count; ++r) off_[r] += other.off_[r];
}

WithError ReplicaSum::result() const {
  double variance = independent_;
  for (double const x : off_) variance += x * x;
  return {value_, std::sqrt(variance)};
}

// d(p/P) = (dp - s dP)/P; the part of dP without a pattern holds that of dp.
WithError ReplicaSum::share_of(ReplicaSum const& total) const {
  if (!(total.value_ > 0)) return {not_a_number, not_a_number};
  double const s = value_ / total.value_;
  double variance = (1 - 2 * s) * independent_ + s * s * total.independent_;
  for (std::size_t r = 0; r < replica_count; ++r) {
    double const off = off_[r] - s * total.off_[r];
    variance += off * off;
  }
  return {s, std::sqrt(std::fmax(variance, 0)) / total.value_};
}

}  // namespace straytrace
