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

namespace straytrace::session {
namespace {

constexpr std::array<double, 6> ends{1, 3, 10, 30, 100, 300};  // Hz, between bands
constexpr std::size_t shown = 12;

// Bins of a grid that overlap a band, each with its width in it, Hz.
struct Overlap {
  std::size_t first = 0;
  std::vector<double> widths;
};
Overlap overlap_of(FrequencyGrid const& grid, double low, double high) {
  auto const begin = std::ranges::upper_bound(grid.edges, low);
  Overlap bins{begin == grid.edges.begin() ? 0 : std::size_t(begin - grid.edges.begin()) - 1, {}};
  for (std::size_t i = bins.first; i < grid.size() && grid.edges[i] < high; ++i)
    bins.widths.push_back(std::max(0.0, std::min(high, grid.edges[i + 1]) - std::max(low, grid.edges[i])));
  return bins;
}

// Root of the power in the band. The errors of neighbouring bins come from the same paths: they are added as if wholly
// correlated, sigma(h^2) = sum of 2 h sigma df, so that of the rms is never too small.
WithError band_rms(NoiseTrace const& t, FrequencyGrid const& grid, double low, double high) {
  double power = 0, error = 0, bound = 0;
  Overlap const bins = overlap_of(grid, low, high);
  for (std::size_t k = 0; k < bins.widths.size(); ++k) {
    std::size_t const i = bins.first + k;
    power += t.psd(i) * bins.widths[k];
    bound += (t.upper_bound ? 1 : i < t.bound_share.size() ? t.bound_share[i] : 0) * t.psd(i) * bins.widths[k];
    error += t.psd_sigma(i) * bins.widths[k];
  }
  double const h = std::sqrt(power), sigma = h > 0 ? error / (2 * h) : 0;
  return {h, sigma, h > 0 && at_most(h, t.resolved ? sigma : 0, bound / power), !t.resolved};
}

struct SharedBand {
  double low = 0, high = 0;  // Hz
};

// Power of a route in the band, with its replicas.
ReplicatedPower power_of(RunFile const& run, std::size_t route, WithError const& rms, Histories common) {
  CouplingTable const& table = run.trace.coupling;
  return replicated(table, table.classes[route], rms.value * rms.value, 2 * rms.value * rms.sigma,
                    common == Histories::same_light);
}

std::size_t routes_of(RunFile const& run) {
  return std::min(run.noise->routes.size(), run.trace.coupling.classes.size());
}

// Of the total. What replicas of the routes leave of the error of its curve is `rest`, except in projections of one
// run.
ReplicatedPower total_power(RunFile const& run, WithError const& total, SharedBand band, Histories common) {
  ReplicatedPower all;
  for (std::size_t r = 0; r < routes_of(run); ++r)
    all.add(power_of(run, r, band_rms(run.noise->routes[r], run.noise->grid, band.low, band.high), common));
  all.value = total.value * total.value;
  if (common == Histories::same_light) return all;
  all.set_error(2 * total.value * total.sigma);
  return all;
}

struct Listed {
  NoiseTrace const* noise;
  CouplingClass const* route;
  std::size_t number;  // of the route in its run
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
  for (std::size_t r = 0; r < routes_of(run); ++r) {
    CouplingClass const& c = classes[r];
    RowKey key = c.steps.empty() ? RowKey{0, port_of(run, c), c.reverse} : RowKey{c.hash};
    if (by_name && !c.steps.empty()) {
      key = {0, port_of(run, c), 0, fmt::format("{} {}", name_of(c.kind), run.noise->routes[r].name)};
      while (out.contains(key)) ++key.place;
    }
    out[key] = {&run.noise->routes[r], &c, r};
  }
  return out;
}

// The rows of `run` for routes without a row of their own at this port, one for each C_rev.
std::vector<Listed> others_of(RunFile const& run, std::string const& port) {
  std::vector<Listed> rows;
  auto const& classes = run.trace.coupling.classes;
  for (std::size_t r = 0; r < routes_of(run); ++r)
    if (classes[r].steps.empty() && port_of(run, classes[r]) == port)
      rows.push_back({&run.noise->routes[r], &classes[r], r});
  return rows;
}

// Whether this route of `from` is possible in `to`: all its objects exist.
bool exists_in(RunFile const& to, RunFile const& from, CouplingClass const& c) {
  auto const& names = to.trace.coupling.groups;
  return std::all_of(c.steps.begin(), c.steps.end(), [&](PathStep const& s) {
    return std::count(names.begin(), names.end(), from.trace.coupling.groups.at(s.group.value)) > 0;
  });
}

// How far two rms of the same histories may differ by their spectra alone: those that paths share are held to
// `tolerance` of the PSD of a path, twice its share of the rms. Of two models it is a part of the error: they share
// different spectra.
void hold(Change& change, Histories common) {
  if (common == Histories::other) return;
  change.held = SpectrumInterpolator::tolerance / 2 * std::hypot(change.before.value, change.after.value);
  if (common == Histories::same && change.error.change > 0)
    change.error.change = std::hypot(change.error.change, change.held);
}

// Two runs in one band.
struct InBand {
  RunFile const &b, &a;
  Histories common = Histories::other;
  SharedBand band;
  RunFile const& of(bool after) const { return after ? a : b; }
  WithError rms(Listed const& row, bool after) const {
    return band_rms(*row.noise, of(after).noise->grid, band.low, band.high);
  }
};

// Rows of one run that are compared together. What their replicas leave of their errors may be correlated: up to twice
// the squares.
struct Together {
  ReplicatedPower power;
  std::size_t rows = 0;
  WithError last = {};
  bool open = false, at_most = false;
  void add(Listed const& row, bool after, InBand const& in) {
    WithError const h = in.rms(row, after);
    power.add(power_of(in.of(after), row.number, h, in.common));
    ++rows;
    last = h;
    open = open || !row.noise->resolved;
    at_most = at_most || h.at_most;
  }
  ReplicatedPower with_correlation() const {
    ReplicatedPower p = power;
    if (rows > 1) p.rest *= 2;
    return p;
  }
  WithError rms() const {
    if (rows == 1) return last;
    ReplicatedPower const p = with_correlation();
    double variance = p.rest;
    for (double const x : p.off) variance += x * x;
    double const h = std::sqrt(p.value);
    return {h, h > 0 ? std::sqrt(variance) / (2 * h) : 0, at_most, open};
  }
};

Change change_of(std::string what, std::uint64_t hash, Together const& before, Together const& after,
                 InBand const& in) {
  WithError const x = before.rms(), y = after.rms();
  Change change{std::move(what),
                fmt::format("{:016x}", hash),
                x,
                y,
                error_of_change(x, y, before.with_correlation(), after.with_correlation(), in.common, 0.5),
                before.open || after.open};
  hold(change, in.common);
  change.has_before = before.rows > 0;
  change.has_after = after.rows > 0;
  return change;
}

// Of one route; null: a run without it.
Change route_change(Listed const* b, Listed const* a, InBand const& in) {
  Together before, after;
  if (b) before.add(*b, false, in);
  if (a) after.add(*a, true, in);
  NoiseTrace const& any = *(b ? b : a)->noise;
  return change_of(any.name, any.hash, before, after, in);
}

// Rows `other` of one port in both runs, with the routes that only one of them lists.
struct Rest {
  Together before, after;
  std::size_t routes = 0;
};

struct ComparedRows {
  InBand const& in;
  std::map<std::string, Rest> rests{};    // by port
  std::vector<Change> named{}, others{};  // routes; rows `other`
};

void add_rest(ComparedRows& to, std::string const& port, Listed const& only, bool after) {
  auto const [at, is_new] = to.rests.try_emplace(port);
  Rest& rest = at->second;
  if (is_new)
    for (bool const of_after : {false, true})
      for (Listed const& row : others_of(to.in.of(of_after), port))
        (of_after ? rest.after : rest.before).add(row, of_after, to.in);
  (after ? rest.after : rest.before).add(only, after, to.in);
  ++rest.routes;
}

// The sums of `rests` take the place of their rows in `others`.
void put_rests(ComparedRows& to) {
  for (auto const& [port, rest] : to.rests) {
    std::vector<Listed> const first = others_of(to.in.b, port);
    NoiseTrace const& row = *(first.empty() ? others_of(to.in.a, port) : first).front().noise;
    std::erase_if(to.others, [&](Change const& c) { return c.what == row.name; });
    to.others.push_back(
        change_of(fmt::format("{} and {} route{} of one run", row.name, rest.routes, rest.routes == 1 ? "" : "s"),
                  row.hash, rest.before, rest.after, to.in));
    to.others.back().has_before = to.others.back().has_after = true;
  }
}

// A row that only one of the runs has.
void add_only(Listed const& one, bool after, ComparedRows& to) {
  Change c = after ? route_change(nullptr, &one, to.in) : route_change(&one, nullptr, to.in);
  RunFile const &own = to.in.of(after), &other = to.in.of(!after);
  if (one.route->steps.empty()) {
    to.others.push_back(std::move(c));
    return;
  }
  std::string const port = port_of(own, *one.route);
  auto const rows = others_of(other, port);
  bool const scattered = one.route->kind == ClassKind::scattered;  // rows `other` hold nothing else
  if (scattered && !rows.empty() && exists_in(other, own, *one.route)) {
    c.within = rows.front().noise->name;
    add_rest(to, port, one, after);
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
std::vector<Change> ghost_changes(ByKey& x, ByKey& y, InBand const& in) {
  std::vector<Change> all;
  struct Sum {
    Together before, after;
    std::uint64_t hash = 0;
  };
  std::map<std::string, Sum> sums;  // by port
  auto const is_ghost = [](Listed const& l) { return l.route->kind == ClassKind::ghost; };
  for (auto one = x.begin(); one != x.end();) {
    auto const same = std::ranges::find_if(y, [&](auto const& entry) {
      return is_ghost(one->second) && is_ghost(entry.second) && one->second.noise->name == entry.second.noise->name &&
             port_of(in.b, *one->second.route) == port_of(in.a, *entry.second.route) && !x.contains(entry.first);
    });
    if (y.contains(one->first) || same == y.end()) {
      ++one;
      continue;
    }
    all.push_back(route_change(&one->second, &same->second, in));
    y.erase(same);
    one = x.erase(one);
  }
  auto const take = [&](ByKey& rows, ByKey const& other, bool after) {
    std::erase_if(rows, [&](auto const& entry) {
      Listed const& l = entry.second;
      bool const family = l.route->adds_fields();
      if (!is_ghost(l) || family || l.route->folded_routes == 0 || other.contains(entry.first)) return false;
      Sum& sum = sums[port_of(in.of(after), *l.route)];
      (after ? sum.after : sum.before).add(l, after, in);
      sum.hash = l.route->hash;
      return true;
    });
  };
  ByKey const first = x;
  take(x, y, false);
  take(y, first, true);
  for (auto const& [port, sum] : sums)
    all.push_back(change_of(fmt::format("weaker ghosts at {}", port), sum.hash, sum.before, sum.after, in));
  return all;
}

std::vector<Change> route_changes(InBand const& in) {
  bool const by_name = !same_numbers(in.b, in.a);
  ByKey x = by_key(in.b, by_name), y = by_key(in.a, by_name);
  ComparedRows to{in};
  for (ChangedKind const& c : changed_kinds(in.b, in.a, x, y)) {
    Change change = route_change(&c.before, &c.after, in);
    change.what += fmt::format(" ({} -> {})", name_of(c.before.route->kind), name_of(c.after.route->kind));
    to.named.push_back(std::move(change));
  }
  for (Change& change : ghost_changes(x, y, in)) to.named.push_back(std::move(change));
  for (auto const& [key, one] : x) {
    auto const hit = y.find(key);
    if (hit == y.end())
      add_only(one, false, to);
    else
      (one.route->steps.empty() ? to.others : to.named).push_back(route_change(&one, &hit->second, in));
  }
  for (auto const& [key, one] : y)
    if (!x.contains(key)) add_only(one, true, to);
  put_rests(to);
  std::vector<Change> all = std::move(to.named);
  all.insert(all.end(), to.others.begin(), to.others.end());
  auto const change = [](Change const& c) {
    return std::fabs(c.after.value * c.after.value - c.before.value * c.before.value);
  };
  std::stable_sort(all.begin(), all.end(), [&](auto const& p, auto const& q) { return change(p) > change(q); });
  return all;
}

Change band_change(InBand const& in) {
  NoiseBudget const &b = *in.b.noise, &a = *in.a.noise;
  SharedBand const band = in.band;
  WithError const x = band_rms(b.total, b.grid, band.low, band.high),
                  y = band_rms(a.total, a.grid, band.low, band.high);
  ReplicatedPower p, q;
  if (in.common != Histories::other) {
    p = total_power(in.b, x, band, in.common);
    q = total_power(in.a, y, band, in.common);
  }
  bool const open = !b.total.resolved || !a.total.resolved;
  Change change{fmt::format("{:g} to {:g} Hz", band.low, band.high), "",  x, y,
                error_of_change(x, y, p, q, in.common, 0.5),         open};
  hold(change, in.common);
  return change;
}

std::string line(Change const& c, std::size_t width) {
  bool const has_ratio = std::isfinite(c.ratio().value) && c.before.value != c.after.value;
  return fmt::format("  {:<{}}  {} -> {}{}  {}{}\n", c.what, width, value_text(c, false), value_text(c, true),
                     has_ratio ? "  x " + ratio_text(c) : "", verdict_text(c),
                     c.bound ? " (unresolved: more may be missing)" : "");
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
  for (Change const& c : all) out.push_back(change_json(c));
  return out;
}

SharedBand common_band(RunFile const& before, RunFile const& after) {
  auto const &b = before.noise->grid.edges, &a = after.noise->grid.edges;
  return {std::max(b.front(), a.front()), std::min(b.back(), a.back())};
}

// Of a receiver in each run: its power and the replicas of the light of its routes.
struct Received {
  WithError power;
  ReplicatedPower light;
  bool resolved = false;
};
Received received(RunFile const& run, std::size_t receiver, bool in_watts, Histories common) {
  CouplingTable const& table = run.trace.coupling;
  Estimate const& e = table.received_power[receiver];
  double const watts = in_watts ? run.about.beam_power : 1;
  Received r{{watts * e.mean, watts * e.std_error, false, !e.trusted}, {}, e.trusted};
  for (CouplingClass const& c : table.received)
    if (c.port.value == receiver)
      r.light.add(
          replicated(table, c, watts * c.coupling.mean, watts * c.coupling.std_error, common == Histories::same_light));
  r.light.value = r.power.value;
  if (common != Histories::same_light) r.light.set_error(r.power.sigma);
  return r;
}

// Receivers of one name; those of only one of the runs last.
std::vector<Change> receiver_changes(RunFile const& before, RunFile const& after, Histories common, bool in_watts) {
  auto const &b = before.trace.coupling.receivers, &a = after.trace.coupling.receivers;
  std::vector<Change> all, alone;
  auto const add = [&](std::string const& name, std::size_t i, std::size_t k) {
    Received const none{{}, {}, true};
    Received const x = i < b.size() ? received(before, i, in_watts, common) : none,
                   y = k < a.size() ? received(after, k, in_watts, common) : none;
    Change c{name,
             "",
             x.power,
             y.power,
             error_of_change(x.power, y.power, x.light, y.light, common, 1),
             !x.resolved || !y.resolved};
    c.has_before = i < b.size();
    c.has_after = k < a.size();
    c.zero = "none seen";
    (c.has_before && c.has_after ? all : alone).push_back(std::move(c));
  };
  for (std::size_t i = 0; i < b.size(); ++i) add(b[i], i, std::size_t(std::ranges::find(a, b[i]) - a.begin()));
  for (std::size_t k = 0; k < a.size(); ++k)
    if (std::ranges::find(b, a[k]) == b.end()) add(a[k], b.size(), k);
  all.insert(all.end(), alone.begin(), alone.end());
  return all;
}

void require_comparable(RunFile const& before, RunFile const& after) {
  if (!before.noise || !after.noise)
    throw InputError("one of the runs has no noise to compare",
                     "give runs of scenes with an 'interferometer'; for a run without noise use "
                     "'straytrace noise RUN -o DIR'");
  if (before.noise->routes.empty() || after.noise->routes.empty())
    throw InputError("in one of the runs no traced light has rejoined a port", "trace more histories");
  if (SharedBand const band = common_band(before, after); !(band.low < band.high))
    throw InputError("the bands of the two runs do not overlap", "project one again with another 'band' in 'noise'");
}

}  // namespace

RunDifference run_differences(RunFile const& before, RunFile const& after) {
  require_comparable(before, after);
  SharedBand const all = common_band(before, after);
  RunDifference d;
  d.common = common_histories(before, after);
  d.low = all.low;
  d.high = all.high;
  std::vector<double> at{d.low};
  for (double const f : ends)
    if (f > d.low && f < d.high) at.push_back(f);
  at.push_back(d.high);
  for (std::size_t i = 0; i + 1 < at.size(); ++i)
    d.bands.push_back(band_change({before, after, d.common, {at[i], at[i + 1]}}));
  d.whole = band_change({before, after, d.common, all});
  d.in_watts = before.about.beam_power > 0 && after.about.beam_power > 0;
  d.receivers = receiver_changes(before, after, d.common, d.in_watts);
  d.routes = route_changes({before, after, d.common, all});
  return d;
}

std::vector<Change> changes_by_frequency(RunFile const& before, RunFile const& after) {
  require_comparable(before, after);
  SharedBand const all = common_band(before, after);
  Histories const common = common_histories(before, after);
  FrequencyGrid const& grid = before.noise->grid;
  std::vector<Change> bins;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    SharedBand const bin{std::max(all.low, grid.edges[i]), std::min(all.high, grid.edges[i + 1])};
    bins.push_back(bin.low < bin.high ? band_change({before, after, common, bin}) : Change{});
  }
  return bins;
}

char const* error_words(Histories common) {
  constexpr char const* words[] = {
      "independent runs: the errors of both add in quadrature",
      "same seed and histories: errors of the change from paired replicas",
      "same histories of one model: errors of the change from paired replicas, as both go up and down with the light"};
  return words[std::size_t(common)];
}

std::string unit_of_receivers(RunDifference const& d) { return d.in_watts ? "W" : "W per W of the main mode"; }

std::string run_difference_text(RunDifference const& d) {
  std::string const receivers = d.receivers.empty() ? ""
                                                    : fmt::format("\npower on receivers [{}]\n{}", unit_of_receivers(d),
                                                                  lines(d.receivers, d.receivers.size()));
  return fmt::format(
      "\nrms strain of the total, in bands (one Monte-Carlo standard error of each; {})\n{}"
      "\nrms strain of routes, {:g} to {:g} Hz, largest change first\n{}{}",
      error_words(d.common), lines(d.bands, d.bands.size()), d.low, d.high, lines(d.routes, shown), receivers);
}

nlohmann::ordered_json run_difference_json(RunDifference const& d) {
  return {{"low_hz", d.low},
          {"high_hz", d.high},
          {"same_histories", d.common != Histories::other},
          {"whole", change_json(d.whole)},
          {"bands", as_json(d.bands)},
          {"routes", as_json(d.routes)},
          {"receivers", as_json(d.receivers)}};
}

}  // namespace straytrace::session
