// SPDX-License-Identifier: BSD-3-Clause
// The path table for terminals and reports.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text/words.hpp"
#include "noise/project/route_noise.hpp"
#include "results/curves/band.hpp"
#include "results/route_table/route_columns.hpp"
#include "results/route_table/route_names.hpp"
#include "results/route_table/route_sums.hpp"

namespace straytrace::results {
namespace {

using Line = std::map<std::string, std::string>;  // cells of a line of sums by the key of their column
using RouteWriter = TableWriter<RouteRow>;

// Sum of resolved rows from `first` on: shares, of `whole`, and couplings add, strains add in power.
Line rest_of(PathTable const& table, std::size_t first, PathTable const& whole, std::string const& title) {
  ReplicaSum power, all_power, coupling;
  double bound_power = 0, bound_coupling = 0;
  std::vector<ReplicaSum> strain(table.frequencies.size());  // h^2, with half its deviations: h dh
  std::vector<double> bound(table.frequencies.size());       // h^2 of upper bounds
  std::size_t count = 0;
  for (PathRow const& row : whole.rows)
    if (row.resolved) all_power.add({row.power, row.replicas});
  for (std::size_t i = first; i < table.rows.size(); ++i) {
    PathRow const& row = table.rows[i];
    if (!row.resolved) continue;
    ++count;
    coupling.add({{row.coupling.mean, row.coupling.std_error}, row.replicas});
    power.add({row.power, row.replicas});
    if (row.upper_bound()) bound_coupling += row.coupling.mean, bound_power += row.power.value;
    for (std::size_t k = 0; k < row.strain.size(); ++k) {
      double const h = row.strain[k].value;
      strain[k].add({{h * h, h * row.strain[k].sigma}, row.replicas});
      if (row.upper_bound()) bound[k] += h * h;
    }
  }
  if (count == 0) return {};
  bool const moves = power.value() > 0;
  WithError share = power.share_of(all_power), sum = coupling.result();
  share.at_most = bound_power > std::max(power.result().sigma, 1e-3 * power.value());
  sum.at_most = bound_coupling > std::max(sum.sigma, 1e-3 * sum.value);
  Line line{{"sequence", counted(count, title + " route")},
            {"share", moves ? percent_text(share) : "still"},
            {"coupling", with_brackets(sum)}};
  for (std::size_t k = 0; k < strain.size(); ++k) {
    double const h = std::sqrt(strain[k].value()), sigma = h > 0 ? strain[k].result().sigma / h : 0;
    bool const most = h > 0 && at_most(h, sigma, bound[k] / strain[k].value());
    line[strain_key(table.frequencies[k])] = std::isnan(h) ? "-" : moves ? with_brackets({h, sigma, most}) : "still";
  }
  return line;
}

// The observed part of unresolved routes is in the total, each with an equal error.
Line hints_of(PathTable const& table) {
  std::vector<double> square(table.frequencies.size()), variance(table.frequencies.size());
  double coupling = 0, coupling_variance = 0;
  for (PathRow const& row : table.rows) {
    if (row.resolved) continue;
    coupling += row.coupling.mean;
    coupling_variance += row.coupling.mean * row.coupling.mean;
    for (std::size_t k = 0; k < row.hint.size(); ++k) {
      double const h2 = std::isnan(row.hint[k]) ? 0 : row.hint[k] * row.hint[k];
      square[k] += h2;
      variance[k] += h2 * h2;
    }
  }
  bool const seen = std::any_of(square.begin(), square.end(), [](double h2) { return h2 > 0; });
  if (!seen || table.unresolved == table.rows.size()) return {};
  Line line{{"sequence", counted(table.unresolved, "unresolved route") + ", observed part"},
            {"share", "-"},
            {"coupling", with_brackets(coupling, std::sqrt(coupling_variance))}};
  for (std::size_t k = 0; k < square.size(); ++k) {
    double const h = std::sqrt(square[k]);
    bool const inside = !std::isnan(table.total_strain[k].value);
    line[strain_key(table.frequencies[k])] = !inside ? "-"
                                             : h > 0 ? with_brackets(h, std::sqrt(variance[k]) / (2 * h))
                                                     : "still";
  }
  return line;
}

void add_total_strain(Line& line, PathTable const& table) {
  for (std::size_t k = 0; k < table.total_strain.size(); ++k) {
    WithError const& h = table.total_strain[k];
    line[strain_key(table.frequencies[k])] = std::isnan(h.value) ? "-" : with_brackets(h);
  }
}

// The last lines: the sum, or that of resolved routes, the observed part of the others, and the total.
std::vector<Line> sums_of(PathTable const& table) {
  bool const nothing = table.unresolved == table.rows.size();
  Line const hints = hints_of(table);
  bool const bound = table.has_upper_bounds();
  std::string const what = table.missing() == 0 ? ""
                           : bound              ? " (" + bound_text(bound, table.missing()) + ")"
                                                : " (lower bound)";
  Line sum;
  if (hints.empty())
    add_total_strain(sum, table);
  else
    sum = rest_of(table, 0, table, "");
  sum["sequence"] = !hints.empty() ? "sum of resolved routes" : what.empty() ? "sum" : "sum of resolved routes" + what;
  sum["share"] = nothing ? "unresolved" : "100";
  sum["coupling"] = nothing ? "unresolved" : with_brackets(table.total_coupling);
  if (hints.empty()) return {sum};
  Line total{{"sequence", "total" + what}};
  add_total_strain(total, table);
  return {sum, hints, total};
}

std::string explanation(PathTable const& table, bool shortened) {
  std::string text = table.has_noise
                         ? fmt::format("Routes by share of strain noise power, {:g} to {:g} Hz", table.low, table.high)
                         : std::string("Routes by coupling");
  text += "; (n): one standard error, last digits.\nEach row is one ordered route";
  text += table.reverse_routes ? "; C_rev, in h but not in coupling, adds its reverse in amplitude.\n"
                               : "; reverse routes are not added in amplitude (C_rev off).\n";
  if (table.has_noise) text += "h: one-sided strain ASD in 1/sqrt(Hz), mean over random static phases.\n";
  auto const mirrored = std::count_if(table.rows.begin(), table.rows.end(), [](auto& row) { return row.by_reverse; });
  if (mirrored > 0)
    text += fmt::format("{} {} taken from the reversed route (reciprocity).\n", mirrored,
                        mirrored == 1 ? "route was" : "routes were");
  if (has_kinds(table))
    text +=
        "Kinds other than scattered are computed, not sampled, without a Monte-Carlo error; their limits are listed "
        "below.\n";
  if (std::ranges::any_of(table.rows, [](auto& row) { return mirror_error(row.kind, row.coupling) > 0; }))
    text += "Kind halo: errors are those of a mean over random mirrors; more histories do not lower them.\n";
  if (std::ranges::any_of(table.rows, &PathRow::upper_bound))
    text +=
        "Kind edge is an upper bound: 'at most'. Shares are those with all bounds reached; without, those of other "
        "kinds "
        "are larger.\n";
  if (table.missing() > 0 && table.has_upper_bounds())
    text += "The total is no bound, 'about': it contains upper bounds, and routes are unresolved.\n";
  if (shortened) text += explanation_of_shortened;
  return text + "\n";
}

constexpr std::size_t folded_shown = 5;

// The range of h over draws of mirrors and edges, of routes that are their mean.
std::string draws_text(PathRow const& row, std::vector<double> const& frequencies) {
  std::string text;
  for (std::size_t i = 0; i < row.draws_low.size(); ++i)
    if (!std::isnan(row.draws_low[i]))
      text += fmt::format("{}{:.3g} to {:.3g} at {:g} Hz", text.empty() ? "" : ", ", row.draws_low[i],
                          row.draws_high[i], frequencies[i]);
  return text.empty() ? text : fmt::format("  {}, h in 90 % of the draws: {}\n", row.sequence, text);
}

// Statements of deterministic routes, each once with its routes; also of rows that are not shown.
std::string statements(PathTable const& table, std::size_t show) {
  constexpr std::size_t named = 4;
  std::vector<std::pair<std::string, std::vector<PathRow const*>>> all;
  for (PathRow const& row : table.rows) {
    if (row.statement.empty()) continue;
    auto at = std::find_if(all.begin(), all.end(), [&](auto const& entry) { return entry.first == row.statement; });
    if (at == all.end()) at = all.insert(at, {row.statement, {}});
    at->second.push_back(&row);
  }
  std::string text;
  for (std::size_t i = 0; i < std::min(show, all.size()); ++i) {
    auto const& [statement, rows] = all[i];
    text += fmt::format("\n{} ", name_of(rows.front()->kind));
    for (std::size_t k = 0; k < std::min(named, rows.size()); ++k)
      text += fmt::format("{}{}", k > 0 ? ", " : "", rows[k]->sequence);
    if (rows.size() > named) text += fmt::format(" and {} more", rows.size() - named);
    text += ":\n  " + statement + "\n";
    for (std::size_t k = 0; k < std::min(named, rows.size()); ++k) text += draws_text(*rows[k], table.frequencies);
  }
  if (all.size() > show) text += "\nand " + counted(all.size() - show, "more statement") + "; --csv has all\n";
  return text;
}

std::string reasons(PathTable const& table) {
  std::string text;
  for (PathRow const& row : table.rows)
    if (!row.resolved)
      text += fmt::format("unresolved{}: {}: {} (hint: coupling about {:.1g})\n",
                          row.faint ? ", too faint to matter" : "", row.sequence, row.why_not, row.coupling.mean);
  for (PathRow const& row : table.rows) text += folded_text(row.sequence, row.folded_routes, row.folded);
  return text.empty() ? text : "\n" + text;
}

}  // namespace

std::string folded_text(std::string const& row, std::size_t routes, std::vector<FoldedRow> const& folded) {
  if (folded.empty()) return {};
  std::size_t const shown = std::min(folded_shown, folded.size());
  std::string text = fmt::format("{} sums {} route{} without a row of {} own", row, routes, routes == 1 ? "" : "s",
                                 routes == 1 ? "its" : "their");
  text += shown < routes ? fmt::format("; the largest {}:\n", shown) : ":\n";
  for (std::size_t i = 0; i < shown; ++i) {
    FoldedRow const& f = folded[i];
    std::string const size =
        f.trusted ? with_brackets(f.coupling.value, f.coupling.sigma) : fmt::format("about {:.1g}", f.coupling.value);
    text += fmt::format("  {}: {}: {}\n", f.sequence, size, f.why);
  }
  return text;
}

std::string path_text(PathTable const& table, std::size_t show) {
  if (table.rows.empty()) return "No route was found: no traced light rejoined a port.\n";
  return path_text(table, show, table);
}

std::string path_text(PathTable const& table, std::size_t show, PathTable const& whole) {
  if (table.rows.empty()) return fmt::format("No route of {} is shown.\n", whole.rows.size());
  RouteWriter const list(route_columns(table));
  Columns columns = list.text_head();
  auto const add_rows = [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) columns.rows.push_back(list.text_row({table, table.rows[i]}));
  };
  auto const add_line = [&](Line const& line) {
    if (!line.empty()) columns.rows.push_back(list.text_cells(line));
  };
  std::size_t const resolved = table.rows.size() - table.unresolved, shown = std::min(show, resolved);
  add_rows(0, shown);
  add_line(rest_of(table, shown, whole, "further"));
  columns.rows.push_back({});
  if (table.rows.size() == whole.rows.size())
    for (Line const& sum : sums_of(table)) add_line(sum);
  else
    add_line(rest_of(table, 0, whole, "shown"));
  add_rows(resolved, std::min(table.rows.size(), resolved + show));
  bool const shortened = shorten_routes(columns);
  return explanation(table, shortened) + aligned(columns) + statements(table, show) + reasons(table);
}

}  // namespace straytrace::results
