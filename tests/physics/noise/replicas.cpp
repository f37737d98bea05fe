// SPDX-License-Identifier: BSD-3-Clause
// The Monte-Carlo error of the noise.
#include "base/math/rng.hpp"
#include "noise/project/route_noise.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing {
namespace {

double normal(Rng& rng) { return std::sqrt(-2 * std::log(rng.uniform())) * std::cos(2 * pi * rng.uniform()); }

// 32 blocks of 30 paths whose couplings and phase sensitivities both scatter (log-normal).
CouplingTable random_table(std::uint64_t seed, double spread_coupling, double spread_phase_sensitivity) {
  CouplingTable table = known_table({known_class(1, 0, {})});
  CouplingClass& c = table.classes[0];
  c.replica_sum.fill(0);
  double sum = 0;
  for (std::uint64_t block = 0; block < replica_count; ++block) {
    for (std::uint64_t i = 0; i < 30; ++i) {
      std::uint64_t const history = block * 4096 + i;
      Rng rng(seed, history, 0, Stream::source);
      double const score = std::exp(spread_coupling * normal(rng)),
                   length = std::exp(spread_phase_sensitivity * normal(rng));
      c.records.push_back(record(history, score, {phase_sensitivity(0, 2, two_k * length)}));
      c.replica_sum[replica_of(history, table.block_size)] += score;
      sum += score;
    }
  }
  c.coupling.mean = sum / static_cast<double>(table.histories);
  for (PathRecord& r : c.records) r.weight /= static_cast<double>(table.histories);
  return table;
}

struct Spread {
  double seen, stated;  // of the ASD, relative
};
Spread repeat(double spread_coupling, double spread_phase_sensitivity, Spectrum const& motion) {
  constexpr int runs = 200;
  double sum = 0, sum2 = 0, stated = 0;
  for (int run = 0; run < runs; ++run) {
    CouplingTable const table = random_table(1000 + run, spread_coupling, spread_phase_sensitivity);
    NoiseTrace const t = project_noise(table, moving({motion}), UnitDetector(), on({10, 10.4})).total;
    sum += t.asd[0] / runs;
    sum2 += t.asd[0] * t.asd[0] / runs;
    stated += t.sigma[0] / runs;
  }
  return {std::sqrt(sum2 - sum * sum) / sum, stated / sum};
}

// The scatter over 200 independent tables (known to 5 %) against the error that each states; tolerance 30 %.
TEST(Replicas, StatedErrorIsTheScatter) {
  Spectrum const weak = power_law_asd(1e-13, 10, -2, 1, 100);
  Spread const both = repeat(0.5, 0.3, weak), phase_sensitivities = repeat(0, 0.3, weak),
               coupling = repeat(0.5, 0, weak);
  for (Spread const& s : {both, phase_sensitivities, coupling}) EXPECT_LT(deviation(s.stated, s.seen), 0.3);
  // Control: the error of the mean coupling alone excludes the phase sensitivities.
  EXPECT_GT(deviation(coupling.stated, both.seen), 0.3);
  // Closed form for fixed phase sensitivities: half the relative error of the mean of 960 log-normal scores.
  EXPECT_LT(deviation(coupling.stated, std::sqrt(std::expm1(0.25) / 960) / 2), 0.1);
}

// Deviations of the replicas: their squares sum to that of the error, and bins that one spectrum moves have equal ones,
// relative to the bin.
TEST(Replicas, DeviationsMakeTheError) {
  CouplingTable const table = random_table(1, 0.5, 0.3);
  NoiseBudget const b =
      project_noise(table, moving({power_law_asd(1e-13, 10, -2, 1, 100)}), UnitDetector(), on({10, 10.4, 11}));
  ASSERT_EQ(deviations(b.total).size(), std::size_t(replica_count));
  for (std::size_t i = 0; i < 2; ++i) {
    double square = 0, single = 0;
    for (auto const& of_replica : deviations(b.total)) {
      square += of_replica[i] * of_replica[i];
      single = std::max(single, std::fabs(of_replica[i]));
      EXPECT_NEAR(of_replica[i] / b.total.asd[i], of_replica[0] / b.total.asd[0], 1e-6);
    }
    EXPECT_LT(deviation(std::sqrt(square), b.total.sigma[i]), 1e-9);
    EXPECT_GT(deviation(single, b.total.sigma[i]), 0.2) << "control: no replica alone makes it";
  }
}

// From 2048 blocks on a route keeps no more paths: where their phase sensitivities make the error, a line says that it
// stays. Controls: half as many blocks; an error of the power, which falls.
TEST(Replicas, SayWhereMoreHistoriesDoNotHelp) {
  auto const notes = [](std::uint64_t blocks, double spread_coupling, double spread_phase_sensitivity) {
    CouplingTable table = random_table(1, spread_coupling, spread_phase_sensitivity);
    std::uint64_t const times = blocks / replica_count;
    table.histories *= times;
    for (auto& n : table.replica_histories) n *= times;
    for (double& sum : table.classes[0].replica_sum) sum *= double(times);
    return project_noise(table, moving({power_law_asd(1e-13, 10, -2, 1, 100)}), UnitDetector(), on({10, 10.4, 11}))
        .warnings;
  };
  std::vector<std::string> const stays = notes(2048, 0, 0.3);
  ASSERT_EQ(stays.size(), 1u);
  EXPECT_TRUE(stays[0].starts_with("the error of h between 10 and 11 Hz, up to ")) << stays[0];
  EXPECT_TRUE(stays[0].find("a route keeps at most 4096, so more histories do not lower it") != std::string::npos);
  EXPECT_TRUE(notes(1024, 0, 0.3).empty()) << "control";
  EXPECT_TRUE(notes(2048, 0.5, 0).empty()) << "control";
}

TEST(Replicas, JackknifeOfAMean) {  // of a plain mean it is the textbook error, tolerance 1e-12
  std::vector<double> const x = {3, 1, 4, 1, 5, 9, 2, 6};
  double sum = 0, sum2 = 0;
  for (double v : x) sum += v;
  std::vector<double> without;
  for (double v : x) {
    without.push_back((sum - v) / 7);
    sum2 += std::pow(v - sum / 8, 2);
  }
  EXPECT_LT(deviation(jackknife_variance(without), sum2 / 7 / 8), 1e-12);
  EXPECT_TRUE(std::isnan(jackknife_variance(std::vector<double>{1})));
}

}  // namespace
}  // namespace straytrace::testing
