// SPDX-License-Identifier: BSD-3-Clause
#include "session/compare/change.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "results/text/table.hpp"

namespace straytrace::session {
namespace {

bool every_replica(CouplingTable const& table) {
  return std::ranges::none_of(table.replica_histories, [](auto n) { return n == 0; });
}

// Standard error of w_before P + w_after Q.
double paired(ReplicatedPower const& p, double w_before, ReplicatedPower const& q, double w_after, bool same_light) {
  double variance = 0;
  for (std::size_t r = 0; r < p.off.size(); ++r) variance += std::pow(w_before * p.off[r] + w_after * q.off[r], 2);
  auto const both = [&](double x, double y) { return std::pair(w_before * w_before * x, w_after * w_after * y); };
  auto const [rest_before, rest_after] = both(p.rest, q.rest);
  if (same_light) {
    double const root = std::sqrt(rest_after) - std::sqrt(rest_before);  // weights of opposite signs
    return std::sqrt(variance + root * root);
  }
  auto const [unseen_before, unseen_after] = both(p.unseen, q.unseen);
  return std::sqrt(variance + rest_before + rest_after + std::max(unseen_before, unseen_after));
}

}  // namespace

Histories common_histories(RunFile const& before, RunFile const& after) {
  CouplingTable const &b = before.trace.coupling, &a = after.trace.coupling;
  if (b.seed != a.seed || b.histories != a.histories) return Histories::other;
  if (before.about.model_hash == after.about.model_hash) return Histories::same_light;
  bool const alike = b.block_size == a.block_size && b.replica_histories == a.replica_histories;
  return alike && every_replica(b) ? Histories::same : Histories::other;
}

void ReplicatedPower::add(ReplicatedPower const& o) {
  value += o.value;
  rest += o.rest;
  unseen += o.unseen;
  for (std::size_t r = 0; r < off.size(); ++r) off[r] += o.off[r];
}

void ReplicatedPower::set_error(double sigma) {
  double light = 0;
  for (double const x : off) light += x * x;
  rest = std::max(0.0, sigma * sigma - light);
}

// The mean of n replicas with the deviations d_r of their sums S_r, relative to the sum of all, has the relative
// variance n/(n - 1) sum of d_r^2.
ReplicatedPower replicated(CouplingTable const& table, CouplingClass const& c, double value, double sigma,
                           bool all_of_it) {
  ReplicatedPower p{value, {}, sigma * sigma, std::pow(value * c.coupling.largest_share, 2)};
  double const sum = std::accumulate(c.replica_sum.begin(), c.replica_sum.end(), 0.0);
  if (!(sum > 0) || !every_replica(table)) return p;
  double const all = double(std::accumulate(table.replica_histories.begin(), table.replica_histories.end(), 0ull));
  double variance = 0;
  for (std::size_t r = 0; r < p.off.size(); ++r) {
    double const share = c.replica_sum[r] / sum - double(table.replica_histories[r]) / all;
    p.off[r] = value * share * std::sqrt(double(replica_count) / (replica_count - 1));
    variance += p.off[r] * p.off[r];
  }
  if (all_of_it && variance > 0)
    for (double& x : p.off) x *= sigma / std::sqrt(variance);
  if (!all_of_it || variance > 0) p.rest = all_of_it ? 0 : std::max(0.0, p.rest - variance);
  return p;
}

ErrorOfChange error_of_change(WithError const& before, WithError const& after, ReplicatedPower const& p,
                              ReplicatedPower const& q, Histories common, double exponent) {
  auto const relative = [](WithError const& v) { return v.value > 0 ? v.sigma / v.value : not_a_number; };
  ErrorOfChange const independent{std::hypot(before.sigma, after.sigma), std::hypot(relative(before), relative(after))};
  if (common == Histories::other) return independent;
  bool const same_light = common == Histories::same_light;
  auto const slope = [&](WithError const& v, ReplicatedPower const& of) {
    return of.value > 0 ? exponent * v.value / of.value : 0;
  };
  double const change = paired(p, -slope(before, p), q, slope(after, q), same_light);
  if (!(p.value > 0) || !(q.value > 0)) return {change, not_a_number, true};
  return {change, paired(p, -exponent / p.value, q, exponent / q.value, same_light), true};
}

bool Change::too_small() const { return std::fabs(after.value - before.value) < held; }

double Change::sigmas() const {
  double const change = too_small() ? 0 : after.value - before.value;
  if (!within.empty() || (change != 0 && (before.at_most || after.at_most))) return not_a_number;
  bool const computed = error.change <= 1e-9 * std::max(before.value, after.value);  // rounding, no Monte-Carlo error
  return !computed ? change / error.change : change == 0 ? 0 : not_a_number;
}

WithError Change::ratio() const {
  if (!within.empty() || !(before.value > 0)) return {not_a_number, not_a_number};
  double const ratio = after.value / before.value;
  if (ratio == 1) return {1, error.paired ? 0 : error.ratio, before.at_most || after.at_most, bound};
  double const spectra = held > 0 ? held / std::hypot(before.value, after.value) * std::sqrt(2) : 0;
  return {ratio, ratio > 0 ? ratio * std::hypot(error.ratio, spectra) : after.sigma / before.value,
          before.at_most || after.at_most, bound};
}

std::string value_text(Change const& c, bool after) {
  WithError const& value = after ? c.after : c.before;
  if (value.value > 0) return with_error(value);
  bool const has = after ? c.has_after : c.has_before;
  return has ? c.zero : c.within.empty() ? "none" : "in '" + c.within + "'";
}

std::string ratio_text(Change const& c) {
  WithError const r = c.ratio();
  if (!std::isfinite(r.value)) return "-";
  if (r.at_most) return fmt::format("{:.3g} (of bounds)", r.value);
  return r.sigma > 0 ? with_brackets(r.value, r.sigma) : fmt::format("{:.4g}", r.value);
}

std::string verdict_text(Change const& c) {
  double const s = c.sigmas();
  if (!c.within.empty()) return fmt::format("compared within '{}'", c.within);
  if (c.before.value == c.after.value) return "the same";
  if (c.too_small())
    return fmt::format("a change of {:.1e}, less than the error of the spectra, {:.1e}", c.after.value - c.before.value,
                       c.held);
  if (std::isfinite(s))
    return fmt::format("{} sigma{}", std::fabs(s) < 0.05 ? "0.0" : fmt::format("{:+.1f}", s),
                       std::fabs(s) < significant ? "" : ", significant");
  if (!c.before.at_most && !c.after.at_most) return "changed, without an error";
  return c.bound ? "contains upper bounds: speckle may hide the change" : "an upper bound: speckle may hide the change";
}

std::string outcome_text(Change const& c) {
  if (!c.within.empty()) return fmt::format("in '{}'", c.within);
  double const s = c.sigmas();
  bool const seen = !std::isfinite(s) || std::fabs(s) >= significant;  // computed, or beyond its error
  if (c.bound && !seen) return "not resolved";
  if (!c.has_before) return "new";
  if (!c.has_after) return "vanished";
  if (c.before.value == c.after.value) return c.bound ? "not resolved" : "the same";
  if (c.before.at_most || c.after.at_most) return "upper bound";
  if (!seen) return "no change resolved";
  return std::string(c.after.value > c.before.value ? "grew" : "fell") + (c.bound ? " (lower bound)" : "");
}

nlohmann::ordered_json change_json(Change const& c) {
  using Json = nlohmann::ordered_json;
  Json one{{"what", c.what}};
  if (!c.id.empty()) one["id"] = c.id;
  one["before"] = error_json(c.before);
  one["after"] = error_json(c.after);
  if (!c.within.empty()) one["within"] = c.within;
  WithError const ratio = c.ratio();
  one["ratio"] = std::isfinite(ratio.value) ? error_json(ratio) : Json();
  one["error"] = c.error.paired ? "paired replicas" : "independent";
  one["sigmas"] = std::isfinite(c.sigmas()) ? Json(c.sigmas()) : Json();
  if (c.held > 0) one["spectra_error"] = c.held;
  one["unresolved"] = c.bound;
  return one;
}

}  // namespace straytrace::session
