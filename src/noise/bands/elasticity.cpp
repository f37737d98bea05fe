// SPDX-License-Identifier: BSD-3-Clause
#include "noise/bands/elasticity.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/math/constants.hpp"
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

namespace {

using SpreadList = std::vector<MaterialSpread>;
using ScatterCounts = std::vector<int>;  // by material

bool is_one_route(CouplingClass const& c) { return !c.steps.empty() && c.folded_routes <= 1; }

// Ghosts only reflect and transmit.
bool never_scatters(MaterialSpread const& m, CouplingClass const& c) {
  return c.kind == ClassKind::ghost && !m.of_reflection;
}

ScatterCounts scatter_counts(SpreadList const& materials, std::vector<PathStep> const& steps) {
  ScatterCounts all;
  for (MaterialSpread const& m : materials) all.push_back(scatters_on(m, steps));
  return all;
}

// Numbers of scatters of the named routes of a class, and the share of their coupling with each; none: no names.
std::map<ScatterCounts, double> named_shares(SpreadList const& materials, CouplingClass const& c) {
  if (!c.steps.empty() && c.folded.empty()) return {{scatter_counts(materials, c.steps), 1.0}};
  std::map<ScatterCounts, double> shares;
  double sum = 0;
  for (FoldedRoute const& f : c.folded) {
    if (f.steps.empty() || !(f.mean > 0)) continue;
    shares[scatter_counts(materials, f.steps)] += f.mean;
    sum += f.mean;
  }
  for (auto& [scatters, share] : shares) share /= sum;
  return shares;
}

std::vector<RowPart> parts_by_coupling(SpreadList const& materials, CouplingClass const& c) {
  std::vector<RowPart> parts;
  for (auto const& [scatters, share] : named_shares(materials, c))
    parts.push_back({scatters, share, {}, !is_one_route(c)});
  if (parts.empty()) parts.push_back({ScatterCounts(materials.size(), 1), 1, {}, true});
  return parts;
}

// The paths of a row `other`, as one class for each combination of numbers of scatters; nothing: of unknown routes.
using DividedRow = std::map<std::optional<ScatterCounts>, CouplingClass>;

DividedRow divided_row(SpreadList const& materials, CouplingClass const& c) {
  std::vector<std::optional<ScatterCounts>> of_member;
  for (MemberRoute const& route : c.members)
    of_member.push_back(route.steps.empty() ? std::nullopt : std::optional(scatter_counts(materials, route.steps)));
  DividedRow all;
  double weights = 0;
  for (PathRecord const& r : c.records) {
    CouplingClass& part = all[r.member < of_member.size() ? of_member[r.member] : std::nullopt];
    part.records.push_back(r);
    part.coupling.mean += r.weight;
    weights += r.weight;
  }
  for (auto& [counts, part] : all) {
    double const share = weights > 0 ? part.coupling.mean / weights : 0;
    part.port = c.port;
    part.reverse = c.reverse;
    part.coupling.mean = share * c.coupling.mean;
    for (std::size_t r = 0; r < part.replica_sum.size(); ++r) part.replica_sum[r] = share * c.replica_sum[r];
  }
  return all;
}

CouplingTable without_classes(CouplingTable const& table) {
  CouplingTable out;
  out.groups = table.groups;
  out.bodies = table.bodies;
  out.ports = table.ports;
  out.replica_histories = table.replica_histories;
  out.histories = table.histories;
  out.block_size = table.block_size;
  out.wavelength = table.wavelength;
  return out;
}

// Shares of the PSD of the parts of one row, per bin: those of known routes, and last the rest, if any, which is
// divided as `named` is. Without noise the shares are those of the light.
std::vector<RowPart> parts_by_noise(std::span<std::optional<ScatterCounts> const> counts,
                                    std::span<CouplingClass const> light, std::span<NoiseTrace const> noise,
                                    std::vector<RowPart> const& named) {
  std::size_t const bins = noise.front().asd.size();
  double power = 0;
  for (CouplingClass const& c : light) power += c.coupling.mean;
  std::vector<RowPart> parts;
  for (std::size_t k = 0; k < noise.size(); ++k) {
    std::vector<double> share(bins);
    for (std::size_t i = 0; i < bins; ++i) {
      double all = 0;
      for (NoiseTrace const& t : noise) all += t.psd(i);
      share[i] = all > 0 ? noise[k].psd(i) / all : light[k].coupling.mean / power;
    }
    if (counts[k])
      parts.push_back({*counts[k], 1, std::move(share), false});
    else
      for (RowPart const& part : named) parts.push_back({part.scatters, part.share, share, true});
  }
  return parts;
}

}  // namespace

int scatters_on(MaterialSpread const& m, std::vector<PathStep> const& steps) {
  auto const counts = [&](PathStep const& s) {
    bool const scatters = letter(s.event) == 'S';
    return (m.of_reflection ? s.event == Event::reflect : scatters) &&
           std::binary_search(m.groups.begin(), m.groups.end(), s.group);
  };
  return int(std::ranges::count_if(steps, counts));
}

double coupling_factor(MaterialSpread const& m, CouplingClass const& c, double ratio) {
  double sum = 0;
  for (RowPart const& part : parts_by_coupling({m}, c)) sum += part.share * std::pow(ratio, part.scatters.front());
  return sum;
}

bool composition_known(MaterialSpread const& m, CouplingClass const& c) {
  if (is_one_route(c) || never_scatters(m, c)) return true;
  if (c.folded.empty() || c.folded.size() != c.folded_routes) return false;
  int const first = scatters_on(m, c.folded.front().steps);
  return std::ranges::all_of(
      c.folded, [&](FoldedRoute const& f) { return !f.steps.empty() && scatters_on(m, f.steps) == first; });
}

Composition::Composition(CouplingTable const& table, SpreadList materials, MotionSet const& motion,
                         Interferometer const& ifo, NoiseSettings const& settings)
    : materials_(std::move(materials)) {
  CouplingTable rows = without_classes(table);
  std::vector<std::optional<ScatterCounts>> counts;      // of each class in `rows`
  std::vector<std::pair<std::size_t, std::size_t>> row;  // route, number of its parts
  for (std::size_t r = 0; r < table.classes.size(); ++r) {
    CouplingClass const& c = table.classes[r];
    parts_.push_back(parts_by_coupling(materials_, c));
    std::vector<bool>& known = known_.emplace_back();
    for (MaterialSpread const& m : materials_) known.push_back(composition_known(m, c));
    bool const by_noise = c.mixes_routes() && !c.members.empty() && c.coupling.mean > 0 && !c.records.empty();
    if (!by_noise || std::ranges::find(known, false) == known.end()) continue;
    DividedRow divided = divided_row(materials_, c);
    row.emplace_back(r, divided.size());
    for (auto& [of_part, part] : divided) {
      counts.push_back(of_part);
      rows.classes.push_back(std::move(part));
    }
  }
  if (rows.classes.empty()) return;
  NoiseBudget const budget = project_noise(rows, motion, ifo, settings);
  std::size_t first = 0;
  for (auto const& [r, n] : row) {
    parts_[r] = parts_by_noise(std::span(counts).subspan(first, n), std::span(rows.classes).subspan(first, n),
                               std::span(budget.routes).subspan(first, n), parts_[r]);
    first += n;
  }
}

double Composition::factor(std::size_t route, std::size_t bin, std::span<double const> ratio) const {
  double sum = 0;
  for (RowPart const& part : parts_[route]) {
    double factor = part.at(bin);
    for (std::size_t m = 0; m < ratio.size(); ++m) factor *= std::pow(ratio[m], part.scatters[m]);
    sum += factor;
  }
  return sum;
}

double Composition::factor(std::size_t route, std::size_t bin, std::size_t material, double ratio) const {
  double sum = 0;
  for (RowPart const& part : parts_[route]) sum += part.at(bin) * std::pow(ratio, part.scatters[material]);
  return sum;
}

double Composition::unknown(std::size_t route, std::size_t bin, std::size_t material) const {
  if (known_[route][material]) return 0;
  double sum = 0;
  for (RowPart const& part : parts_[route]) sum += part.by_coupling ? part.at(bin) : 0;
  return sum;
}

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
