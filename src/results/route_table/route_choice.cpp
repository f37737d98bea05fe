// SPDX-License-Identifier: BSD-3-Clause
#include "results/route_table/route_choice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/errors.hpp"
#include "base/text/json_text.hpp"
#include "base/text/words.hpp"
#include "results/route_table/route_columns.hpp"
#include "results/route_table/route_filter.hpp"
#include "results/route_table/route_sums.hpp"
#include "results/text/table.hpp"

namespace straytrace::results {

namespace {

using Patterns = std::vector<std::string>;

bool passes(std::string const& sequence, Patterns const& patterns) {
  auto const objects = objects_of(sequence);
  return std::ranges::any_of(patterns, [&](std::string const& pattern) {
    return std::ranges::any_of(objects, [&](std::string const& object) { return matches(pattern, object); });
  });
}

// A row `other`, or one of several ghosts.
bool sums_routes(PathRow const& row) { return row.vertices == 0 || row.folded_routes > 1; }

// Which routes of a row pass an object: none, all, some (of `other` also all), or perhaps some that are not listed.
enum class Held { none, all, some, hidden };

Held held_in(PathRow const& row, Patterns const& patterns) {
  if (!sums_routes(row)) return passes(row.sequence, patterns) ? Held::all : Held::none;
  std::size_t passing = 0, unknown = row.folded.size() < std::max<std::size_t>(row.folded_routes, 1);
  for (FoldedRow const& f : row.folded) {
    passing += passes(f.sequence, patterns);
    unknown += objects_of(f.sequence).empty();  // "long routes"
  }
  if (passing == 0) return unknown > 0 ? Held::hidden : Held::none;
  return row.vertices > 0 && passing == row.folded_routes ? Held::all : Held::some;
}

InputError nothing_passes(std::string const& pattern, PathTable const& table) {
  std::set<std::string> names;
  std::vector<std::string> rows;
  auto const add = [&](std::string const& sequence) {
    for (std::string const& object : objects_of(sequence)) names.insert(object);
  };
  for (PathRow const& row : table.rows) {
    if (held_in(row, {pattern}) == Held::some) rows.push_back("'" + row.sequence + "'");
    add(row.sequence);
    for (FoldedRow const& f : row.folded) add(f.sequence);
  }
  if (!rows.empty())
    return InputError(fmt::format("--without: routes that pass '{}' are only in {}, which cannot be divided", pattern,
                                  fmt::join(rows, ", ")),
                      "remove the object from the scene and compare the runs with 'straytrace diff'");
  std::vector<std::string> const all(names.begin(), names.end());
  std::string const near = nearest_word(pattern, all);
  return InputError(fmt::format("--without: no route passes '{}'", pattern),
                    near.empty() ? "objects of routes are " + fmt::format("{}", fmt::join(all, ", "))
                                 : "did you mean '" + near + "'?");
}

// Rows of routes that pass an object; a pattern without a match is a problem, since it would remove nothing, and so is
// a row whose fields it would divide.
std::vector<std::size_t> passing(Patterns const& patterns, PathTable const& table, std::vector<InputError>& errors) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    PathRow const& row = table.rows[i];
    Held const held = held_in(row, patterns);
    if (held == Held::all) rows.push_back(i);
    if (held == Held::some && row.vertices > 0)
      errors.push_back(InputError(
          fmt::format("--without: '{}' is a coherent sum of ghosts, of which only some pass {}; it cannot be divided",
                      row.sequence, fmt::join(patterns, " and ")),
          "trace the scene with 'ghosts: {sum: independent}', or without the object"));
  }
  for (std::string const& pattern : patterns) {
    bool const found = std::ranges::any_of(table.rows, [&](PathRow const& row) {
      Held const held = held_in(row, {pattern});
      return held == Held::all || (held == Held::some && row.vertices > 0);
    });
    if (!found) errors.push_back(nothing_passes(pattern, table));
  }
  return rows;
}

void collect(std::string const& option, std::string const& text, FilterAnswer const& answer,
             std::vector<InputError>& errors) {
  for (FilterProblem const& p : answer.problems) errors.push_back(error_in_filter(option, text, p));
}

nlohmann::ordered_json json_of(WithError const& x) {
  return std::isnan(x.value) ? nlohmann::ordered_json() : error_json(x);
}

std::string number_of(WithError const& x) { return std::isnan(x.value) ? "unresolved" : with_brackets(x); }

// Rows that --without cannot divide.
std::string staying(Patterns const& patterns, PathTable const& table) {
  std::vector<std::string> some, hidden;
  for (PathRow const& row : table.rows) {
    Held const held = held_in(row, patterns);
    if (held == Held::some) some.push_back("'" + row.sequence + "'");
    if (held == Held::hidden) hidden.push_back("'" + row.sequence + "'");
  }
  std::string text;
  if (!some.empty())
    text += fmt::format("  Some routes in {} pass there, and stay in the sums.\n", fmt::join(some, ", "));
  if (!hidden.empty())
    text += fmt::format("  Some routes in {} may pass there, and stay in the sums.\n", fmt::join(hidden, ", "));
  return text;
}

std::string without_text(PathsChoice const& choice, ChosenPaths const& chosen) {
  std::string text = fmt::format("Without {} ({} route{} left out):\n", fmt::join(choice.without, " and "),
                                 chosen.left_out, chosen.left_out == 1 ? "" : "s");
  for (StrainWithout const& s : chosen.strain) {
    text += fmt::format("  h({:g} Hz) ", s.hz);
    text += std::isnan(s.after.value) ? "not resolved: no remaining resolved route causes noise there"
                                      : fmt::format("{}, factor {}", number_of(s.after), number_of(s.factor));
    text += fmt::format("; before {} 1/sqrt(Hz)\n", number_of(s.before));
  }
  if (chosen.strain.empty())
    text += fmt::format("  sum of couplings {}, before {}\n", number_of(chosen.all.total_coupling),
                        number_of(chosen.coupling_before));
  text += staying(choice.without, chosen.all);
  if (chosen.all.missing() > 0)
    text += fmt::format("  {}: the sums contain the observed part of unresolved routes, with an equal error\n",
                        bound_text(chosen.all.has_upper_bounds(), chosen.all.missing()));
  return text + "  The further path of their light is not traced: for that remove the object from the scene.\n";
}

}  // namespace

ChosenPaths choose_paths(PathsChoice const& choice, PathTable const& table, CouplingTable const& coupling,
                         NoiseBudget const* budget) {
  std::vector<InputError> errors;
  ChosenPaths chosen{table, {}, {}, 0, table.total_coupling, {}};
  std::vector<std::size_t> const out = passing(choice.without, table, errors);
  if (!out.empty()) {
    Without without = without_rows(table, out, coupling, budget);
    chosen.all = std::move(without.rest);
    chosen.strain = std::move(without.strain);
    chosen.left_out = out.size();
  }
  RouteColumns columns(chosen.all, budget);
  FilterAnswer answer = filtered(choice.where, columns);
  collect("--where", choice.where, answer, errors);
  chosen.notes = answer.notes;
  if (!choice.sort.empty()) {
    answer = sorted_by(choice.sort, answer.rows, columns);
    collect("--sort", choice.sort, answer, errors);
  }
  throw_all(errors);
  chosen.shown = part_of(chosen.all, answer.rows);
  return chosen;
}

std::string choice_text(PathsChoice const& choice, ChosenPaths const& chosen) {
  std::string text = choice.without.empty() ? "" : without_text(choice, chosen);
  if (!choice.where.empty())
    text += fmt::format("{} of {} routes: {}\n", chosen.shown.rows.size(), chosen.all.rows.size(), choice.where);
  if (!choice.sort.empty()) text += "Sorted by " + choice.sort + "\n";
  for (std::string const& note : chosen.notes) text += "note: " + note + "\n";
  return printable(text);
}

std::string with_choice(std::string const& json, PathsChoice const& choice, ChosenPaths const& chosen) {
  auto j = read_ordered_json(json);
  if (!choice.where.empty()) j["where"] = choice.where;
  if (!choice.sort.empty()) j["sort"] = choice.sort;
  j["notes"] = chosen.notes;
  if (!choice.without.empty()) {
    auto strain = nlohmann::ordered_json::array();
    for (StrainWithout const& s : chosen.strain)
      strain.push_back({{"frequency_Hz", s.hz},
                        {"before", json_of(s.before)},
                        {"after", json_of(s.after)},
                        {"factor", json_of(s.factor)}});
    j["without"] = {{"objects", choice.without}, {"routes", chosen.left_out}, {"strain", strain}};
  }
  return json_text(j, 2) + "\n";
}

namespace {

using Json = nlohmann::ordered_json;

// Sums over routes: noise power in the band, PSD at each frequency, coupling.
struct Sums {
  ReplicaSum power, coupling;
  std::vector<ReplicaSum> psd;
  std::vector<std::size_t> routes;
  bool at_most = false;

  void add(PathRow const& row) {
    power.add({row.power, row.replicas});
    coupling.add({row.coupling_with_error(), row.replicas});
    psd.resize(row.strain.size());
    for (std::size_t k = 0; k < psd.size(); ++k) {
      WithError const& h = row.strain[k];
      if (h.value > 0) psd[k].add({{h.value * h.value, 2 * h.value * h.sigma}, row.replicas});
    }
    routes.push_back(row.rank);
    at_most = at_most || row.upper_bound();
  }
};

WithError root(WithError square) {
  double const h = std::sqrt(square.value);
  return h > 0 ? WithError{h, square.sigma / (2 * h)} : WithError{not_a_number, not_a_number};
}

struct ObjectLine {
  PathTable const& table;
  MetObject const& met;
};

Json strain_of(ObjectLine const& r) {
  Json all = Json::array();
  for (std::size_t k = 0; k < r.met.strain.size(); ++k) {
    Json h = error_json(r.met.strain[k]);
    h["frequency_Hz"] = r.table.frequencies[k];
    all.push_back(h);
  }
  return all;
}

// clang-format off

std::vector<TableColumn<ObjectLine>> columns_of(PathTable const& table) {
  std::vector<TableColumn<ObjectLine>> all;
  all.push_back({.key = "object", .kind = ColumnKind::text, .help = "that the light has met",
    .value = [](ObjectLine const& r) { return r.met.object.empty() ? "(routes not named)" : r.met.object; },
    .text = {10}, .csv = {10}, .json = {10}, .left = true,
    .as_json = [](ObjectLine const& r) { return Json(r.met.object); }});
  all.push_back({.key = "share", .kind = ColumnKind::estimate, .unit = "1",
    .help = "of the resolved strain noise power in the band", .value = [](ObjectLine const& r) { return r.met.share; },
    .text = {table.has_noise ? 20 : 0, "share/%"}, .csv = {20, "share_percent", 100}, .json = {20},
    .as_text = [](ObjectLine const& r) { return percent_text(r.met.share); }});
  for (std::size_t k = 0; table.has_noise && k < table.frequencies.size(); ++k)
    all.push_back({.key = strain_key(table.frequencies[k]), .kind = ColumnKind::estimate, .unit = "1/√Hz",
      .help = "one-sided strain ASD, mean over random static phases",
      .value = [k](ObjectLine const& r) { return r.met.strain[k]; },
      .text = {30, fmt::format("h({:g} Hz)", table.frequencies[k])},
      .csv = {30, fmt::format("h_{:g}Hz", table.frequencies[k])}});
  all.push_back({.key = "strain", .kind = ColumnKind::list, .help = "one-sided strain ASD at each frequency",
    .json = {table.has_noise ? 30 : 0}, .as_json = strain_of});
  all.push_back({.key = "coupling", .kind = ColumnKind::estimate, .unit = "1", .help = "recoupled power fraction",
    .value = [](ObjectLine const& r) { return r.met.coupling; }, .text = {40}, .csv = {40}, .json = {40}});
  all.push_back({.key = "routes", .kind = ColumnKind::text, .help = "ranks of its routes",
    .value = [](ObjectLine const& r) { return fmt::format("{}", fmt::join(r.met.routes, " ")); },
    .text = {50, "by path"}, .csv = {50}, .json = {50}, .left = true,
    .as_text = [](ObjectLine const& r) { return first_ranks(r.met.routes); },
    .as_json = [](ObjectLine const& r) { return Json(r.met.routes); }});
  return all;
}

// clang-format on

// What the numbers leave out.
std::string limits(PathTable const& table) {
  return table.unresolved == 0 ? ""
                               : fmt::format("{} {} not in it.\n", counted(table.unresolved, "unresolved route"),
                                             table.unresolved == 1 ? "is" : "are");
}

}  // namespace

std::vector<MetObject> objects_by_noise(PathTable const& table) {
  std::map<std::string, Sums> objects;
  Sums all;
  for (PathRow const& row : table.rows) {
    if (!row.resolved) continue;
    all.add(row);
    std::vector<std::string> names = objects_met(row);
    if (names.empty()) names = {""};
    for (std::string const& name : names) objects[name].add(row);
  }
  std::vector<MetObject> met;
  for (auto const& [name, sums] : objects) {
    MetObject o{name, {not_a_number, not_a_number}, {}, sums.coupling.result(), sums.routes};
    o.coupling.at_most = sums.at_most;
    if (table.has_noise) o.share = sums.power.share_of(all.power);
    for (ReplicaSum const& psd : sums.psd) {
      o.strain.push_back(root(psd.result()));
      o.strain.back().at_most = sums.at_most;
    }
    met.push_back(std::move(o));
  }
  std::ranges::sort(met, [&](MetObject const& a, MetObject const& b) {
    if (a.object.empty() != b.object.empty()) return b.object.empty();
    double const one = table.has_noise ? a.share.value : a.coupling.value,
                 two = table.has_noise ? b.share.value : b.coupling.value;
    return one != two ? one > two : a.object < b.object;
  });
  return met;
}

std::string port_census_text(PathTable const& table, std::size_t show) {
  std::string text = "Objects met by the light that rejoins the mode, by the ";
  text += table.has_noise ? fmt::format("strain noise power of their routes, {:g} to {:g} Hz.\n", table.low, table.high)
                          : std::string("coupling of their routes.\n");
  text += "A route counts once for every object that it meets, so shares add up to more than 100 %. " + limits(table) +
          "(n): one standard error, last digits.\n\n";
  TableWriter<ObjectLine> const list(columns_of(table));
  Columns c = list.text_head();
  std::vector<MetObject> const all = objects_by_noise(table);
  for (std::size_t i = 0; i < std::min(show, all.size()); ++i) c.rows.push_back(list.text_row({table, all[i]}));
  text += aligned(c);
  return show < all.size() ? text + fmt::format("and {} more\n", all.size() - show) : text;
}

std::string port_census_csv(PathTable const& table, RunContent const& run) {
  TableWriter<ObjectLine> const list(columns_of(table));
  std::string text =
      file_header(run) +
      "# one row per object met by the light that rejoins the mode, over all routes that meet it; routes: "
      "ranks in the path table\n" +
      fmt::format("# share_percent: of the resolved strain noise power between {} and {} Hz\n", table.low, table.high);
  if (table.unresolved > 0) text += "# " + limits(table);
  text += list.csv_head();
  for (MetObject const& o : objects_by_noise(table)) text += list.csv_row({table, o});
  return text;
}

std::string port_census_json(PathTable const& table, RunContent const& run) {
  TableWriter<ObjectLine> const list(columns_of(table));
  Json j{{"model_hash", run.model_hash},
         {"seed", run.trace->coupling.seed},
         {"histories", run.trace->coupling.histories},
         {"band_Hz", {table.low, table.high}},
         {"unresolved_routes", table.unresolved},
         {"objects", Json::array()}};
  for (MetObject const& o : objects_by_noise(table)) j["objects"].push_back(list.json_row({table, o}));
  return json_text(j, 2) + "\n";
}

}  // namespace straytrace::results
