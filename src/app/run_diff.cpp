// SPDX-License-Identifier: BSD-3-Clause
#include "app/run_diff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/message.hpp"

namespace straytrace {
namespace {

constexpr std::array<double, 6> ends{1, 3, 10, 30, 100, 300};  // Hz, between bands
constexpr std::size_t shown = 12;
constexpr double significant = 3;

// Power in the band. The errors of neighbouring bins come from the same paths: they are added as if wholly correlated,
// sigma(h^2) = sum of 2 h sigma df, so that of the rms is never too small.
WithError band_rms(NoiseTrace const& t, FrequencyGrid const& grid, double low, double high) {
  double power = 0, error = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    double const width = std::min(high, grid.edges[i + 1]) - std::max(low, grid.edges[i]);
    if (!(width > 0)) continue;
    power += t.asd[i] * t.asd[i] * width;
    error += 2 * t.asd[i] * t.sigma[i] * width;
  }
  double const h = std::sqrt(power);
  return {h, h > 0 ? error / (2 * h) : 0};
}

bool same_histories(RunFile const& before, RunFile const& after) {
  CouplingTable const &b = before.trace.coupling, &a = after.trace.coupling;
  return before.about.model_hash == after.about.model_hash && b.seed == a.seed && b.histories == a.histories;
}

using ById = std::map<std::uint64_t, NoiseTrace const*>;

ById by_id(NoiseBudget const& b) {
  ById out;
  for (NoiseTrace const& t : b.routes) out[t.hash] = &t;
  return out;
}

// Error of the change of a route's rms, or of independent values.
double error_of_change(WithError const& before, WithError const& after, bool common) {
  return common ? std::fabs(before.sigma - after.sigma) : std::hypot(before.sigma, after.sigma);
}

Change route_change(NoiseTrace const* b, NoiseTrace const* a, FrequencyGrid const& before, FrequencyGrid const& after,
                    RunDifference const& d) {
  NoiseTrace const& any = b ? *b : *a;
  bool const open = (b && !b->resolved) || (a && !a->resolved);
  WithError const x = b ? band_rms(*b, before, d.low, d.high) : WithError{},
                  y = a ? band_rms(*a, after, d.low, d.high) : WithError{};
  return {any.name, fmt::format("{:016x}", any.hash), x, y, error_of_change(x, y, d.common), open};
}

// Of the total in one band, x and y, when both runs are of the same histories.
double common_error(NoiseBudget const& b, NoiseBudget const& a, WithError const& x, WithError const& y, double low,
                    double high) {
  ById const after = by_id(a);
  auto const share = [](WithError const& route, WithError const& total) {
    return total.value > 0 ? route.value * route.value / (2 * total.value) : 0;
  };
  double variance = 0;
  for (NoiseTrace const& t : b.routes) {
    auto const found = after.find(t.hash);
    WithError const p = band_rms(t, b.grid, low, high),
                    q = found == after.end() ? WithError{} : band_rms(*found->second, a.grid, low, high);
    WithError const& known = p.value > 0 ? p : q;
    if (!(known.value > 0)) continue;
    double const error = (share(q, y) - share(p, x)) * 2 * known.sigma / known.value;
    variance += error * error;
  }
  return std::sqrt(variance);
}

Change band_change(NoiseBudget const& b, NoiseBudget const& a, double low, double high, bool common) {
  WithError const x = band_rms(b.total, b.grid, low, high), y = band_rms(a.total, a.grid, low, high);
  double const error = common ? common_error(b, a, x, y, low, high) : error_of_change(x, y, false);
  return {fmt::format("{:g} to {:g} Hz", low, high), "", x, y, error, !b.total.resolved || !a.total.resolved};
}

std::string line(Change const& c, std::size_t width) {
  double const s = c.sigmas();
  std::string const verdict = c.before.value == c.after.value ? "the same"
                              : std::isfinite(s)
                                  ? fmt::format("{:+.1f} sigma{}", s, std::fabs(s) < significant ? "" : ", significant")
                                  : "changed, without an error";
  auto const value = [](WithError const& w) {
    return w.value > 0 ? with_error(w.value, w.sigma) : std::string("none");
  };
  return fmt::format("  {:<{}}  {} -> {}  {}{}\n", c.what, width, value(c.before), value(c.after), verdict,
                     c.bound ? " (unresolved: a bound or a hint)" : "");
}

std::string lines(std::vector<Change> const& all, std::size_t most) {
  std::size_t width = 0;
  for (std::size_t i = 0; i < std::min(most, all.size()); ++i) width = std::max(width, all[i].what.size());
  std::string text;
  for (std::size_t i = 0; i < std::min(most, all.size()); ++i) text += line(all[i], width);
  if (all.size() > most) text += fmt::format("  and {} more; --format json has all\n", all.size() - most);
  return text;
}

nlohmann::ordered_json as_json(std::vector<Change> const& all) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (Change const& c : all) {
    nlohmann::ordered_json one{{"what", c.what}};
    if (!c.id.empty()) one["id"] = c.id;
    one["before"] = {{"value", c.before.value}, {"sigma", c.before.sigma}};
    one["after"] = {{"value", c.after.value}, {"sigma", c.after.sigma}};
    one["sigmas"] = std::isfinite(c.sigmas()) ? nlohmann::ordered_json(c.sigmas()) : nlohmann::ordered_json();
    one["unresolved"] = c.bound;
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace

double Change::sigmas() const {
  double const change = after.value - before.value;
  return error > 0 ? change / error : change == 0 ? 0 : not_a_number;
}

RunDifference run_differences(RunFile const& before, RunFile const& after) {
  if (!before.noise || !after.noise)
    throw InputError(
        "error: one of the runs has no noise to compare\n  give runs of scenes with an 'interferometer'; "
        "one that was only traced gets its noise by 'straytrace noise RUN -o DIR'");
  NoiseBudget const &b = *before.noise, &a = *after.noise;
  RunDifference d;
  d.common = same_histories(before, after);
  d.low = std::max(b.grid.edges.front(), a.grid.edges.front());
  d.high = std::min(b.grid.edges.back(), a.grid.edges.back());
  if (!(d.low < d.high))
    throw InputError(
        "error: the bands of the two runs do not overlap\n  project one again with another 'band' in 'noise'");
  std::vector<double> at{d.low};
  for (double const f : ends)
    if (f > d.low && f < d.high) at.push_back(f);
  at.push_back(d.high);
  for (std::size_t i = 0; i + 1 < at.size(); ++i) d.bands.push_back(band_change(b, a, at[i], at[i + 1], d.common));
  ById const x = by_id(b), y = by_id(a);
  for (auto const& [id, trace] : x)
    d.routes.push_back(route_change(trace, y.contains(id) ? y.at(id) : nullptr, b.grid, a.grid, d));
  for (auto const& [id, trace] : y)
    if (!x.contains(id)) d.routes.push_back(route_change(nullptr, trace, b.grid, a.grid, d));
  auto const change = [](Change const& c) {
    return std::fabs(c.after.value * c.after.value - c.before.value * c.before.value);
  };
  std::stable_sort(d.routes.begin(), d.routes.end(),
                   [&](auto const& p, auto const& q) { return change(p) > change(q); });
  return d;
}

std::string run_difference_text(RunDifference const& d) {
  return fmt::format(
      "\nrms strain of the total, in bands (one Monte-Carlo standard error of each; {})\n{}"
      "\nrms strain of routes, {:g} to {:g} Hz, largest change first\n{}",
      d.common ? "same histories: sigmas of what changes, since both err alike" : "runs taken as independent",
      lines(d.bands, d.bands.size()), d.low, d.high, lines(d.routes, shown));
}

nlohmann::ordered_json run_difference_json(RunDifference const& d) {
  return {{"low_hz", d.low},
          {"high_hz", d.high},
          {"same_histories", d.common},
          {"bands", as_json(d.bands)},
          {"routes", as_json(d.routes)}};
}

}  // namespace straytrace
