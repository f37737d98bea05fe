// SPDX-License-Identifier: BSD-3-Clause
#include "session/optimise/confidence.hpp"

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/math/rng.hpp"
#include "base/math/samples.hpp"
#include "results/curves/band.hpp"

namespace straytrace::session {
namespace {

constexpr std::size_t multipliers = 10000;
constexpr std::uint64_t multiplier_seed = 20;
constexpr double tenfold = 10;  // as of routes that are too faint to be told (noise.hpp)

// Constants, of no run: independent of its seed.
std::vector<double> const& gaussian_multipliers() {
  static std::vector<double> const all = [] {
    std::vector<double> out;
    boost::math::normal const gauss;
    for (std::uint64_t m = 0; m < multipliers; ++m) {
      Rng rng(multiplier_seed, m, 0, Stream::static_phase);
      for (int r = 0; r < replica_count; ++r) out.push_back(boost::math::quantile(gauss, rng.uniform()));
    }
    return out;
  }();
  return all;
}

// Deviations of each bin over the root of the sum of their squares, [bin][replica]; bins without error are left out.
std::vector<std::vector<double>> studentised(std::vector<std::vector<double>> const& deviations) {
  std::vector<std::vector<double>> out;
  std::size_t const bins = deviations.empty() ? 0 : deviations.front().size();
  for (std::size_t i = 0; i < bins; ++i) {
    std::vector<double> own;
    double square = 0;
    for (auto const& of_replica : deviations) {
      own.push_back(of_replica[i]);
      square += of_replica[i] * of_replica[i];
    }
    if (!(square > 0) || !std::isfinite(square)) continue;
    for (double& d : own) d /= std::sqrt(square);
    out.push_back(std::move(own));
  }
  return out;
}

}  // namespace

double factor_of_all(std::vector<std::vector<double>> const& deviations, double confidence) {
  boost::math::normal const gauss;
  auto const bins = studentised(deviations);
  double factor = boost::math::quantile(gauss, confidence);
  if (bins.size() > 1) {
    std::vector<double> const& g = gaussian_multipliers();
    std::vector<double> largest;
    for (std::size_t m = 0; m < multipliers; ++m) {
      double worst = -infinity;
      for (auto const& own : bins) {
        double sum = 0;
        for (std::size_t r = 0; r < own.size(); ++r) sum += g[m * replica_count + r] * own[r];
        worst = std::max(worst, sum);
      }
      largest.push_back(worst);
    }
    std::sort(largest.begin(), largest.end());
    factor = nearest_rank(largest, confidence);
  }
  if (deviations.size() < 2) return factor;
  boost::math::students_t const student(double(deviations.size() - 1));  // the errors are estimates themselves
  return boost::math::quantile(student, boost::math::cdf(gauss, factor));
}

LineVerdict compared(NoiseBudget const& budget, std::vector<double> const& line, double confidence) {
  std::vector<std::size_t> bins;
  for (std::size_t i = 0; i < line.size(); ++i)
    if (line[i] > 0 && std::isfinite(line[i])) bins.push_back(i);
  LineVerdict out;
  if (bins.empty()) return out;
  std::vector<std::vector<double>> chosen;
  for (auto const& of_replica : deviations(budget.total)) {
    chosen.emplace_back();
    for (std::size_t const i : bins) chosen.back().push_back(of_replica[i]);
  }
  out.factor = factor_of_all(chosen, confidence);
  std::optional<std::size_t> decides;
  double const unresolved = 0.5 * std::log1p((tenfold - 1) * budget.unresolved_hint);
  for (std::size_t const i : bins) {
    double const h = budget.total.asd[i], sigma = budget.total.sigma[i];
    double const excess = std::log(std::max((h + out.factor * sigma) / line[i], 1e-300)) + unresolved;
    if (std::isnan(h) || !(std::isnan(out.excess) || excess > out.excess)) continue;
    out.excess = excess;
    decides = i;
    out.hz = budget.grid.centre(i);
    out.ratio = {h / line[i], sigma / line[i], results::at_most(budget.total, i), !budget.unresolved.empty()};
  }
  if (decides)
    for (auto const& of_replica : deviations(budget.total))
      out.deviations.push_back(of_replica[*decides] / budget.total.asd[*decides]);
  return out;
}

}  // namespace straytrace::session
