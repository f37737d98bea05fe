// SPDX-License-Identifier: BSD-3-Clause
// straytrace explain: a key, a table, a unit, a message, or the chain of factors of one path. straytrace schema.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <iostream>
#include <memory>
#include <optional>
#include <set>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/input/table.hpp"
#include "base/text/json_text.hpp"
#include "base/units/quantity.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "results/route_table/route_columns.hpp"
#include "results/route_table/route_sums.hpp"
#include "session/library_entries.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"

namespace straytrace::cli {
namespace {

struct Explanation {
  std::string text;
  nlohmann::ordered_json json;
};

using Json = nlohmann::ordered_json;

constexpr std::size_t shown_whole = 3;  // keys of one name that are printed with everything

std::string full_name(LanguageKey const& k) { return k.table + "." + k.key; }

std::string whole_text(LanguageKey const& k) {
  std::string out = fmt::format("{}: key of {}\n  {}\n", full_name(k), k.about, k.text());
  for (char const* fact : {"type", "range", "default", "example"})
    if (std::string const value = k.fact(fact); !value.empty()) out += fmt::format("  {:<8} {}\n", fact, value);
  return out + fmt::format("  {:<8} {}\n", "see", k.fact("page"));
}

Json as_json(LanguageKey const& k) {
  Json out{{"key", full_name(k)}, {"of", k.about}, {"text", k.text()}};
  for (auto const& [name, value] : k.schema.at("x-straytrace").items()) out[name] = value;
  return out;
}

Explanation answer(std::vector<LanguageKey const*> const& found, bool table) {
  Explanation a;
  a.json = Json::array();
  std::size_t width = 0;
  for (LanguageKey const* k : found) width = std::max(width, (table ? k->key : full_name(*k)).size());
  if (table) a.text = fmt::format("{}: {}\n", found.front()->table, found.front()->about);
  for (LanguageKey const* k : found) {
    a.json.push_back(as_json(*k));
    if (!table && found.size() <= shown_whole)
      a.text += whole_text(*k);
    else
      a.text += fmt::format("  {:<{}}  {}\n", table ? k->key : full_name(*k), width, k->text());
  }
  if (table) a.text += fmt::format("see {}\n", found.front()->fact("page"));
  return a;
}

// "cone.half_angle", "half_angle" in all tables, "cone" with all its keys; empty without a similar name.
std::optional<Explanation> explain_key(std::string const& what) {
  std::vector<LanguageKey const*> keys, tables;
  for (LanguageKey const& k : language_keys()) {
    if (full_name(k) == what || k.key == what) keys.push_back(&k);
    if (k.table == what) tables.push_back(&k);
  }
  if (keys.empty() && tables.empty()) return {};
  if (keys.empty()) return answer(tables, true);
  Explanation a = answer(keys, false);
  if (tables.empty()) return a;
  Explanation const more = answer(tables, true);
  a.text += more.text;
  a.json.insert(a.json.end(), more.json.begin(), more.json.end());
  return a;
}

// Whether an output names the column so, with or without the unit: "C_rev", "share/%", "sensitivity", "coupling_hint".
bool is_named(TableColumn<RouteRow> const& c, std::string const& what) {
  using Column = TableColumn<RouteRow>;
  if (what == c.key || what == c.title) return true;
  auto const outputs = {&Column::text, &Column::csv, &Column::json, &Column::page};
  return std::any_of(outputs.begin(), outputs.end(), [&](InOutput Column::*output) {
    std::string const& name = c.name_in(output);
    return (c.*output).place > 0 && (what == name || what == name.substr(0, name.find('/')));
  });
}

// A column of the path table, "coupling", or its error, "coupling_sigma".
std::optional<Explanation> explain_column(std::string const& what) {
  PathTable table;
  table.has_noise = true;
  table.frequencies = TableSettings{}.frequencies;
  table.rows.emplace_back().kind = ClassKind::ghost;  // with the column of kinds
  auto const all = route_columns(table);
  bool error = false;
  auto const hit = std::find_if(all.begin(), all.end(), [&](TableColumn<RouteRow> const& c) {
    error = c.kind == ColumnKind::estimate && what == c.key + "_sigma";
    return error || is_named(c, what);
  });
  if (hit == all.end()) return {};
  std::string const unit = hit->shown_unit(), help = error ? "one standard error" : hit->help,
                    key = error ? what : hit->key;
  Explanation a;
  a.json = {{"column", key}, {"title", error ? "± " + hit->title : hit->title}, {"unit", unit}, {"text", help}};
  a.text = fmt::format(
      "{}: column of the path table, {}\n  {}\n  {}\n", key,
      hit->kind == ColumnKind::text ? "text"
      : unit.empty()                ? "number"
                                    : unit,
      help,
      hit->page.place > 0 ? "used by straytrace paths RUN --where, --sort, --csv" : "printed by straytrace paths RUN");
  a.text += "see docs/reference/run_file.md\n";
  return a;
}

std::string nearest_key(std::string const& what) {
  std::vector<std::string> names, keys;
  std::size_t const dot = what.find('.');
  std::string const table = what.substr(0, dot), key = dot == what.npos ? "" : what.substr(dot + 1);
  for (LanguageKey const& k : language_keys()) {
    names.insert(names.end(), {full_name(k), k.key, k.table});
    if (k.table == table) keys.push_back(k.key);
  }
  if (std::string const near = nearest_word(key, keys); !near.empty()) return table + "." + near;
  return nearest_word(what, names);
}

Explanation explain_unit(std::string const& unit) {
  auto const found = parse_unit(unit);
  if (!found) {
    std::string const near = likely_unit(unit);
    throw InputError(fmt::format("'{}' is not a unit", unit),
                     fmt::format("{}known units: {}", near.empty() ? "" : fmt::format("did you mean '{}'? ", near),
                                 all_unit_names()));
  }
  std::string const accepted = accepted_units(found->dimension), si = with_unit("1", found->dimension);
  Explanation a;
  a.json = {{"unit", unit}, {"dimension", name_of(found->dimension)}, {"si", found->si}, {"accepted", accepted}};
  a.text = fmt::format("{}: {}\n  in SI    {:.10g}{}\n  accepted {}\n", unit, described(found->dimension), found->si,
                       found->dimension == dim::angle   ? " rad"
                       : found->dimension == dim::plain ? ""
                                                        : si.substr(1),
                       accepted);
  if (found->dimension == dim::length || found->dimension == dim::angle)
    a.text += "  amplitudes of motion name their kind: peak, pp (peak to peak) or rms\n";
  if (found->dimension.second % 2 != 0) a.text += "  amplitude spectral density, one-sided\n";
  a.text += "see docs/reference/scene.md\n";
  return a;
}

std::string fact(char const* name, std::string const& value) {
  return value.empty() ? "" : fmt::format("  {:<10} {}\n", name, value);
}

nlohmann::ordered_json about(LibraryEntry const& e) {
  return {{"of", fmt::format("the {} {} of the library", e.kind, e.name)},
          {"status", e.status},
          {"source", e.source},
          {"note", e.note},
          {"include", e.file}};
}

std::string where(LibraryEntry const& e) {
  return fact("status", e.status) + fact("source", e.source) + fact("note", e.note) +
         fact("include", e.file.empty() ? "none is needed" : e.file) +
         fmt::format("straytrace library {} prints all of it; see docs/reference/library.md\n", e.name);
}

Explanation of_number(LibraryEntry const& e, std::string const& name, std::string const& value) {
  Explanation a;
  a.json = about(e);
  a.json["key"] = e.name + "." + name;
  a.json["default"] = value;
  a.text = fmt::format("{}.{}: number of the {} {} of the library\n", e.name, name, e.kind, e.name) +
           fact("default", value) + where(e);
  return a;
}

Explanation of_entry(LibraryEntry const& e) {
  Explanation a;
  a.json = about(e);
  a.json["key"] = e.name;
  a.json["value"] = e.value;
  a.text = fmt::format("{}: {} of the library\n", e.name, e.kind);
  for (auto const& [name, value] : e.numbers) a.text += fmt::format("  {:<18} {}\n", name, value);
  a.text += (e.numbers.empty() ? fact("value", e.value) : "") + fact("wavelength", e.wavelength) + where(e);
  return a;
}

// An entry of the library, "virgo_baffle", or a number of a part or detector, "virgo_baffle.inner_radius".
std::optional<Explanation> explain_library(std::string const& what) {
  for (LibraryEntry const& e : library_entries()) {
    if (e.name == what) return of_entry(e);
    for (auto const& [name, value] : e.numbers)
      if (e.name + "." + name == what) return of_number(e, name, value);
  }
  return {};
}

// Parts whose names hold the word before the dot, with their numbers, as a suggestion; empty: none.
std::string parts_like(std::string const& what) {
  std::string const word = what.substr(0, what.find('.'));
  if (word.size() < 3) return "";
  std::vector<std::string> parts;
  std::set<std::string> numbers;
  for (LibraryEntry const& e : library_entries()) {
    if (e.kind != "part" || e.name.find(word) == e.name.npos) continue;
    parts.push_back(e.name);
    for (auto const& [name, value] : e.numbers) numbers.insert(name);
  }
  if (parts.empty()) return "";
  return fmt::format("parts of this name: {}, with numbers {}; ", fmt::join(parts, ", "), fmt::join(numbers, ", "));
}

// Words in tables of results that are no columns of the path table, with the page on them.
struct Mark {
  std::string_view name, text;
  char const* page = "docs/theory/errors.md";
};
constexpr Mark marks[] = {
    {"at most",
     "an upper bound: light at inner edges, of kind edge, makes a part of the number, and speckle lowers it"},
    {"about",
     "a number without an error: of an unresolved route, or a total that contains upper bounds and lacks routes"},
    {"lower bound", "routes are unresolved: the total contains their observed part, with an equal error"},
    {"unresolved", "the histories do not suffice for an error; the status says why"},
    {"computed", "without a Monte-Carlo error, since it is not sampled"},
    {"still", "nothing on the route moves and its light is steady: it makes exactly no noise"},
    {"too faint to matter", "unresolved, but the observed part is below 0.1 % of the noise power at any frequency"},
    {"no light seen", "no history has brought light there: its power is unknown, and may be above zero"},
    {"effective scores",
     "(sum of scores)^2 over the sum of their squares: histories that carry the sum; an error needs at least 100"},
    {"histories have scored", "number of histories that brought light to the row; an error needs at least 100"},
    {"variance of variance", "relative variance of the squared error; an error is trusted below 0.1"},
    {"one history carries", "share of the largest history in the sum; an error is trusted below 5 %"},
    {"emitted", "in the energy balance: light that beams scatter at the first surface"},
    {"escaped", "in the energy balance: light that has left the scene"},
    {"truncated", "in the energy balance: light cut off after 'order_limit' surface events"},
    {"roulette",
     "in the energy balance: power that Russian roulette has added or taken; zero on average, printed with its error"},
    {"sampling",
     "in the energy balance: mean power that surfaces scatter, less what the drawn directions carried; zero on "
     "average, printed with its error"},
    {"figure of merit", "1/(relative error^2 x seconds of tracing), independent of the number of histories",
     "docs/reference/commands.md"},
    {"speckle", "interference of paths with unknown static phases: h is the mean over them, one realisation differs",
     "docs/theory/spectra.md"},
    {"multiplicity", "phase sensitivity in units of 2k: the number of bounces on the moving body",
     "docs/theory/commissioning.md"},
    {"one realisation",
     "range of h from 5 to 95 % of possible static phases of the paths; the printed h is the mean over them"},
    {"input uncertainty", "range of h that stated brackets and uncertainties of materials and motion leave open"},
    {"elasticity", "d ln h/d ln p of a number p of the scene: 0.5 where h grows as its root",
     "docs/theory/decisions.md"},
    {"witness", "sensor of the disturbance: accelerometer, microphone, shaker drive", "docs/theory/commissioning.md"},
    {"bound_share", "part of the PSD of the total that is an upper bound, of routes of kind edge"},
    {"coherent",
     "linear sum of the ASDs of the routes, as if all were in phase; of ghosts: fields added with known phases",
     "docs/theory/spectra.md"},
    {"scattered", "kind of a route: light that surfaces scatter, sampled by the histories", "docs/theory/sampling.md"},
    {"ghost", "kind of a route: specular reflections that leave the main beam, computed, not sampled",
     "docs/theory/ghosts.md"},
    {"edge", "kind of a route: light diffracted at inner edges, computed, an upper bound",
     "docs/theory/diffraction.md"},
    {"wave", "kind of a route: light diffracted at inner edges, by Fourier propagation in the cavity",
     "docs/theory/wave.md"},
    {"speckle", "kind of a route: light diffracted at inner edges, in the mean over random mirrors",
     "docs/theory/wave.md"},
    {"halo", "kind of a route: light below the crossover angle that surfaces in the field of a cavity scatter back",
     "docs/theory/wave.md"},
    {"rim", "kind of a route: light that a moving rim takes from the main beam, of known static phase",
     "docs/theory/diffraction.md"},
    {"linear", "regime of a route: at least half of its noise power is to first order in the motion",
     "docs/theory/spectra.md"},
    {"wrapped",
     "regime of a route: the phase moves by more than a fringe, and slow motion makes noise at higher "
     "frequencies",
     "docs/theory/spectra.md"},
    {"mixed", "regime of a route: linear and wrapped by turns over the band", "docs/theory/spectra.md"},
    {"beside", "share of the power of a beam that passes outside the edge of the surface", "docs/theory/ghosts.md"},
    {"incidence", "angle between the chief ray of the beam and the normal of the surface", "docs/reference/scene.md"}};

// A mark by its name, or in a printed line: 'only 47 effective scores'.
std::optional<Explanation> explain_mark(std::string const& what, bool in_line) {
  for (auto const& [name, text, page] : marks)
    if (in_line ? name.find(" ") != name.npos && what.find(name) != what.npos : what == name)
      return Explanation{fmt::format("{}: in tables of results\n  {}\nsee {}\n", name, text, page),
                         {{"mark", name}, {"text", text}, {"page", page}}};
  return {};
}

constexpr double alike = 0.6;  // share of the words of the message that are in the query
constexpr std::size_t most = 3, fewest_words = 3;
constexpr double near_best = 0.15;

// Words of letters, in lower case; names and numbers of the user are ignored.
std::set<std::string> words_of(std::string const& text) {
  std::set<std::string> words;
  std::string word;
  bool quoted = false;
  for (char const c : text + " ") {
    if (c == '"') quoted = !quoted;
    if (!quoted && std::isalpha(static_cast<unsigned char>(c))) {
      word += char(std::tolower(static_cast<unsigned char>(c)));
      continue;
    }
    if (word.size() > 1) words.insert(word);
    word.clear();
  }
  return words;
}

// How well the words of a message cover the query, and vice versa.
double likeness(std::set<std::string> const& message, std::set<std::string> const& asked) {
  if (message.size() < fewest_words || asked.empty()) return 0;
  auto const common = double(std::count_if(message.begin(), message.end(), [&](auto& w) { return asked.contains(w); }));
  return 0.5 * common / double(message.size()) + 0.5 * common / double(asked.size());
}

// A printed message or a part of it; empty without a similar one.
std::optional<Explanation> explain_message(std::string const& text) {
  std::set<std::string> const asked = words_of(text);
  if (asked.size() < 2) return {};
  Json const all = read_ordered_json(embedded_file("schema/messages.json"));
  std::vector<std::pair<double, Json const*>> found;
  for (Json const& m : all)
    if (double const like = likeness(words_of(m.at("what")), asked); like >= alike) found.emplace_back(like, &m);
  if (found.empty()) return {};
  std::stable_sort(found.begin(), found.end(), [](auto const& a, auto const& b) { return a.first > b.first; });
  double const best = found.front().first;
  std::erase_if(found, [&](auto const& f) { return f.first < best - near_best; });
  found.resize(std::min(most, found.size()));
  Explanation a;
  a.json = Json::array();
  for (auto const& [like, m] : found) {
    a.json.push_back(*m);
    a.text += fmt::format("{}: {}\n", m->at("severity").get<std::string>(), m->at("what").get<std::string>());
    a.text += fmt::format("  remedy   {}\n  about    {}\n", m->at("remedy").get<std::string>(),
                          m->at("about").get<std::string>());
  }
  return a;
}

// "h = 1.23e-24 ± 0.04e-24 /sqrt(Hz), Monte-Carlo error", "h = 1.2e-24 (computed) /sqrt(Hz)" or "h at most ...".
std::string strain_with_error(WithError const& h, bool sampled, ClassKind kind) {
  return fmt::format("h {}{} /sqrt(Hz){}", h.at_most ? "" : "= ", with_error(h),
                     sampled                                  ? ", Monte-Carlo error"
                     : h.sigma > 0 && kind == ClassKind::halo ? ", error over random mirrors"
                                                              : "");
}

void add_factors(Explanation& a, std::vector<StrainFactor> const& factors) {
  auto const value_text = [](StrainFactor const& f) {
    return f.upper_bound ? with_error({f.value, 0, true}) : fmt::format("{:.4g}", f.value);
  };
  std::size_t width = 10;
  for (StrainFactor const& f : factors) width = std::max(width, value_text(f).size());
  for (StrainFactor const& f : factors) {
    Json& one = a.json["factors"][f.name] = {{"value", f.value}, {"unit", f.unit}, {"what", f.meaning}};
    if (f.upper_bound) one["at_most"] = true;
    a.text += fmt::format("  {:<11} {:<{}} {:<11} {}\n", f.name, value_text(f), width, f.unit, f.meaning);
  }
}

// `path`: its rank in the path table.
Explanation explain_strain(std::string const& run_file, std::size_t path, double hz) {
  OpenRun const run(run_file);
  ProjectionModel const& model = run.model;
  CouplingTable const& table = run.file.trace.coupling;
  NoiseBudget const budget = model.project(table);
  PathTable const paths = table_for(table, &budget, model);
  if (path < 1 || path > paths.rows.size())
    throw InputError(fmt::format("the run has no path {}; it has {}", path, paths.rows.size()),
                     fmt::format("see straytrace paths {}", run_file));
  PathRow const& row = paths.rows[path - 1];
  StrainFactors const s = strain_factors(table, budget, row, *model.detector, hz);
  Explanation a;
  a.json = {{"path", path},
            {"route", row.sequence},
            {"port", row.port},
            {"hz", s.centre},
            {"resolved", s.resolved},
            {"sigma", s.h.sigma},
            {"linear_share", s.linear_share}};
  a.text = fmt::format("path {}: {}, port {}, bin {:.4g} to {:.4g} Hz\n", path, row.sequence, row.port, s.low, s.high);
  add_factors(a, s.factors);
  a.text += fmt::format("  {}; moved by {}; {:.0f} % of its power to first order in the motion of the bin\n",
                        strain_with_error(s.h, s.sampled, row.kind), row.moves.empty() ? "nothing" : row.moves,
                        100 * s.linear_share);
  if (!s.resolved) a.text += fmt::format("  unresolved, the numbers are hints: {}\n", s.why_not);
  a.text += "see docs/theory/spectra.md\n";
  return a;
}

struct ExplainOptions : PrintOptions {
  std::vector<std::string> words;
  std::size_t path = 1;
  double hz = 30;
};

// 'unit m/sqrt(Hz)' may be quoted as one word.
std::vector<std::string> words_of(ExplainOptions const& asked) {
  for (std::string const first : {"unit ", "h "})
    if (asked.words.size() == 1 && asked.words.front().starts_with(first))
      return {first.substr(0, first.size() - 1), asked.words.front().substr(first.size())};
  return asked.words;
}

std::string suggestion_for(std::string const& what) {
  std::string const near = nearest_key(what);
  return (near.empty() ? "" : fmt::format("did you mean '{}'? ", near)) + parts_like(what) +
         "write TABLE.KEY (cone.half_angle), a table (beam), a key (half_angle), PART.NUMBER (lens.diameter), "
         "a column or a word of a table of results, 'unit m/sqrt(Hz)', or the text of a message";
}

Explanation answer_to(ExplainOptions const& asked) {
  std::vector<std::string> const words = words_of(asked);
  if (words.front() == "unit" && words.size() == 2) return explain_unit(words[1]);
  if (words.front() == "h" && words.size() == 2) return explain_strain(words[1], asked.path, asked.hz);
  if (words.front() == "h")
    throw InputError("'explain h' needs a run file", "write straytrace explain h RUN.h5 --path 1");
  if (words.front() == "unit")
    throw InputError("'explain unit' needs a unit", "write straytrace explain unit 'm/sqrt(Hz)'");
  std::string const what = fmt::format("{}", fmt::join(words, " "));
  if (auto found = explain_key(what)) return *found;
  if (auto found = explain_library(what)) return *found;
  if (auto found = explain_column(what)) return *found;
  if (auto found = explain_mark(what, false)) return *found;
  if (auto found = explain_message(what)) return *found;
  if (auto found = explain_mark(what, true)) return *found;
  if (parse_unit(what)) return explain_unit(what);
  throw InputError(fmt::format("'{}' is unknown in the language and the library", what), suggestion_for(what));
}

}  // namespace

void add_explain(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<ExplainOptions>();
  ExplainOptions& o = *options;
  auto* const command = app.add_subcommand(
      "explain", "Explain a key of the language, a part, a column, a unit, a message, or the factors of a path.");
  command
      ->add_option(
          "what", o.words,
          "TABLE.KEY, TABLE, KEY, an entry of the library, a column of the path table, 'unit U', the text of a "
          "message, or 'h RUN'")
      ->required();
  command->add_option("--path", o.path, "rank in the path table, for 'explain h'; default 1")
      ->check(whole_between(1, 1e6, "3"));
  command->add_option("--at", o.hz, "frequency in Hz, for 'explain h'; default 30")
      ->check(number_between(1e-9, 1e9, "30"));
  add_format_option(*command, o);
  command->footer(
      "Examples:\n"
      "  straytrace explain cone.half_angle\n"
      "  straytrace explain virgo_baffle.inner_radius\n"
      "  straytrace explain unit 'm/sqrt(Hz)'\n"
      "  straytrace explain \"does not say which amplitude it is\"\n"
      "  straytrace explain h out/run.h5 --path 2 --at 10");
  command->callback([options, &exit_code] {
    Explanation const answer = answer_to(*options);
    std::cout << (options->json() ? json_text(answer.json, 1) + "\n" : answer.text);
    exit_code = done;
  });
}

void add_schema(CLI::App& app, int& exit_code) {
  auto* const command = app.add_subcommand("schema", "Print the JSON Schema of scenes and motion files, for editors.");
  command->footer(
      "Examples:\n"
      "  straytrace schema > straytrace-1.schema.json\n"
      "  straytrace schema | python3 -m json.tool > /dev/null");
  command->callback([&] {
    std::cout << language_schema();
    exit_code = done;
  });
}

}  // namespace straytrace::cli
