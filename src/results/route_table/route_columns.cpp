// SPDX-License-Identifier: BSD-3-Clause
#include "results/route_table/route_columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "base/units/quantity.hpp"
#include "results/curves/band.hpp"
#include "results/text/columns.hpp"

namespace straytrace::results {
namespace {

using Steps = std::vector<std::string>;
constexpr char const* between_steps = " > ";

Steps steps_of(std::string const& name) {
  Steps steps;
  for (std::size_t at = 0; at <= name.size();) {
    std::size_t const end = std::min(name.find(between_steps, at), name.size());
    steps.push_back(name.substr(at, end - at));
    at = end + std::char_traits<char>::length(between_steps);
  }
  return steps;
}

// The kept steps, with one "…" for each gap between them.
std::string text_of_steps(Steps const& steps, std::vector<bool> const& kept) {
  std::string text;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!kept[i] && !kept[i - 1]) continue;
    text += (i > 0 ? between_steps : "") + (kept[i] ? steps[i] : "…");
  }
  return text;
}

// Both ends, and the steps of `order` while they fit.
std::string fitted(Steps const& steps, std::vector<std::size_t> const& order, std::size_t width) {
  std::vector<bool> kept(steps.size());
  kept.front() = kept.back() = true;
  for (std::size_t const i : order) {
    kept[i] = true;
    if (width_of(text_of_steps(steps, kept)) <= width) continue;
    kept[i] = false;
    break;
  }
  return text_of_steps(steps, kept);
}

// Inner steps from both ends towards the middle.
std::vector<std::size_t> from_ends(std::size_t count) {
  std::vector<std::size_t> order;
  for (std::size_t i = 1; 2 * i < count; ++i) {
    order.push_back(i);
    if (count - 1 - i > i) order.push_back(count - 1 - i);
  }
  return order;
}

// Inner steps from `first` on, then those before it.
std::vector<std::size_t> from_step(std::size_t count, std::size_t first) {
  std::vector<std::size_t> order;
  for (std::size_t i = first; i + 1 < count; ++i) order.push_back(i);
  for (std::size_t i = first - 1; i > 0; --i) order.push_back(i);
  return order;
}

// The first form that no other name has; where all are taken, the usual one.
std::string form_unlike(std::set<std::string> const& taken, Steps const& steps, std::size_t width) {
  std::string const usual = fitted(steps, from_ends(steps.size()), width);
  std::string form = usual;
  for (std::size_t first = 1; taken.contains(form) && first + 1 < steps.size(); ++first)
    form = fitted(steps, from_step(steps.size(), first), width);
  return taken.contains(form) ? usual : form;
}

}  // namespace

std::vector<std::string> shortened_routes(std::vector<std::string> const& names, std::size_t width) {
  std::vector<std::string> all = names;
  std::map<std::string, std::string> short_of;
  std::set<std::string> taken;
  for (std::string& name : all) {
    if (width_of(name) <= width) continue;
    auto const [form, is_new] = short_of.try_emplace(name);
    if (is_new) form->second = form_unlike(taken, steps_of(name), width);
    name = form->second;
    taken.insert(name);
  }
  return all;
}

bool shorten_routes(Columns& columns) {
  constexpr std::size_t widest = 72;  // characters
  std::size_t const at = std::size_t(std::ranges::find(columns.titles, "route") - columns.titles.begin());
  std::vector<std::string> names;
  for (auto const& row : columns.rows) names.push_back(row.empty() ? "" : row[at]);
  std::vector<std::string> const shorter = shortened_routes(names, widest);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!columns.rows[i].empty()) columns.rows[i][at] = shorter[i];
  return shorter != names;
}

namespace {

using RouteList = std::vector<TableColumn<RouteRow>>;
using Json = nlohmann::ordered_json;

constexpr char const* unresolved = "unresolved";
constexpr char const* still = "still";
constexpr char const* strain_unit = "1/√Hz";

// A route without moving surfaces and with steady light causes exactly no noise.
bool moves(PathRow const& row) {
  auto const any = [](WithError const& h) { return h.value > 0; };
  return !row.resolved || row.rms_phase > 0 || row.power.value > 0 || std::ranges::any_of(row.strain, any);
}

std::string share_text(PathRow const& row) {
  if (!row.resolved) return unresolved;
  if (!moves(row)) return still;
  return percent_text(row.share);
}

std::string strain_text(PathRow const& row, WithError const& h) {
  return std::isnan(h.value) ? "-" : moves(row) ? with_brackets(h) : still;
}

Json strain_json(PathTable const& table, PathRow const& row) {
  Json all = Json::array();
  for (std::size_t i = 0; i < row.strain.size(); ++i) {
    Json h = error_json(row.strain[i]);
    h["frequency_Hz"] = table.frequencies[i];
    if (!std::isnan(row.input_low[i])) h["input"] = {row.input_low[i], row.input_high[i]};
    if (!std::isnan(row.draws_low[i])) h["draws"] = {row.draws_low[i], row.draws_high[i]};
    all.push_back(h);
  }
  return all;
}

Json folded_json(std::vector<FoldedRow> const& rows) {
  Json all = Json::array();
  for (FoldedRow const& f : rows)
    all.push_back({{"id", hash_text(f.hash)},
                   {"sequence", f.sequence},
                   {"coupling", f.trusted ? error_json(f.coupling) : Json(nullptr)},
                   {"coupling_hint", f.coupling.value},
                   {"why", f.why}});
  return all;
}

// An entry that a row has only under a condition.
Json only_if(bool there, Json entry) { return there ? std::move(entry) : Json(Json::value_t::discarded); }

// A row `other` sums routes that differ in their steps.
TableCell of_route(PathRow const& row, std::size_t count) {
  return row.vertices > 0 ? TableCell(std::uint64_t{count}) : TableCell(not_a_number);
}

std::string strain_title(double hz) { return fmt::format("h({:g} Hz)", hz); }

// A column fills a few lines, which the formatter would make a dozen.
// clang-format off

void add_names(RouteList& all) {
  all.push_back({.key = "rank", .kind = ColumnKind::count, .title = "rank",
    .help = "1 = largest share of the strain noise",
    .value = [](RouteRow const& r) { return std::uint64_t{r.row.rank}; },
    .text = {10, "#"}, .csv = {10}, .json = {10}, .page = {10}, .shown_first = true});
  all.push_back({.key = "sequence", .kind = ColumnKind::text, .title = "route",
    .help = "R reflect, T transmit, S scatter, E edge",
    .value = [](RouteRow const& r) { return r.row.sequence; },
    .text = {20, "route"}, .csv = {40}, .json = {40}, .page = {20}, .file = {10, "name"}, .left = true,
    .shown_first = true});
  all.push_back({.key = "port", .kind = ColumnKind::text, .title = "port", .help = "where the light rejoins the mode",
    .value = [](RouteRow const& r) { return r.row.port; },
    .text = {30}, .csv = {30}, .json = {30}, .page = {30}, .left = true, .shown_first = true});
  all.push_back({.key = "id", .kind = ColumnKind::text, .title = "id",
    .help = "identifier of the route, the same in all runs of one model",
    .value = [](RouteRow const& r) { return hash_text(r.row.hash); },
    .csv = {20}, .json = {20}, .page = {270}});
  all.push_back({.key = "vertices", .kind = ColumnKind::count, .help = "of the route; 0 for rows that sum routes",
    .value = [](RouteRow const& r) { return std::uint64_t{r.row.vertices}; },
    .csv = {50}, .json = {70}});
  all.push_back({.key = "sampled_on", .kind = ColumnKind::text,
    .help = "itself, or reverse: taken from the reversed route",
    .value = [](RouteRow const& r) { return std::string(r.row.by_reverse ? "reverse" : "itself"); },
    .csv = {220}, .json = {130}});
  all.push_back({.key = "statement", .kind = ColumnKind::text,
    .help = "of computed routes: meaning of the number and its validity",
    .value = [](RouteRow const& r) { return r.row.statement; },
    .csv = {240}, .json = {60},
    .as_json = [](RouteRow const& r) { return only_if(!r.row.statement.empty(), r.row.statement); }});
  all.push_back({.key = "folded_routes", .kind = ColumnKind::count, .help = "number of routes in a row that sums several",
    .value = [](RouteRow const& r) { return std::uint64_t{r.row.folded_routes}; }, .json = {240},
    .as_json = [](RouteRow const& r) { return only_if(r.row.folded_routes > 0, r.row.folded_routes); }});
  all.push_back({.key = "folded", .kind = ColumnKind::list, .help = "the largest of these routes", .json = {250},
    .as_json = [](RouteRow const& r) { return only_if(r.row.folded_routes > 0, folded_json(r.row.folded)); }});
}

void add_kind(RouteList& all, bool kinds) {
  all.push_back({.key = "kind", .kind = ColumnKind::text, .title = "kind",
    .help = "scattered, ghost, edge, wave or speckle",
    .value = [](RouteRow const& r) { return std::string(name_of(r.row.kind)); },
    .text = {kinds ? 40 : 0}, .csv = {230}, .json = {50}, .page = {40}, .left = true});
  all.push_back({.key = "bound", .kind = ColumnKind::text, .help = "upper: coupling and h are upper bounds",
    .value = [](RouteRow const& r) { return std::string(r.row.upper_bound() ? "upper" : ""); },
    .csv = {260}});
  all.push_back({.key = "scatters", .kind = ColumnKind::count, .title = "scatters",
    .help = "diffuse events, those on lit optics included",
    .value = [](RouteRow const& r) { return of_route(r.row, r.row.scatters); }, .page = {60}});
  all.push_back({.key = "bounces", .kind = ColumnKind::count, .title = "bounces",
    .help = "surfaces between the first and the last",
    .value = [](RouteRow const& r) { return of_route(r.row, r.row.bounces); }, .page = {70}});
  all.push_back({.key = "order", .kind = ColumnKind::count, .title = "ghost order",
    .help = "reflections on the route of a ghost",
    .value = [](RouteRow const& r) {
    return r.row.kind == ClassKind::ghost ? of_route(r.row, r.row.reflections) : TableCell(not_a_number);
    },
    .page = {80}});
  all.push_back({.key = "objects", .kind = ColumnKind::count, .title = "objects",
    .help = "different objects on the route",
    .value = [](RouteRow const& r) { return of_route(r.row, r.row.objects); }, .page = {90}});
  all.push_back({.key = "via", .kind = ColumnKind::text, .title = "objects met",
    .help = "names of the objects on the route; of ghosts whose fields add, on all of their routes",
    .value = [](RouteRow const& r) { return fmt::format("{}", fmt::join(objects_met(r.row), between_objects)); },
    .page = {95}, .left = true});
  all.push_back({.key = "first", .kind = ColumnKind::text, .title = "first scatterer", .help = "between start and end",
    .value = [](RouteRow const& r) { return r.row.first_scatterer; }, .page = {100}});
  all.push_back({.key = "last", .kind = ColumnKind::text, .title = "last scatterer", .help = "between start and end",
    .value = [](RouteRow const& r) { return r.row.last_scatterer; }, .page = {110}});
}

void add_strain(RouteList& all, std::size_t i, double hz) {
  std::string const at = fmt::format("h_{:g}Hz", hz);
  all.push_back({.key = strain_key(hz), .kind = ColumnKind::estimate, .title = strain_title(hz), .unit = strain_unit,
    .help = "one-sided strain ASD, mean over random static phases",
    .value = [i](RouteRow const& r) { return r.row.strain[i]; },
    .text = {80, strain_title(hz)}, .csv = {100, at}, .page = {120}, .shown_first = true,
    .as_text = [i](RouteRow const& r) { return strain_text(r.row, r.row.strain[i]); }});
  all.push_back({.key = strain_key(hz) + "_input_low", .unit = strain_unit, .help = "h at the low end of the stated inputs",
    .value = [i](RouteRow const& r) { return r.row.input_low[i]; }, .csv = {250, at + "_input_low"}});
  all.push_back({.key = strain_key(hz) + "_input_high", .unit = strain_unit,
    .help = "h at the high end of the stated inputs",
    .value = [i](RouteRow const& r) { return r.row.input_high[i]; }, .csv = {250, at + "_input_high"}});
  all.push_back({.key = strain_key(hz) + "_draws_low", .unit = strain_unit,
    .help = "h that 5 % of the draws of mirrors and edges lie below, of kind wave",
    .value = [i](RouteRow const& r) { return r.row.draws_low[i]; }, .csv = {255, at + "_draws_low"}});
  all.push_back({.key = strain_key(hz) + "_draws_high", .unit = strain_unit,
    .help = "h that 95 % of the draws of mirrors and edges lie below, of kind wave",
    .value = [i](RouteRow const& r) { return r.row.draws_high[i]; }, .csv = {255, at + "_draws_high"}});
}

void add_noise_columns(RouteList& all, bool has_noise) {
  all.push_back({.key = "share", .kind = ColumnKind::estimate, .title = "share", .unit = "1",
    .help = "of the resolved strain noise power in the band", .value = [](RouteRow const& r) { return r.row.share; },
    .text = {has_noise ? 50 : 0, "share/%"}, .csv = {110, "share_percent", 100}, .json = {150},
    .page = {50, "", 100}, .page_unit = "%", .shown_first = true,
    .as_text = [](RouteRow const& r) { return share_text(r.row); }});
  all.push_back({.key = "strain", .kind = ColumnKind::list, .unit = strain_unit,
    .help = "one-sided strain ASD at each frequency", .json = {140},
    .as_json = [](RouteRow const& r) { return strain_json(r.table, r.row); }});
  all.push_back({.key = "without", .title = "without it", .unit = "1",
    .help = "change of the total strain if this route were absent",
    .value = [](RouteRow const& r) {
    double const s = r.row.share.value;
    return s > 0 ? std::sqrt(std::max(0.0, 1 - s)) - 1 : not_a_number;
    },
    .page = {130, "", 100}, .page_unit = "%"});
  all.push_back({.key = "rms_phase", .title = "rms phase", .unit = "rad", .help = "above 1 fringes wrap",
    .value = [](RouteRow const& r) { return r.row.rms_phase; },
    .text = {110, "phase/rad"}, .csv = {140, "rms_phase_rad"}, .json = {180, "rms_phase_rad"}, .page = {180},
    .format = "{:.2g}"});
  all.push_back({.key = "regime", .kind = ColumnKind::text, .title = "regime", .help = "linear, or wrapped fringes",
    .value = [](RouteRow const& r) { return r.row.regime; },
    .text = {120}, .csv = {150}, .json = {190}, .page = {190}, .shown_first = true});
  all.push_back({.key = "moves", .kind = ColumnKind::text,
    .help = "the moving body; without motion all bodies of nearly the largest phase sensitivity",
    .value = [](RouteRow const& r) { return r.row.moves; }, .text = {90}, .left = true});
  all.push_back({.key = "body", .kind = ColumnKind::text, .title = "moving body",
    .help = "whose motion contributes most",
    .value = [](RouteRow const& r) { return r.row.body; },
    .csv = {120, "moving_body"}, .json = {160, "moving_body"}, .page = {160}, .shown_first = true});
  all.push_back({.key = "phase_sensitivity", .title = "phase sensitivity", .unit = "rad/m",
    .help = "phase per displacement of that body, rms over paths, of rows 'other' weighted by noise",
    .value = [](RouteRow const& r) { return r.row.sensitivity(); },
    .text = {100, "sensitivity/(rad/m)"}, .csv = {130, "phase_sensitivity_rad_per_m"},
    .json = {170, "phase_sensitivity_rad_per_m"}, .page = {170}, .shown_first = !has_noise});
  all.push_back({.key = "fringes", .title = "fringe multiplicity", .unit = "2v/λ",
    .help = "fringe rate over that of a single retro-reflection",
    .value = [](RouteRow const& r) { return r.row.sensitivity() * r.table.wavelength / (4 * pi); }, .page = {200}});
}

void add_light(RouteList& all) {
  all.push_back({.key = "coupling", .kind = ColumnKind::estimate, .title = "coupling", .unit = "1",
    .help = "recoupled power fraction of ordered paths",
    .value = [](RouteRow const& r) {
    return r.row.resolved ? r.row.coupling_with_error() : WithError{not_a_number, not_a_number};
    },
    .text = {60}, .csv = {60}, .json = {100}, .page = {140}, .shown_first = true,
    .as_text = [](RouteRow const& r) {
    return r.row.resolved ? with_brackets(r.row.coupling_with_error()) : unresolved;
    },
    .as_json = [](RouteRow const& r) {
    return r.row.resolved ? error_json(r.row.coupling_with_error()) : Json(nullptr);
    }});
  all.push_back({.key = "hint", .unit = "1", .help = "the coupling, also where it is not reliable",
    .value = [](RouteRow const& r) { return r.row.coupling.mean; },
    .csv = {70, "coupling_hint"}, .json = {110, "coupling_hint"}});
  all.push_back({.key = "C_rev", .unit = "1", .help = "factor of the reversed route, not in the coupling",
    .value = [](RouteRow const& r) { return r.row.reverse; }, .text = {70}, .csv = {90}, .json = {120},
    .format = "{:g}"});
  all.push_back({.key = "status", .kind = ColumnKind::text, .title = "status", .help = "resolved, or why not",
    .value = [](RouteRow const& r) { return r.row.resolved ? "resolved" : "unresolved: " + r.row.why_not; },
    .csv = {80}, .page = {150}});
  all.push_back({.key = "resolved", .kind = ColumnKind::flag, .help = "whether the coupling is reliable",
    .value = [](RouteRow const& r) { return r.row.resolved; }, .json = {80}});
  all.push_back({.key = "why_not", .kind = ColumnKind::text, .help = "why it is not resolved",
    .value = [](RouteRow const& r) { return r.row.why_not; }, .json = {90}});
  all.push_back({.key = "histories", .kind = ColumnKind::count, .title = "histories", .help = "that have scored",
    .value = [](RouteRow const& r) { return r.row.coupling.scored; },
    .csv = {190, "histories_scored"}, .json = {210, "histories_scored"}, .page = {250}});
  all.push_back({.key = "largest", .title = "largest history", .unit = "1", .help = "share of the largest single one",
    .value = [](RouteRow const& r) { return r.row.coupling.largest_share; },
    .csv = {200, "largest_history_share"}, .json = {220, "largest_history_share"}, .page = {260, "", 100},
    .page_unit = "%"});
  all.push_back({.key = "effective_scores", .unit = "1", .help = "effective sample size",
    .value = [](RouteRow const& r) { return r.row.coupling.effective_scores; }, .csv = {210}, .json = {230}});
}

void add_lengths(RouteList& all) {
  all.push_back({.key = "opl", .title = "optical path", .unit = "m", .help = "mean over its paths",
    .value = [](RouteRow const& r) { return r.row.length_mean; },
    .text = {130, "length/m"}, .csv = {160, "path_mean_m"}, .json = {200, "path_length_m/mean"}, .page = {210},
    .format = "{:.6g}", .shown_first = true});
  all.push_back({.key = "opl_min", .title = "shortest", .unit = "m", .help = "of the kept paths",
    .value = [](RouteRow const& r) { return r.row.length_min; },
    .csv = {170, "path_min_m"}, .json = {200, "path_length_m/min"}, .page = {220}});
  all.push_back({.key = "opl_max", .title = "longest", .unit = "m", .help = "of the kept paths",
    .value = [](RouteRow const& r) { return r.row.length_max; },
    .csv = {180, "path_max_m"}, .json = {200, "path_length_m/max"}, .page = {230}});
  all.push_back({.key = "delay", .title = "delay", .unit = "s", .help = "light time along the mean optical path",
    .value = [](RouteRow const& r) { return r.row.length_mean / speed_of_light; }, .page = {240}});
}

// clang-format on

}  // namespace

bool has_kinds(PathTable const& table) {
  return std::any_of(table.rows.begin(), table.rows.end(),
                     [](PathRow const& row) { return row.kind != ClassKind::scattered; });
}

std::string strain_key(double hz) { return fmt::format("h{:g}", hz); }

std::vector<TableColumn<RouteRow>> route_columns(PathTable const& table) {
  RouteList all;
  add_names(all);
  add_kind(all, has_kinds(table));
  for (std::size_t i = 0; i < table.frequencies.size(); ++i) add_strain(all, i, table.frequencies[i]);
  add_noise_columns(all, table.has_noise);
  add_light(all);
  add_lengths(all);
  return all;
}

namespace {

// Units are those of the scene language; a plain number suffices for pure ratios, counts and h.
void add_units(RouteColumn& c) {
  std::string names;
  if (c.unit == "m") names = accepted_units(dim::length);
  if (c.unit == "s") names = accepted_units(dim::time);
  if (c.unit == "rad") names = accepted_units(dim::angle);
  if (c.unit == "rad/m") names = "rad/m, rad/mm, rad/um";
  if (c.unit == "%" || c.unit == "1") names = "%, ppm, ppb";
  for (std::size_t at = 0; at < names.size();) {
    std::size_t const end = std::min(names.find(", ", at), names.size());
    std::string const name = names.substr(at, end - at);
    if (auto const unit = parse_unit(name)) c.units.emplace_back(name, unit->si * (c.unit == "%" ? 100 : 1));
    at = end + 2;
  }
  c.needs_unit = !c.units.empty() && c.unit != "1";
  if (c.unit == strain_unit) c.units = {{"/sqrt(Hz)", 1.0}};
}

double finite_or_nan(double x) { return std::isfinite(x) ? x : not_a_number; }

double number_in(TableCell const& cell) {
  if (auto const* const n = std::get_if<std::uint64_t>(&cell)) return double(*n);
  if (auto const* const e = std::get_if<WithError>(&cell)) return e->value;
  return std::get<double>(cell);
}

// A column on pages and in filters, and behind an estimate its standard error.
std::vector<RouteColumn> values_of(TableColumn<RouteRow> const& c, PathTable const& table) {
  RouteColumn column{c.key,
                     c.title,
                     c.shown_unit(),
                     c.help,
                     c.kind == ColumnKind::text,
                     c.kind == ColumnKind::count,
                     c.shown_first,
                     {},
                     {},
                     {},
                     false};
  RouteColumn error{
      c.key + "_sigma", "± " + c.title, column.unit, "one standard error", false, false, false, {}, {}, {}, false};
  for (PathRow const& row : table.rows) {
    TableCell cell = c.value({table, row});
    if (column.is_text) {
      column.texts.push_back(std::get<std::string>(std::move(cell)));
      continue;
    }
    column.numbers.push_back(finite_or_nan(c.page.scale * number_in(cell)));
    if (auto const* const e = std::get_if<WithError>(&cell))
      error.numbers.push_back(finite_or_nan(c.page.scale * e->sigma));
  }
  for (RouteColumn* each : {&column, &error})
    if (!each->is_text) add_units(*each);
  return c.kind == ColumnKind::estimate ? std::vector{std::move(column), std::move(error)}
                                        : std::vector{std::move(column)};
}

}  // namespace

double six_digits(double x) {
  return std::isfinite(x) && x != 0 ? std::strtod(fmt::format("{:.6g}", x).c_str(), nullptr) : x;
}

std::vector<std::string> objects_of(std::string const& sequence) {
  constexpr std::string_view then = " > ", event = "·";
  std::vector<std::string> all;
  for (std::size_t at = 0; at <= sequence.size();) {
    std::size_t const end = std::min(sequence.find(then, at), sequence.size());
    std::string const step = sequence.substr(at, end - at);
    if (std::size_t const name = step.find(event); name != std::string::npos) all.push_back(step.substr(0, name));
    at = end + then.size();
  }
  return all;
}

std::vector<std::string> objects_met(PathRow const& row) {
  std::vector<std::string> all;
  auto const add = [&](std::string const& sequence) {
    for (std::string& object : objects_of(sequence))
      if (std::ranges::find(all, object) == all.end()) all.push_back(std::move(object));
  };
  add(row.sequence);
  for (FoldedRow const& f : row.folded)
    if (row.vertices > 0) add(f.sequence);
  return all;
}

namespace {

std::vector<RouteColumn> all_columns(PathTable const& table) {
  TableWriter<RouteRow> const list(route_columns(table));
  std::vector<RouteColumn> all;
  for (TableColumn<RouteRow> const* c : list.of(&TableColumn<RouteRow>::page))
    for (RouteColumn& column : values_of(*c, table)) all.push_back(std::move(column));
  return all;
}

}  // namespace

RouteColumns::RouteColumns(std::vector<RouteColumn> columns) {
  for (RouteColumn& column : columns) add(std::move(column));
}

RouteColumns::RouteColumns(PathTable const& table, NoiseBudget const* budget) : RouteColumns(all_columns(table)) {
  budget_ = budget;
  for (PathRow const& row : table.rows) {
    hashes_.push_back(row.hash);
    resolved_.push_back(row.resolved);
  }
}

RouteColumn& RouteColumns::add(RouteColumn column) {
  place_.emplace(column.key, all_.size());
  return all_.emplace_back(std::move(column));
}

RouteColumn const* RouteColumns::find(std::string_view key) const {
  auto const hit = place_.find(key);
  return hit == place_.end() ? nullptr : &all_[hit->second];
}

RouteColumn const& RouteColumns::strain(double hz) {
  if (RouteColumn const* const known = find(strain_key(hz))) return *known;
  std::string listed;  // the key is h10 at 10 Hz
  for (RouteColumn const& c : all_)
    if (c.unit == strain_unit && !c.is_error()) listed += (listed.empty() ? "" : ", ") + c.key.substr(1) + " Hz";
  if (listed.empty()) throw std::out_of_range("this run has no noise yet; write: straytrace noise RUN");
  if (!budget_) throw std::out_of_range("h is listed at " + listed);
  FrequencyGrid const& grid = budget_->grid;
  if (!(hz >= grid.edges.front() && hz < grid.edges.back()))
    throw std::out_of_range(fmt::format("h is known from {:g} Hz to {:g} Hz", grid.edges.front(), grid.edges.back()));
  auto const curves = by_hash(budget_->routes);
  RouteColumn column{strain_key(hz), strain_title(hz), strain_unit, "", false, false, false, {}, {}, {}, false};
  for (std::size_t i = 0; i < rows(); ++i) {
    auto const curve = curves.find(hashes_[i]);
    bool const known = resolved_[i] && curve != curves.end();
    column.numbers.push_back(known ? strain_at(*curve->second, grid, hz).value : not_a_number);
  }
  add_units(column);
  return add(std::move(column));
}

}  // namespace straytrace::results
