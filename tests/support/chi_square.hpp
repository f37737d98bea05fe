// SPDX-License-Identifier: BSD-3-Clause
// Chi-square comparison of counts with expectations (docs/develop/testing.md): significance 1e-6 over a family of
// checks (Sidak), cells pooled to at least five expected counts.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "support/recorded.hpp"

namespace straytrace::testing {

// Upper tail of the chi-square distribution: regularised incomplete gamma function Q(dof/2, x/2).
inline double chi_square_tail(double x, double dof) {
  double const a = dof / 2, half = x / 2;
  if (half <= 0) return 1;
  double const front = std::exp(a * std::log(half) - half - std::lgamma(a));
  if (half < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < 10000 && term > 1e-17 * sum; ++n) sum += term *= half / (a + n);
    return 1 - front * sum;
  }
  double b = half + 1 - a, c = 1e300, d = 1 / b, fraction = d;
  for (int n = 1; n < 10000; ++n) {
    double const an = -n * (n - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    fraction *= c * d;
    if (std::fabs(c * d - 1) < 1e-15) break;
  }
  return front * fraction;
}

struct ChiSquare {
  double statistic = 0, p = 0;  // p: chance of a statistic at least as large when the expectation is right
  int dof = 0;
};

// p = 0 when a sample fell where nothing is expected or when the expectations do not add up to the samples drawn;
// also when fewer than `least_dof` degrees of freedom are left, which would be a check that sees nothing.
inline ChiSquare chi_square(std::vector<double> const& observed, std::vector<double> const& expected, int least_dof) {
  ChiSquare result;
  double sum_observed = 0, sum_expected = 0, pooled_observed = 0, pooled_expected = 0;
  int cells = 0;
  std::vector<std::size_t> order(expected.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](auto i, auto j) { return expected[i] < expected[j]; });
  for (std::size_t i : order) {
    sum_observed += observed[i];
    sum_expected += expected[i];
    if (!(expected[i] > 0) && observed[i] > 0) return result;
    pooled_observed += observed[i];
    pooled_expected += expected[i];
    if (pooled_expected < 5) continue;
    result.statistic += std::pow(pooled_observed - pooled_expected, 2) / pooled_expected;
    pooled_observed = pooled_expected = 0;
    ++cells;
  }
  result.statistic += pooled_expected > 0 ? std::pow(pooled_observed - pooled_expected, 2) / pooled_expected : 0;
  result.dof = cells - 1;
  if (std::fabs(sum_observed - sum_expected) > 1e-3 * sum_observed || result.dof < least_dof) return result;
  result.p = chi_square_tail(result.statistic, result.dof);
  return result;
}

// Whether one of `checks` checks of a file passes at a significance of 1e-6 for all of them together.
inline bool passes(ChiSquare const& c, int checks) {
  double const least = -std::expm1(std::log1p(-1e-6) / checks);
  if (c.p > least) recorded::record({recorded::Kind::above, __FILE__, __LINE__, "p of chi-square", "", c.p, least});
  return c.p > least;
}

}  // namespace straytrace::testing
