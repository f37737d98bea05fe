// SPDX-License-Identifier: BSD-3-Clause
// The path table: its numbers and its text.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/text/words.hpp"
#include "noise/classes/motion_classes.hpp"
#include "noise/project/route_noise.hpp"
#include "results/curves/band.hpp"
#include "results/route_table/route_columns.hpp"
#include "results/route_table/route_sums.hpp"

namespace straytrace::results {
namespace {

// The moving bodies, and the mean-square phase in the band, or in total, per unit of kappa of each class.
struct Shaking {
  MotionSet const* motion = nullptr;
  std::vector<MotionClass> classes = {};
  std::vector<double> power = {};
};

Shaking shaking_of(MotionSet const& motion, double low, double high) {
  Shaking s{&motion, group_by_shape(motion), {}};
  bool const all = high <= low;
  for (MotionClass const& c : s.classes) {
    bool const inside = all || (c.tone_frequency >= low && c.tone_frequency <= high);
    s.power.push_back(c.tone_frequency > 0 ? (inside ? c.variance() : 0)
                      : all                ? c.variance()
                                           : c.reference.power(low, high));
  }
  return s;
}

// Sums over paths, weighted by power: rad^2, without motion (rad/m)^2; (rad/m)^2. Weighted by noise: weights;
// (rad/m)^2.
struct BodyPart {
  double strength = 0, lever2 = 0, noise = 0, lever2_of_noise = 0;
};

void add_phase_sensitivity(BodyPart& part, double weight, PhaseSensitivity const& phase_sensitivity,
                           Shaking const* shaking) {
  double const lever2 = phase_sensitivity.d[0] * phase_sensitivity.d[0] +
                        phase_sensitivity.d[1] * phase_sensitivity.d[1] +
                        phase_sensitivity.d[2] * phase_sensitivity.d[2];
  double strength = shaking ? 0 : lever2;
  if (shaking) {
    std::vector<double> const kappa = kappa_of(*shaking->motion, shaking->classes, {&phase_sensitivity, 1});
    for (std::size_t i = 0; i < kappa.size(); ++i) strength += shaking->power[i] * kappa[i];
  }
  double const noise = weight * strength / (shaking ? 1 + strength : 1);  // bounded where fringes wrap
  part.strength += weight * strength;
  part.lever2 += weight * lever2;
  part.noise += noise;
  part.lever2_of_noise += noise * lever2;
}

// The body with the largest phase noise. Without motion, the one with the largest phase sensitivity, named with those
// that are equal to it within 1 %: the phase sees their relative motion.
void find_body(PathRow& row, CouplingClass const& c, std::vector<std::string> const& names, Shaking const* shaking) {
  std::map<std::uint32_t, BodyPart> parts;
  double weights = 0;
  for (PathRecord const& r : c.records) {
    weights += r.weight;
    for (PhaseSensitivity const& phase_sensitivity : r.phase_sensitivities)
      add_phase_sensitivity(parts[phase_sensitivity.body.value], r.weight, phase_sensitivity, shaking);
  }
  double best = 0;
  for (auto const& [body, part] : parts) {
    if (part.strength <= best || body >= names.size()) continue;
    best = part.strength;
    row.body = names[body];
    row.phase_sensitivity = std::sqrt(c.mixes_routes() ? part.lever2_of_noise / part.noise : part.lever2 / weights);
  }
  row.moves = row.body;
  if (shaking || best == 0) return;
  row.moves.clear();
  for (auto const& [body, part] : parts)
    if (body < names.size() && part.strength > 0.98 * best) row.moves += (row.moves.empty() ? "" : ", ") + names[body];
}

void find_lengths(PathRow& row, CouplingClass const& c) {
  row.length_mean = row.length_min = row.length_max = not_a_number;
  if (c.records.empty()) return;
  double weights = 0, sum = 0;
  row.length_min = infinity;
  row.length_max = -infinity;
  for (PathRecord const& r : c.records) {
    weights += r.weight;
    sum += r.weight * r.path_length;
    row.length_min = std::min(row.length_min, r.path_length);
    row.length_max = std::max(row.length_max, r.path_length);
  }
  row.length_mean = weights > 0 ? sum / weights : not_a_number;
}

// Share of each route in the resolved noise power of the band.
void find_shares(std::vector<PathRow>& rows) {
  ReplicaSum total;
  for (PathRow const& row : rows)
    if (row.resolved) total.add({row.power, row.replicas});
  for (PathRow& row : rows)
    if (row.resolved) {
      row.share = ReplicaSum(row.power, row.replicas).share_of(total);
      row.share.at_most = row.upper_bound();
    }
}

// Columns derived from the steps of a route.
void count_steps(PathRow& row, CouplingTable const& table, CouplingClass const& c) {
  std::set<std::uint32_t> met;
  row.vertices = c.steps.size();
  for (std::size_t i = 0; i < c.steps.size(); ++i) {
    char const event = letter(c.steps[i].event);
    met.insert(c.steps[i].group.value);
    row.scatters += event == 'S';
    row.reflections += event == 'R';
    if (i == 0 || i + 1 == c.steps.size()) continue;
    ++row.bounces;
    if (event != 'S') continue;
    std::string const& name = table.groups.at(c.steps[i].group.value);
    if (row.first_scatterer.empty()) row.first_scatterer = name;
    row.last_scatterer = name;
  }
  row.objects = met.size();
}

PathRow row_of(CouplingTable const& table, CouplingClass const& c) {
  PathRow row;
  row.hash = c.hash;
  row.port = c.port.value < table.ports.size() ? table.ports[c.port.value] : "";
  row.sequence = route_name(table, c);
  row.kind = c.kind;
  row.statement = c.statement;
  count_steps(row, table, c);
  row.coupling = c.coupling;
  row.replicas = pattern_of(table, c);
  row.reverse = c.reverse;
  row.by_reverse = c.by_reverse;
  row.resolved = c.coupling.trusted;
  row.why_not = c.coupling.why_not;
  row.share = {not_a_number, not_a_number};
  row.rms_phase = not_a_number;
  row.folded_routes = c.folded_routes;
  row.folded = folded_rows(table, c);
  find_lengths(row, c);
  return row;
}

void add_noise(PathRow& row, NoiseTrace const& trace, FrequencyGrid const& grid, std::vector<double> const& hz) {
  row.resolved = row.resolved && trace.resolved;
  row.faint = !row.resolved && trace.faint;
  if (row.why_not.empty()) row.why_not = trace.why_not;
  row.rms_phase = std::sqrt(trace.mean_square_phase);
  double const mirrors = mirror_error(row.kind, row.coupling);
  for (double const f : hz) {
    WithError seen = strain_at(trace, grid, f);
    if (mirrors > 0) seen.sigma = std::hypot(seen.sigma, mirrors / 2 * seen.value);  // d sqrt(x) = dx/(2 sqrt(x))
    row.strain.push_back(row.resolved ? seen : WithError{not_a_number, not_a_number});
    row.hint.push_back(row.resolved ? not_a_number : seen.value);
    bool const made = row.resolved && !trace.input_low.empty();
    row.input_low.push_back(made ? band_at(trace.input_low, grid, f) : not_a_number);
    row.input_high.push_back(made ? band_at(trace.input_high, grid, f) : not_a_number);
    bool const drawn = row.resolved && !trace.draws_low.empty();
    row.draws_low.push_back(drawn ? band_at(trace.draws_low, grid, f) : not_a_number);
    row.draws_high.push_back(drawn ? band_at(trace.draws_high, grid, f) : not_a_number);
  }
}

bool ranks_before(PathRow const& a, PathRow const& b) {
  if (a.resolved != b.resolved) return a.resolved;
  double const x = std::isnan(a.share.value) ? a.coupling.mean * a.reverse : a.share.value;
  double const y = std::isnan(b.share.value) ? b.coupling.mean * b.reverse : b.share.value;
  return x != y ? x > y : a.hash < b.hash;
}

}  // namespace

bool PathTable::incomplete() const {
  return missing() > 0 ||
         std::any_of(total_strain.begin(), total_strain.end(), [](WithError const& h) { return h.incomplete; });
}

bool PathTable::has_upper_bounds() const {
  auto const bounded = [](WithError const& h) { return h.at_most; };
  return has_noise ? std::any_of(total_strain.begin(), total_strain.end(), bounded) : total_coupling.at_most;
}

void rank_and_sum(PathTable& table, bool shares) {
  if (shares) find_shares(table.rows);
  std::sort(table.rows.begin(), table.rows.end(), ranks_before);
  table.unresolved = table.faint = 0;
  ReplicaSum coupling;
  double bound = 0;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    PathRow& row = table.rows[i];
    row.rank = i + 1;
    table.unresolved += !row.resolved;
    table.faint += row.faint;
    if (!row.resolved) continue;
    if (row.upper_bound()) bound += row.coupling.mean;
    coupling.add({{row.coupling.mean, row.coupling.std_error}, row.replicas});
  }
  WithError sum = coupling.result();
  sum.at_most = bound > std::max(sum.sigma, 1e-3 * sum.value);
  table.total_coupling = sum;
}

std::vector<FoldedRow> folded_rows(CouplingTable const& table, CouplingClass const& c) {
  std::vector<FoldedRow> rows;
  for (FoldedRoute const& f : c.folded)
    rows.push_back({f.hash, folded_name(table, f), {f.mean, f.std_error}, f.trusted, f.why});
  return rows;
}

PathTable unranked_routes(CouplingTable const& coupling) {
  PathTable table;
  table.frequencies.clear();
  for (CouplingClass const& c : coupling.classes) table.rows.push_back(row_of(coupling, c));
  return table;
}

PathTable path_table(CouplingTable const& coupling, NoiseBudget const* budget, MotionSet const* motion,
                     TableSettings const& settings) {
  PathTable table;
  table.has_noise = budget && budget->routes.size() == coupling.classes.size();
  table.reverse_routes = coupling.reverse_routes;
  table.wavelength = coupling.wavelength;
  if (table.has_noise) {
    table.frequencies = settings.frequencies;
    std::tie(table.low, table.high) = band_of(budget->grid, settings.low, settings.high);
    for (double const f : table.frequencies) {
      table.total_strain.push_back(strain_at(budget->total, budget->grid, f));
      table.lines.push_back(line_at(budget->total, budget->grid, f));
    }
  }
  // In the linear regime the motion inside the band causes the noise; where fringes wrap, all of it does.
  Shaking in_band, all;
  if (motion) {
    in_band = shaking_of(*motion, table.low, table.high);
    all = shaking_of(*motion, 0, 0);
  }
  for (std::size_t i = 0; i < coupling.classes.size(); ++i) {
    CouplingClass const& c = coupling.classes[i];
    PathRow row = row_of(coupling, c);
    if (table.has_noise) {
      add_noise(row, budget->routes[i], budget->grid, table.frequencies);
      row.regime = regime(budget->routes[i], budget->grid, table.low, table.high);
      row.power = band_power(budget->routes[i], budget->grid, table.low, table.high);
      row.power.sigma = std::hypot(row.power.sigma, mirror_error(row.kind, row.coupling) * row.power.value);
    }
    find_body(row, c, coupling.bodies, !motion ? nullptr : row.rms_phase < 1 ? &in_band : &all);
    table.rows.push_back(std::move(row));
  }
  rank_and_sum(table, table.has_noise);
  return table;
}

std::string regime(NoiseTrace const& t, FrequencyGrid const& grid, double low, double high) {
  if (!(t.mean_square_phase > 0)) return "-";
  double changed_at = 0;
  int bins = 0, changes = 0;
  bool linear = false;
  for (std::size_t i = 0; i < t.linear_share.size(); ++i) {
    if (grid.centre(i) < low || grid.centre(i) > high || std::isnan(t.linear_share[i])) continue;
    bool const now = t.linear_share[i] >= 0.5;
    if (bins++ > 0 && now != linear) {
      ++changes;
      changed_at = grid.edges[i];
    }
    linear = now;
  }
  if (bins == 0) return t.mean_square_phase > wrapped_from * wrapped_from ? "wrapped" : "linear";
  if (changes == 0) return linear ? "linear" : "wrapped";
  return changes == 1 ? fmt::format("linear {} {:.3g} Hz", linear ? ">" : "<", changed_at) : "mixed";
}

// The path table for terminals and reports.

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
                         ? fmt::format("Routes by share of strain noise power{}, {:g} to {:g} Hz",
                                       table.unresolved > 0 ? " of all resolved routes" : "", table.low, table.high)
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
