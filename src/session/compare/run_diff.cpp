// SPDX-License-Identifier: BSD-3-Clause
#include "session/compare/run_diff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/errors.hpp"
#include "noise/interpolate/spectrum_interpolator.hpp"
#include "results/curves/band.hpp"
#include "results/text/table.hpp"

namespace straytrace::session {
namespace {

constexpr std::array<double, 6> ends{1, 3, 10, 30, 100, 300};  // Hz, between bands
constexpr std::size_t shown = 12;
constexpr double significant = 3;

// Root of the power in the band. The errors of neighbouring bins come from the same paths: they are added as if wholly
// correlated, sigma(h^2) = sum of 2 h sigma df, so that of the rms is never too small.
WithError band_rms(NoiseTrace const& t, FrequencyGrid const& grid, double low, double high) {
  double power = 0, error = 0, bound = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    double const width = std::min(high, grid.edges[i + 1]) - std::max(low, grid.edges[i]);
    if (!(width > 0)) continue;
    power += t.psd(i) * width;
    bound += (t.upper_bound ? 1 : i < t.bound_share.size() ? t.bound_share[i] : 0) * t.asd[i] * t.asd[i] * width;
    error += t.psd_sigma(i) * width;
  }
  double const h = std::sqrt(power), sigma = h > 0 ? error / (2 * h) : 0;
  return {h, sigma, h > 0 && at_most(h, t.resolved ? sigma : 0, bound / power), !t.resolved};
}

bool same_histories(RunFile const& before, RunFile const& after) {
  CouplingTable const &b = before.trace.coupling, &a = after.trace.coupling;
  return before.about.model_hash == after.about.model_hash && b.seed == a.seed && b.histories == a.histories;
}

struct Listed {
  NoiseTrace const* noise;
  CouplingClass const* route;
};

std::string port_of(RunFile const& run, CouplingClass const& c) { return run.trace.coupling.ports.at(c.port.value); }

// The key of a row in both runs: the id of its route, or, in runs whose objects have other numbers, which ids contain,
// its kind, name and place among those of one name; of a row `other` its port and C_rev, since the ids of such rows
// vary in old files.
struct RowKey {
  std::uint64_t hash = 0;
  std::string port{};
  double reverse = 0;
  std::string name{};
  std::size_t place = 0;
  auto operator<=>(RowKey const&) const = default;
};
using ByKey = std::map<RowKey, Listed>;

bool same_numbers(RunFile const& b, RunFile const& a) {
  CouplingTable const &x = b.trace.coupling, &y = a.trace.coupling;
  return x.groups == y.groups && x.ports == y.ports;
}

ByKey by_key(RunFile const& run, bool by_name = false) {
  ByKey out;
  auto const& classes = run.trace.coupling.classes;
  for (std::size_t r = 0; r < run.noise->routes.size() && r < classes.size(); ++r) {
    CouplingClass const& c = classes[r];
    RowKey key = c.steps.empty() ? RowKey{0, port_of(run, c), c.reverse} : RowKey{c.hash};
    if (by_name && !c.steps.empty()) {
      key = {0, port_of(run, c), 0, fmt::format("{} {}", name_of(c.kind), run.noise->routes[r].name)};
      while (out.contains(key)) ++key.place;
    }
    out[key] = {&run.noise->routes[r], &c};
  }
  return out;
}

// The rows of `run` for routes without a row of their own at this port, one for each C_rev.
std::vector<NoiseTrace const*> others_of(RunFile const& run, std::string const& port) {
  std::vector<NoiseTrace const*> rows;
  auto const& classes = run.trace.coupling.classes;
  for (std::size_t r = 0; r < run.noise->routes.size() && r < classes.size(); ++r)
    if (classes[r].steps.empty() && port_of(run, classes[r]) == port) rows.push_back(&run.noise->routes[r]);
  return rows;
}

// Whether this route of `from` is possible in `to`: all its objects exist.
bool exists_in(RunFile const& to, RunFile const& from, CouplingClass const& c) {
  auto const& names = to.trace.coupling.groups;
  return std::all_of(c.steps.begin(), c.steps.end(), [&](PathStep const& s) {
    return std::count(names.begin(), names.end(), from.trace.coupling.groups.at(s.group.value)) > 0;
  });
}

// How far two rms of the same light may differ by their spectra alone: those that paths share are held to `tolerance`
// of the PSD of a path, twice its share of the rms.
double held_change(WithError const& before, WithError const& after, bool common) {
  return common ? SpectrumInterpolator::tolerance / 2 * std::hypot(before.value, after.value) : 0;
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
  Change change{any.name, fmt::format("{:016x}", any.hash), x, y, error_of_change(x, y, d.common), open,
                {},       held_change(x, y, d.common)};
  change.has_before = b;
  change.has_after = a;
  return change;
}

// Rows of one run that are compared together. Their errors may come from the same histories: up to twice the squares.
struct Together {
  double power = 0, variance = 0;  // of the power
  bool open = false, at_most = false;
  void add(NoiseTrace const& t, FrequencyGrid const& grid, RunDifference const& d) {
    WithError const h = band_rms(t, grid, d.low, d.high);
    power += h.value * h.value;
    variance += std::pow(2 * h.value * h.sigma, 2);
    open = open || !t.resolved;
    at_most = at_most || h.at_most;
  }
  WithError rms() const {
    double const h = std::sqrt(power);
    return {h, h > 0 ? std::sqrt(2 * variance) / (2 * h) : 0, at_most, open};
  }
};

// Rows `other` of one port in both runs, with the routes that only one of them lists.
struct Rest {
  Together before, after;
  std::size_t routes = 0;
};

void add_rest(std::map<std::string, Rest>& rests, std::string const& port, NoiseTrace const& only, bool is_before,
              RunFile const& b, RunFile const& a, RunDifference const& d) {
  auto const [at, is_new] = rests.try_emplace(port);
  Rest& rest = at->second;
  if (is_new) {
    for (NoiseTrace const* row : others_of(b, port)) rest.before.add(*row, b.noise->grid, d);
    for (NoiseTrace const* row : others_of(a, port)) rest.after.add(*row, a.noise->grid, d);
  }
  (is_before ? rest.before : rest.after).add(only, (is_before ? b : a).noise->grid, d);
  ++rest.routes;
}

struct ComparedRows {
  RunFile const &b, &a;
  RunDifference const& d;
  std::map<std::string, Rest> rests{};    // by port
  std::vector<Change> named{}, others{};  // routes; rows `other`
};

// The sums of `rests` take the place of their rows in `others`.
void put_rests(std::vector<Change>& others, std::map<std::string, Rest> const& rests, RunFile const& b,
               RunFile const& a) {
  for (auto const& [port, rest] : rests) {
    std::vector<NoiseTrace const*> const first = others_of(b, port);
    NoiseTrace const& row = *(first.empty() ? others_of(a, port) : first).front();
    WithError const before = rest.before.rms(), after = rest.after.rms();
    std::erase_if(others, [&](Change const& c) { return c.what == row.name; });
    others.push_back({fmt::format("{} and {} route{} of one run", row.name, rest.routes, rest.routes == 1 ? "" : "s"),
                      fmt::format("{:016x}", row.hash), before, after, error_of_change(before, after, false),
                      rest.before.open || rest.after.open});
  }
}

// A row that only one of the runs has.
void add_only(Change c, Listed const& one, bool is_before, ComparedRows& to) {
  RunFile const &own = is_before ? to.b : to.a, &other = is_before ? to.a : to.b;
  if (one.route->steps.empty()) {
    to.others.push_back(std::move(c));
    return;
  }
  std::string const port = port_of(own, *one.route);
  auto const rows = others_of(other, port);
  bool const scattered = one.route->kind == ClassKind::scattered;  // rows `other` hold nothing else
  if (scattered && !rows.empty() && exists_in(other, own, *one.route)) {
    c.within = rows.front()->name;
    add_rest(to.rests, port, *one.noise, is_before, to.b, to.a, to.d);
  }
  to.named.push_back(std::move(c));
}

// A computed route of one run and the same in the other, with another kind: an edge that the grid holds in one run
// only.
struct ChangedKind {
  Listed before, after;
};
std::vector<ChangedKind> changed_kinds(RunFile const& b, RunFile const& a, ByKey& x, ByKey& y) {
  std::vector<ChangedKind> found;
  for (auto one = x.begin(); one != x.end();) {
    auto const other = std::ranges::find_if(y, [&](auto const& entry) {
      Listed const &p = one->second, &q = entry.second;
      return p.route->kind != ClassKind::scattered && q.route->kind != ClassKind::scattered &&
             p.route->kind != q.route->kind && p.noise->name == q.noise->name &&
             port_of(b, *p.route) == port_of(a, *q.route) && !y.contains(one->first) && !x.contains(entry.first);
    });
    if (other == y.end()) {
      ++one;
      continue;
    }
    found.push_back({one->second, other->second});
    y.erase(other);
    one = x.erase(one);
  }
  return found;
}

// Rows of ghosts, whose ids name the numbers of objects, or the strongest of several ghosts: in another scene, or where
// another ghost is the strongest, a row has another id. Those of one name are the same; the sums of several ghosts that
// are left at a port are compared together.
std::vector<Change> ghost_changes(RunFile const& b, RunFile const& a, ByKey& x, ByKey& y, auto const& change_of,
                                  RunDifference const& d) {
  std::vector<Change> all;
  struct Sum {
    Together before, after;
    std::uint64_t hash = 0;
    bool has_before = false, has_after = false;
  };
  std::map<std::string, Sum> sums;  // by port
  auto const is_ghost = [](Listed const& l) { return l.route->kind == ClassKind::ghost; };
  for (auto one = x.begin(); one != x.end();) {
    auto const same = std::ranges::find_if(y, [&](auto const& entry) {
      return is_ghost(one->second) && is_ghost(entry.second) && one->second.noise->name == entry.second.noise->name &&
             port_of(b, *one->second.route) == port_of(a, *entry.second.route) && !x.contains(entry.first);
    });
    if (y.contains(one->first) || same == y.end()) {
      ++one;
      continue;
    }
    all.push_back(change_of(one->second.noise, same->second.noise));
    y.erase(same);
    one = x.erase(one);
  }
  auto const take = [&](RunFile const& run, ByKey& rows, ByKey const& other, bool after) {
    std::erase_if(rows, [&](auto const& entry) {
      Listed const& l = entry.second;
      bool const family = l.route->adds_fields();
      if (!is_ghost(l) || family || l.route->folded_routes == 0 || other.contains(entry.first)) return false;
      Sum& sum = sums[port_of(run, *l.route)];
      (after ? sum.after : sum.before).add(*l.noise, run.noise->grid, d);
      (after ? sum.has_after : sum.has_before) = true;
      sum.hash = l.route->hash;
      return true;
    });
  };
  ByKey const first = x;
  take(b, x, y, false);
  take(a, y, first, true);
  for (auto const& [port, sum] : sums) {
    WithError const before = sum.before.rms(), after = sum.after.rms();
    all.push_back({fmt::format("weaker ghosts at {}", port), fmt::format("{:016x}", sum.hash), before, after,
                   error_of_change(before, after, false), sum.before.open || sum.after.open});
    all.back().has_before = sum.has_before;
    all.back().has_after = sum.has_after;
  }
  return all;
}

std::vector<Change> route_changes(RunFile const& b, RunFile const& a, RunDifference const& d) {
  bool const by_name = !same_numbers(b, a);
  ByKey x = by_key(b, by_name), y = by_key(a, by_name);
  ComparedRows to{b, a, d};
  auto const change_of = [&](NoiseTrace const* before, NoiseTrace const* after) {
    return route_change(before, after, b.noise->grid, a.noise->grid, d);
  };
  for (ChangedKind const& c : changed_kinds(b, a, x, y)) {
    Change change = change_of(c.before.noise, c.after.noise);
    change.what += fmt::format(" ({} -> {})", name_of(c.before.route->kind), name_of(c.after.route->kind));
    to.named.push_back(std::move(change));
  }
  for (Change& change : ghost_changes(b, a, x, y, change_of, d)) to.named.push_back(std::move(change));
  for (auto const& [key, one] : x) {
    auto const hit = y.find(key);
    if (hit == y.end())
      add_only(change_of(one.noise, nullptr), one, true, to);
    else
      (one.route->steps.empty() ? to.others : to.named).push_back(change_of(one.noise, hit->second.noise));
  }
  for (auto const& [key, one] : y)
    if (!x.contains(key)) add_only(change_of(nullptr, one.noise), one, false, to);
  put_rests(to.others, to.rests, b, a);
  std::vector<Change> all = std::move(to.named);
  all.insert(all.end(), to.others.begin(), to.others.end());
  auto const change = [](Change const& c) {
    return std::fabs(c.after.value * c.after.value - c.before.value * c.before.value);
  };
  std::stable_sort(all.begin(), all.end(), [&](auto const& p, auto const& q) { return change(p) > change(q); });
  return all;
}

// Of the total in one band, x and y, when both runs are of the same histories.
double common_error(RunFile const& b, RunFile const& a, WithError const& x, WithError const& y, double low,
                    double high) {
  ByKey const after = by_key(a);
  auto const share = [](WithError const& route, WithError const& total) {
    return total.value > 0 ? route.value * route.value / (2 * total.value) : 0;
  };
  double variance = 0;
  for (auto const& [key, one] : by_key(b)) {
    auto const found = after.find(key);
    WithError const p = band_rms(*one.noise, b.noise->grid, low, high),
                    q = found == after.end() ? WithError{} : band_rms(*found->second.noise, a.noise->grid, low, high);
    WithError const& known = p.value > 0 ? p : q;
    if (!(known.value > 0)) continue;
    double const error = (share(q, y) - share(p, x)) * 2 * known.sigma / known.value;
    variance += error * error;
  }
  return std::sqrt(variance);
}

Change band_change(RunFile const& before, RunFile const& after, double low, double high, bool common) {
  NoiseBudget const &b = *before.noise, &a = *after.noise;
  WithError const x = band_rms(b.total, b.grid, low, high), y = band_rms(a.total, a.grid, low, high);
  double const error = common ? common_error(before, after, x, y, low, high) : error_of_change(x, y, false);
  bool const open = !b.total.resolved || !a.total.resolved;
  return {fmt::format("{:g} to {:g} Hz", low, high), "", x, y, error, open, {}, held_change(x, y, common)};
}

std::string line(Change const& c, std::size_t width) {
  double const s = c.sigmas();
  std::string const verdict =
      !c.within.empty()                 ? fmt::format("compared within '{}'", c.within)
      : c.before.value == c.after.value ? "the same"
      : c.too_small()                   ? fmt::format("a change of {:.1e}, less than the error of the spectra, {:.1e}",
                                                      c.after.value - c.before.value, c.held)
      : std::isfinite(s) ? fmt::format("{} sigma{}", std::fabs(s) < 0.05 ? "0.0" : fmt::format("{:+.1f}", s),
                                       std::fabs(s) < significant ? "" : ", significant")
      : c.before.at_most || c.after.at_most ? (c.bound ? "contains upper bounds: speckle may hide the change"
                                                       : "an upper bound: speckle may hide the change")
                                            : "changed, without an error";
  auto const value = [&](WithError const& w, bool there) {
    return w.value > 0 ? with_error(w) : there ? "still" : c.within.empty() ? "none" : "in '" + c.within + "'";
  };
  return fmt::format("  {:<{}}  {} -> {}  {}{}\n", c.what, width, value(c.before, c.has_before),
                     value(c.after, c.has_after), verdict, c.bound ? " (unresolved: more may be missing)" : "");
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
    one["before"] = error_json(c.before);
    one["after"] = error_json(c.after);
    if (!c.within.empty()) one["within"] = c.within;
    one["sigmas"] = std::isfinite(c.sigmas()) ? nlohmann::ordered_json(c.sigmas()) : nlohmann::ordered_json();
    if (c.held > 0) one["spectra_error"] = c.held;
    one["unresolved"] = c.bound;
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace

bool Change::too_small() const { return std::fabs(after.value - before.value) < held; }

double Change::sigmas() const {
  double const change = too_small() ? 0 : after.value - before.value;
  if (!within.empty() || (change != 0 && (before.at_most || after.at_most))) return not_a_number;
  bool const computed = error <= 1e-9 * std::max(before.value, after.value);  // rounding, no Monte-Carlo error
  return !computed ? change / error : change == 0 ? 0 : not_a_number;
}

RunDifference run_differences(RunFile const& before, RunFile const& after) {
  if (!before.noise || !after.noise)
    throw InputError("one of the runs has no noise to compare",
                     "give runs of scenes with an 'interferometer'; for a run without noise use "
                     "'straytrace noise RUN -o DIR'");
  NoiseBudget const &b = *before.noise, &a = *after.noise;
  RunDifference d;
  d.common = same_histories(before, after);
  d.low = std::max(b.grid.edges.front(), a.grid.edges.front());
  d.high = std::min(b.grid.edges.back(), a.grid.edges.back());
  if (!(d.low < d.high))
    throw InputError("the bands of the two runs do not overlap", "project one again with another 'band' in 'noise'");
  std::vector<double> at{d.low};
  for (double const f : ends)
    if (f > d.low && f < d.high) at.push_back(f);
  at.push_back(d.high);
  for (std::size_t i = 0; i + 1 < at.size(); ++i)
    d.bands.push_back(band_change(before, after, at[i], at[i + 1], d.common));
  d.routes = route_changes(before, after, d);
  return d;
}

std::string run_difference_text(RunDifference const& d) {
  return fmt::format(
      "\nrms strain of the total, in bands (one Monte-Carlo standard error of each; {})\n{}"
      "\nrms strain of routes, {:g} to {:g} Hz, largest change first\n{}",
      d.common ? "same histories: sigmas of the change, since both errors are correlated" : "runs taken as independent",
      lines(d.bands, d.bands.size()), d.low, d.high, lines(d.routes, shown));
}

nlohmann::ordered_json run_difference_json(RunDifference const& d) {
  return {{"low_hz", d.low},
          {"high_hz", d.high},
          {"same_histories", d.common},
          {"bands", as_json(d.bands)},
          {"routes", as_json(d.routes)}};
}

}  // namespace straytrace::session
