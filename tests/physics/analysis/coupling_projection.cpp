// SPDX-License-Identifier: BSD-3-Clause
// Injection, coupling, projection: the noise that a witness makes in quiet times (R6.08).
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/coupling/coupling.hpp"
#include "support/recorded.hpp"
#include "support/signal_support.hpp"

namespace straytrace::commission_coupling_projection {
namespace {

using namespace straytrace::testing;

constexpr double rate = 512;
constexpr WelchSettings settings{.segment = 256};

// y = (x(t) + x(t - 1 sample)) c: |H| = 2 c cos(pi f/rate), and own noise of the target.
TimeSeries target_of(std::vector<double> const& x, double c, std::uint64_t seed) {
  std::vector<double> y(x.size());
  for (std::size_t i = 1; i < y.size(); ++i) y[i] = c * (x[i] + x[i - 1]);
  return channel("H", "1", rate, y + white_noise(y.size(), seed, 1e-21));
}

double mean_ratio(CouplingFunction const& c, QuietWitness const& w, double factor) {
  double sum = 0;
  int count = 0;
  for (ProjectedPoint const& p : project_coupling(c, w).points) {
    if (p.flag != CouplingFlag::measured || p.hz > 0.4 * rate) continue;
    sum += p.asd / (2 * factor * std::cos(pi * p.hz / rate) * 1e-9 * std::sqrt(2 / rate));
    ++count;
  }
  EXPECT_GT(count, 80);
  return sum / count;
}

TEST(CouplingProjection, LinearSyntheticIsTheTruthWithinFivePercentR6_08) {
  constexpr std::size_t n = 100 * 256;
  constexpr double factor = 4e-13;  // 1/m: quiet motion of 1 nm makes 4e-22, below the target's own noise
  std::vector<double> const still = white_noise(n, 1, 1e-9), loud = white_noise(n, 2, 3e-8);
  CrossSpectra const quiet = cross_spectra(channel("ACC", "m", rate, still), target_of(still, factor, 3), settings);
  CrossSpectra const injection = cross_spectra(channel("ACC", "m", rate, loud), target_of(loud, factor, 4), settings);
  CouplingFunction const c{"ACC", "H", "m", "1/m", measure_coupling(injection, quiet, {})};
  QuietWitness w{"m", quiet.hz, quiet.input, quiet.input};
  for (std::size_t k = 0; k < w.hz.size(); ++k) {
    w.asd[k] = std::sqrt(quiet.input[k]);
    w.sigma[k] = w.asd[k] / (2 * std::sqrt(quiet.effective_averages));
  }
  EXPECT_NEAR(mean_ratio(c, w, factor), 1, 0.02);
  Coverage coverage;
  for (ProjectedPoint const& p : project_coupling(c, w).points)
    if (p.flag == CouplingFlag::measured && p.hz > 4 && p.hz < 0.4 * rate)
      coverage.add(p.asd, p.sigma, 2 * factor * std::cos(pi * p.hz / rate) * 1e-9 * std::sqrt(2 / rate));
  EXPECT_GT(coverage.share(), 0.6);
  EXPECT_LT(coverage.share(), 0.75);
  // Controls: PSDs divided without the root; the injected witness projected instead of the quiet one.
  EXPECT_GT(std::fabs(mean_ratio(c, {"m", w.hz, quiet.input, w.sigma}, factor) - 1), 0.05);
  std::vector<double> injected = injection.input;
  for (double& v : injected) v = std::sqrt(v);
  EXPECT_GT(mean_ratio(c, {"m", w.hz, injected, w.sigma}, factor), 20);
}

}  // namespace
}  // namespace straytrace::commission_coupling_projection
