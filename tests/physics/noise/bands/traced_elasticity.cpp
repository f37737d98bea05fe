// SPDX-License-Identifier: BSD-3-Clause
// The step of traces with common random numbers (docs/theory/decisions.md, eq. D.15 and D.16).
#include "base/math/rng.hpp"
#include "noise/bands/elasticity.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing::noise_traced_elasticity {
namespace {

constexpr double slope = 2, third = 120;  // ln h = slope t + third t^3/6

// Paths that meet other surfaces one by one: in each replica a random walk along t, of variance `rate` |t|.
struct Walks {
  double rate;
  int traced = 0;

  double at(int replica, double t) const {
    constexpr double spacing = 1e-3;
    double sum = 0;
    for (int n = 0; n < int(std::round(std::fabs(t) / spacing)); ++n) {
      Rng rng(1, std::uint64_t(n), std::uint64_t(2 * replica + (t < 0)), Stream::static_phase);
      sum += (rng.uniform() < 0.5 ? -1 : 1) * std::sqrt(rate * spacing);
    }
    return sum;
  }
  // Each replica has as many histories as any other: a mean of theirs, left out one by one.
  NoiseTrace operator()(double t) {
    ++traced;
    NoiseTrace total;
    double mean = 0;
    std::vector<double> own;
    for (int r = 0; r < replica_count; ++r) {
      own.push_back(std::exp(2 * (slope * t + third * t * t * t / 6 + std::sqrt(double(replica_count)) * at(r, t))));
      mean += own.back() / replica_count;
    }
    for (double const psd : own) total.without.push_back({(mean * replica_count - psd) / (replica_count - 1)});
    total.asd = {std::sqrt(mean)};
    total.sigma = {0.1 * total.asd[0]};
    return total;
  }
};

// d* = (9 v/g'''^2)^(1/5): both ends walk, so that the variance of e is 2 v/(4 d). Controls: at a quarter of that step
// the error is twice as large, at four times the step the truncation is many errors.
TEST(TracedElasticity, BalancesTruncationAndMonteCarlo) {
  Walks walks{2e-5};
  double const best = std::pow(9 * walks.rate / 2 / (third * third), 0.2);
  for (double const start : {0.012, 0.03, 0.1}) {
    TracedElasticity const found = balanced_elasticity(std::ref(walks), start, {0});
    EXPECT_LT(std::fabs(std::log2(found.step / best)), 1.5) << start << " " << found.step << " " << best;
    EXPECT_LT(std::fabs(found.elasticity.value[0] - slope), 3.5 * found.elasticity.sigma[0]);
    EXPECT_LT(std::fabs(found.extrapolated.value[0] - slope), 3.5 * found.extrapolated.sigma[0]);
  }
  TracedElasticity const fine = traced_elasticity(std::ref(walks), best / 8),
                         coarse = traced_elasticity(std::ref(walks), 8 * best),
                         balanced = traced_elasticity(std::ref(walks), best);
  EXPECT_GT(fine.elasticity.sigma[0], 2 * balanced.elasticity.sigma[0]) << "control";
  EXPECT_GT(std::fabs(coarse.elasticity.value[0] - slope), 10 * coarse.elasticity.sigma[0]) << "control";
}

// A power of the input has no truncation, and one factor on all light no error: the first step will do.
TEST(TracedElasticity, KeepsAStepThatIsGoodEnough) {
  int traced = 0;
  auto const total = [&](double t) {
    ++traced;
    NoiseTrace trace;
    trace.asd = {std::exp(1.5 * t)};
    trace.sigma = {0.1 * trace.asd[0]};
    trace.without.assign(replica_count, {std::exp(3 * t)});
    return trace;
  };
  TracedElasticity const found = balanced_elasticity(total, 0.03, {0});
  EXPECT_EQ(found.step, 0.03);
  EXPECT_EQ(traced, 4);
  EXPECT_NEAR(found.elasticity.value[0], 1.5, 1e-12);
  EXPECT_LT(found.elasticity.sigma[0], 1e-9);
  EXPECT_NEAR(found.extrapolated.value[0], 1.5, 1e-12);
}

}  // namespace
}  // namespace straytrace::testing::noise_traced_elasticity
