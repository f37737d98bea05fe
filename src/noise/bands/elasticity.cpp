// SPDX-License-Identifier: BSD-3-Clause
#include "noise/bands/elasticity.hpp"

#include <algorithm>
#include <cmath>

#include "noise/project/route_noise.hpp"

namespace straytrace::noise {
namespace {

using Doubles = std::vector<double>;

// PSD of the whole without each replica: what no history changes is the same in all.
std::vector<Doubles> replicas_of(NoiseTrace const& t) {
  std::vector<Doubles> all(t.without.size(), Doubles(t.asd.size()));
  for (std::size_t i = 0; i < t.asd.size(); ++i) {
    double mean = 0;
    for (Doubles const& r : t.without) mean += r[i] / double(t.without.size());
    for (std::size_t r = 0; r < all.size(); ++r) all[r][i] = t.psd(i) + t.without[r][i] - mean;
  }
  return all;
}

// Relative error of the ASD by unresolved routes.
double hint(NoiseTrace const& t, std::size_t i) {
  return t.hint_sigma.empty() || !(t.asd[i] > 0) ? 0 : t.hint_sigma[i] / t.asd[i];
}

// A function of two PSDs in each bin, with its jackknife where both have the same replicas.
template <class Function>
BinValues of_pair(NoiseTrace const& a, NoiseTrace const& b, Function const& f) {
  BinValues out;
  std::vector<Doubles> const ra = replicas_of(a), rb = replicas_of(b);
  std::size_t const both = std::max(ra.size(), rb.size());
  for (std::size_t i = 0; i < a.asd.size(); ++i) {
    Doubles values;
    for (std::size_t r = 0; r < both; ++r)
      values.push_back(f(ra.empty() ? a.psd(i) : ra[r][i], rb.empty() ? b.psd(i) : rb[r][i]));
    out.value.push_back(f(a.psd(i), b.psd(i)));
    out.sigma.push_back(values.empty() ? 0 : std::sqrt(jackknife_variance(values)));
  }
  return out;
}

double ratio(double a, double b) { return b > 0 ? a / b : not_a_number; }
double half_log(double a, double b) { return a > 0 && b > 0 ? 0.5 * std::log(a / b) : not_a_number; }

// Of a row, by light.
struct RowFactor {
  double mean = 1;     // of the whole row
  double unknown = 0;  // share of it whose own factor is not known
};

void scale(PathRecord& r, double factor) {
  r.weight *= factor;
  r.coupling *= factor;
  for (std::complex<double>& state : r.field) state *= std::sqrt(factor);
}

RowFactor scale_paths(CouplingClass& c, RowFactor row) {
  for (PathRecord& r : c.records) scale(r, row.mean);
  return row;
}

// Mean factor of the named routes of a row that sums routes; known where all have the same.
RowFactor of_named(CouplingClass const& c, RouteFactor const& factor) {
  double sum = 0, scaled = 0;
  bool same = !c.folded.empty() && c.folded.size() == c.folded_routes;
  for (FoldedRoute const& f : c.folded) {
    same = same && !f.steps.empty() && factor(f.steps) == factor(c.folded.front().steps);
    if (f.steps.empty() || !(f.mean > 0)) continue;
    sum += f.mean;
    scaled += f.mean * factor(f.steps);
  }
  return {sum > 0 ? scaled / sum : factor(c.steps), same ? 0.0 : 1.0};
}

// Scales the kept paths of a row `other`, each as its own route.
RowFactor scale_members(CouplingClass& c, RouteFactor const& factor, RowFactor const& named) {
  Doubles of_member;
  for (MemberRoute const& m : c.members) of_member.push_back(m.steps.empty() ? not_a_number : factor(m.steps));
  double before = 0, after = 0, unknown = 0, least = infinity, most = 0;
  for (PathRecord& r : c.records) {
    double const own = r.member < of_member.size() ? of_member[r.member] : not_a_number;
    double const factor_of_path = std::isnan(own) ? named.mean : own;
    before += r.weight;
    if (std::isnan(own)) unknown += r.weight;
    scale(r, factor_of_path);
    after += r.weight;
    least = std::min(least, factor_of_path);
    most = std::max(most, factor_of_path);
  }
  if (least < most) c.phase_sensitivities.clear();  // moments of another mixture
  return before > 0 ? RowFactor{after / before, unknown / before} : named;
}

RowFactor scale_paths(CouplingClass& c, RouteFactor const& factor) {
  if (!c.steps.empty() && c.folded_routes <= 1) return scale_paths(c, {factor(c.steps), 0});
  RowFactor const named = of_named(c, factor);
  bool const by_path = c.mixes_routes() && !c.members.empty() && named.unknown > 0;
  return by_path ? scale_members(c, factor, named) : scale_paths(c, named);
}

void scale_sums(CouplingClass& c, double factor) {
  c.coupling.mean *= factor;
  c.coupling.std_error *= factor;
  for (double& sum : c.replica_sum) sum *= factor;
  for (PhaseSensitivityProduct& p : c.phase_sensitivities)
    for (double& sum : p.sum) sum *= factor;
}

}  // namespace

BinValues log_ratio(NoiseTrace const& a, NoiseTrace const& b, bool paired, double unresolved) {
  BinValues out;
  if (paired && a.without.size() == b.without.size()) {
    out = of_pair(a, b, half_log);
    for (std::size_t i = 0; i < out.sigma.size(); ++i)
      out.sigma[i] = std::hypot(out.sigma[i], unresolved * std::max(hint(a, i), hint(b, i)));
    return out;
  }
  for (std::size_t i = 0; i < a.asd.size(); ++i) {
    out.value.push_back(half_log(a.psd(i), b.psd(i)));
    out.sigma.push_back(std::hypot(ratio(a.sigma[i], a.asd[i]), ratio(b.sigma[i], b.asd[i])));
  }
  return out;
}

BinValues log_sum(WeightedTotals const& all) {
  std::vector<std::vector<Doubles>> replicas;
  std::size_t most = 0;
  for (auto const& [weight, total] : all) {
    replicas.push_back(replicas_of(*total));
    most = std::max(most, replicas.back().size());
  }
  BinValues out;
  for (std::size_t i = 0; i < all.front().second->asd.size(); ++i) {
    double value = 0;
    Doubles values(most, 0);
    for (std::size_t k = 0; k < all.size(); ++k) {
      auto const& [weight, total] = all[k];
      value += weight * half_log(total->psd(i), 1);
      for (std::size_t r = 0; r < most; ++r)
        values[r] += weight * half_log(replicas[k].empty() ? total->psd(i) : replicas[k][r][i], 1);
    }
    out.value.push_back(value);
    out.sigma.push_back(most == 0 ? 0 : std::sqrt(jackknife_variance(values)));
  }
  return out;
}

BinValues elasticity(NoiseTrace const& derivative, NoiseTrace const& total) {
  BinValues out = of_pair(derivative, total, [](double d, double s) { return 0.5 * ratio(d, s); });
  for (std::size_t i = 0; i < out.sigma.size(); ++i) {
    double const unresolved = 2 * out.value[i] * std::hypot(hint(derivative, i), hint(total, i));
    if (unresolved > 0) out.sigma[i] = std::hypot(out.sigma[i], unresolved);
  }
  return out;
}

BinValues central_elasticity(std::function<NoiseTrace(double factor)> const& total) {
  constexpr double step = 0.05;
  NoiseTrace const traces[] = {total(std::exp(-2 * step)), total(std::exp(-step)), total(std::exp(step)),
                               total(std::exp(2 * step))};
  BinValues near = log_ratio(traces[2], traces[1], true, 2 * step), far = log_ratio(traces[3], traces[0], true, 0);
  for (std::size_t i = 0; i < near.value.size(); ++i) {
    near.value[i] = (8 * near.value[i] - far.value[i]) / (12 * step);
    near.sigma[i] /= 2 * step;
  }
  return near;
}

ScaledCouplings scaled_couplings(CouplingTable const& table, RouteFactor const& factor) {
  ScaledCouplings out{table, {}};
  std::vector<CouplingClass> lit;
  for (CouplingClass& c : out.table.classes) {
    RowFactor const row = scale_paths(c, factor);
    out.unknown.push_back(row.unknown);
    if (row.mean == 0) continue;
    scale_sums(c, row.mean);
    lit.push_back(std::move(c));
  }
  out.table.classes = std::move(lit);
  return out;
}

}  // namespace straytrace::noise
