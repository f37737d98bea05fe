// SPDX-License-Identifier: BSD-3-Clause
#include "noise/bands/traced_elasticity.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/math/constants.hpp"

namespace straytrace::noise {
namespace {

constexpr int most_moves = 3;
constexpr double enough = 0.01;  // error and truncation together, of the elasticity: no better step is needed
constexpr double largest = 0.2;  // step; twice of it is traced

// Each step is traced once: halves and doubles are the same numbers.
class Traces {
 public:
  explicit Traces(TracedTotal const& total) : total_(total) {}
  NoiseTrace const& at(double step) {
    auto const found = kept_.find(step);
    return found != kept_.end() ? found->second : kept_.emplace(step, total_(step)).first->second;
  }

 private:
  TracedTotal const& total_;
  std::map<double, NoiseTrace> kept_;
};

double correlation(BinValues const& paired, BinValues const& independent) {
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < paired.sigma.size(); ++i) {
    if (!(independent.sigma[i] > 0)) continue;
    sum += 1 - std::pow(paired.sigma[i] / independent.sigma[i], 2);
    ++n;
  }
  return n > 0 ? sum / n : not_a_number;
}

BinValues over(BinValues values, double by) {
  for (std::vector<double>* const all : {&values.value, &values.sigma})
    for (double& v : *all) v /= by;
  return values;
}

TracedElasticity at_step(Traces& traces, double step) {
  NoiseTrace const &high = traces.at(step), &low = traces.at(-step);
  TracedElasticity out;
  out.step = step;
  BinValues const paired = log_ratio(high, low, true, 2 * step);
  out.correlation = correlation(paired, log_ratio(high, low, false));
  out.elasticity = out.monte_carlo = over(paired, 2 * step);
  return out;
}

struct Truncation {
  BinValues of_step;  // of the elasticity at the step: a third of its change with the double one (eq. D.15)
  BinValues extrapolated;
};

Truncation truncation(Traces& traces, double step) {
  NoiseTrace const *const h1 = &traces.at(step), *const l1 = &traces.at(-step), *const h2 = &traces.at(2 * step),
                          *const l2 = &traces.at(-2 * step);
  return {over(log_sum({{0.5, h2}, {-0.5, l2}, {-1, h1}, {1, l1}}), 6 * step),
          over(log_sum({{8, h1}, {-8, l1}, {-1, h2}, {1, l2}}), 12 * step)};
}

// By how much the step should change, at the bin that needs the smallest one; 1 where it is good enough (eq. D.16).
double advised(TracedElasticity const& at, BinValues const& cut, std::vector<std::size_t> const& bins) {
  double least = infinity;
  bool good = true;
  for (std::size_t const i : bins) {
    double const error = at.monte_carlo.sigma[i], e = at.monte_carlo.value[i];
    if (!std::isfinite(e)) continue;
    double const seen = std::max(std::fabs(cut.value[i]), 0.5 * cut.sigma[i]);
    good = good && std::hypot(error, seen) <= enough * std::fabs(e);
    if (seen > 0) least = std::min(least, std::pow(error / (2 * seen), 0.4));
  }
  return good || !std::isfinite(least) ? 1 : least;
}

}  // namespace

TracedElasticity traced_elasticity(TracedTotal const& total, double step) {
  Traces traces(total);
  return at_step(traces, step);
}

TracedElasticity balanced_elasticity(TracedTotal const& total, double start, std::vector<std::size_t> const& bins) {
  Traces traces(total);
  TracedElasticity out;
  double step = start, before = 0;
  for (int move = 0; move <= most_moves; ++move) {
    out = at_step(traces, step);
    Truncation const cut = truncation(traces, step);
    out.doubled = at_step(traces, 2 * step).monte_carlo;
    out.extrapolated = cut.extrapolated;
    for (std::size_t i = 0; i < out.elasticity.sigma.size(); ++i)
      out.elasticity.sigma[i] = std::hypot(out.monte_carlo.sigma[i], cut.of_step.value[i]);
    double const by = advised(out, cut.of_step, bins);
    double const next = by > std::sqrt(2) ? 2 * step : by < std::sqrt(0.5) ? step / 2 : step;
    if (next == step || next == before || next > largest) break;
    before = step;
    step = next;
  }
  return out;
}

}  // namespace straytrace::noise
