// SPDX-License-Identifier: BSD-3-Clause
#include "results/budget/budget_view.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "results/curves/band.hpp"
#include "results/pygwinc/pygwinc_ifo.hpp"
#include "results/results.hpp"

namespace straytrace::results {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view requirement = "LIGO requirement";

std::string asd_cell(double x) { return std::isfinite(x) ? fmt::format("{:.3e}", x) : "-"; }

Json number_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }
Json json_numbers(std::vector<double> const& all) {
  Json out = Json::array();
  for (double const x : all) out.push_back(number_or_null(x));
  return out;
}

std::string kind_of(BudgetEntry const& e) {
  return e.kind == BudgetEntry::Kind::fundamental ? "fundamental"
         : e.kind == BudgetEntry::Kind::technical ? "technical"
                                                  : "stray light";
}

std::vector<double> const* reference(BudgetOn const& b) { return b.curves.empty() ? nullptr : &b.curves.front().asd; }

bool holds_upper_bounds(BudgetEntry const& e, std::size_t i) {
  return i < e.at_most.size() && e.at_most[i] && e.asd[i] > 0;
}

// "1.2e-24", with its error where it has one, and "!" above the margin.
std::string cell(BudgetView const& v, BudgetEntry const& e, std::size_t i) {
  double const h = e.asd[i], sigma = e.sigma.empty() ? 0 : e.sigma[i];
  bool const most = holds_upper_bounds(e, i);
  std::string text = most                            ? with_brackets({h, sigma, true, e.incomplete})
                     : std::isfinite(h) && sigma > 0 ? with_brackets(h, sigma)
                                                     : asd_cell(h);
  if (!std::isfinite(h) && !e.note.empty()) text = "unknown";
  std::vector<double> const* const design = reference(v.at);
  text += design && NoiseTable::exceeds(h, (*design)[i], v.margin) ? " !" : "  ";
  return text;
}

std::string row(std::string const& name, std::vector<std::string> const& cells) {
  std::string text = fmt::format("{:<28}", name);
  for (std::string const& c : cells) text += fmt::format("  {:>16}", c);
  return text + '\n';
}

std::vector<std::string> numbers(std::vector<double> const& all, char const* form = "{:.3e}") {
  std::vector<std::string> cells;
  for (double const x : all) cells.push_back(std::isfinite(x) ? fmt::format(fmt::runtime(form), x) : "-");
  return cells;
}

std::vector<std::string> ranges(std::vector<double> const& low, std::vector<double> const& high) {
  std::vector<std::string> cells;
  for (std::size_t i = 0; i < low.size(); ++i)
    cells.push_back(!std::isfinite(low[i]) || !std::isfinite(high[i]) ? "-"
                    : low[i] == 0 && high[i] == 0                     ? "none"
                                                                      : fmt::format("{:.1e}..{:.1e}", low[i], high[i]));
  return cells;
}

// Below the line of an entry: its bands, never merged with each other or with the Monte-Carlo error.
std::string band_rows(BudgetEntry const& e) {
  std::string text;
  BudgetBands const& b = e.bands;
  if (e.inputs_stated) text += row("  input uncertainty", ranges(b.input_low, b.input_high));
  if (b.speckle_50.empty()) return text;
  std::vector<std::string> medians = numbers(b.speckle_50, "{:.1e}");
  for (std::size_t i = 0; i < medians.size(); ++i)
    if (b.speckle_50[i] == 0) medians[i] = "none";
  return text + row("  one realisation, 5..95 %", ranges(b.speckle_05, b.speckle_95)) +
         row("  one realisation, 50 %", medians);
}

bool unknown_somewhere(BudgetEntry const& e) {
  return std::any_of(e.asd.begin(), e.asd.end(), [](double h) { return !std::isfinite(h); });
}
bool known_somewhere(BudgetEntry const& e) {
  return std::any_of(e.asd.begin(), e.asd.end(), [](double h) { return std::isfinite(h); });
}

// With the Monte-Carlo error where that of stray light is visible.
std::vector<std::string> total_cells(NoiseTable const& t) {
  std::vector<double> const h = t.total(), sigma = t.total_sigma();
  std::vector<std::string> cells = numbers(h);
  for (std::size_t i = 0; i < sigma.size(); ++i)
    if (sigma[i] > 1e-3 * h[i]) cells[i] = with_brackets(h[i], sigma[i]);
  for (BudgetEntry const& e : t.entries)
    for (std::size_t i = 0; i < e.at_most.size(); ++i)
      if (e.at_most[i] && at_most(h[i], sigma.empty() ? 0 : sigma[i], std::pow(e.asd[i] / h[i], 2)))
        cells[i] = with_brackets({h[i], 0, true, e.incomplete});
  return cells;
}

// Contributions missing from the total.
std::string bound(BudgetView const& v) {
  std::vector<std::string> unknown, incomplete;
  for (BudgetEntry const& e : v.at.table.entries)
    if (unknown_somewhere(e))
      unknown.push_back(e.name);
    else if (e.incomplete)
      incomplete.push_back(e.name);
  std::string text;
  if (!unknown.empty()) text += fmt::format("total: a lower bound where {} is not known\n", fmt::join(unknown, ", "));
  if (!incomplete.empty())
    text += fmt::format("total: without the unresolved routes of {}\n", fmt::join(incomplete, ", "));
  return text;
}

std::string flagged(BudgetView const& v) {
  std::vector<double> const* const design = reference(v.at);
  if (!design) return "";
  std::vector<std::string> loud;
  for (BudgetEntry const& e : v.at.table.entries)
    for (std::size_t i = 0; i < e.asd.size(); ++i)
      if (e.kind != BudgetEntry::Kind::fundamental && NoiseTable::exceeds(e.asd[i], (*design)[i], v.margin)) {
        loud.push_back(e.name);
        break;
      }
  bool const any = std::any_of(v.at.table.entries.begin(), v.at.table.entries.end(),
                               [](BudgetEntry const& e) { return e.kind != BudgetEntry::Kind::fundamental; });
  if (!any) return fmt::format("!: above {:g} x {}\n", v.margin, v.at.curves.front().name);
  return fmt::format("!: above {:g} x {}; of technical noises and stray light: {}\n", v.margin,
                     v.at.curves.front().name,
                     loud.empty() ? "none of the known ones" : fmt::format("{}", fmt::join(loud, ", ")));
}

std::string kind_of_bound(BudgetEntry const& e, std::size_t i) {
  if (holds_upper_bounds(e, i)) return e.incomplete ? "about " : "at most ";
  return e.incomplete ? "at least " : "";
}

std::string ratios(BudgetView const& v) {
  std::vector<double> const* const design = reference(v.at);
  if (!design) return "";
  std::string text;
  for (BudgetEntry const& e : v.at.table.entries) {
    if (e.kind == BudgetEntry::Kind::fundamental) continue;
    std::vector<std::string> cells;
    for (std::size_t i = 0; i < e.asd.size(); ++i) {
      double const ratio = e.asd[i] / (*design)[i];
      cells.push_back(!std::isfinite(ratio) ? "-" : fmt::format("{}{:.3g}", kind_of_bound(e, i), ratio));
    }
    text += row("  " + e.name, cells);
  }
  if (!text.empty()) text = fmt::format("over {}\n", v.at.curves.front().name) + text;
  return text;
}

BudgetTrace trace_of(BudgetEntry const& e) {
  BudgetTrace t{e.name, e.words.empty() ? e.name : e.words, {}, {}};
  for (double const h : e.asd) t.psd.push_back(h * h);
  for (BudgetEntry const& part : e.parts) t.parts.push_back(trace_of(part));
  return t;
}

std::string run_line(RunAbout const& run) {
  return fmt::format("{}: {}{}, model {}, seed {}, {} histories\n", run.entry,
                     run.title.empty() ? "" : run.title + ", ", run.file, run.model_hash.substr(0, 12), run.seed,
                     run.histories);
}

}  // namespace

std::string budget_text(BudgetView const& v) {
  std::vector<std::string> head;
  for (double const f : v.at.table.hz) head.push_back(fmt::format("{:g} Hz", f));
  std::string text = v.title + "\nstrain ASD [1/sqrt(Hz)], one-sided\n" + row("", head);
  for (BudgetEntry const& e : v.at.table.entries) {
    std::vector<std::string> cells;
    for (std::size_t i = 0; i < e.asd.size(); ++i) cells.push_back(cell(v, e, i));
    text += row(e.name, cells) + band_rows(e);
  }
  text += row("total", total_cells(v.at.table));
  if (auto const low = v.at.table.total_at(&BudgetBands::input_low); !low.empty())
    text += row("  input uncertainty", ranges(low, v.at.table.total_at(&BudgetBands::input_high)));
  for (DesignCurve const& c : v.at.curves) text += row(c.name, numbers(c.asd));
  for (DesignCurve const& c : v.at.lines) text += row(c.name, numbers(c.asd));
  text += ratios(v) + flagged(v) + bound(v);
  if (std::any_of(v.at.lines.begin(), v.at.lines.end(), [](DesignCurve const& c) { return c.name == requirement; }))
    text += "LIGO requirement: a tenth of the thermal noise of suspensions and test masses (G0900670)\n";
  for (BudgetEntry const& e : v.at.table.entries)
    if (!e.note.empty()) text += fmt::format("{}: {}\n", e.name, e.note);
  for (RunAbout const& run : v.runs) text += run_line(run);
  if (!v.left_out.empty()) text += fmt::format("omitted, parameters not stated: {}\n", fmt::join(v.left_out, ", "));
  return text;
}

namespace {

void add_errors(Json& j, BudgetEntry const& e) {
  if (!e.sigma.empty()) j["sigma"] = json_numbers(e.sigma);
  for (BudgetBandColumn const& c : budget_band_columns)
    if (!(e.bands.*c.curve).empty()) j[c.name] = json_numbers(e.bands.*c.curve);
  if (e.inputs_stated) j["inputs_stated"] = true;
}

Json json_of(BudgetView const& v, BudgetOn const& b) {
  Json out{{"frequency_Hz", b.table.hz}, {"noises", Json::array()}};
  std::vector<double> const* const design = reference(b);
  for (BudgetEntry const& e : b.table.entries) {
    Json j{{"name", e.name}, {"what", e.words}, {"kind", kind_of(e)}, {"strain", json_numbers(e.asd)}};
    add_errors(j, e);
    if (!e.note.empty()) j["note"] = e.note;
    if (std::count(e.at_most.begin(), e.at_most.end(), true) > 0)
      j[e.incomplete ? "contains_upper_bounds" : "at_most"] = e.at_most;
    if (design) {
      Json over = Json::array(), above = Json::array();
      for (std::size_t i = 0; i < e.asd.size(); ++i) {
        over.push_back(number_or_null(e.asd[i] / (*design)[i]));
        above.push_back(NoiseTable::exceeds(e.asd[i], (*design)[i], v.margin));
      }
      j["over_reference"] = over;
      j["above_margin"] = above;
    }
    for (BudgetEntry const& part : e.parts) {
      Json p{{"name", part.name}, {"strain", json_numbers(part.asd)}};
      add_errors(p, part);
      j["parts"].push_back(p);
    }
    out["noises"].push_back(j);
  }
  out["total"] = json_numbers(b.table.total());
  if (auto const sigma = b.table.total_sigma(); !sigma.empty()) out["total_sigma"] = json_numbers(sigma);
  if (auto const low = b.table.total_at(&BudgetBands::input_low); !low.empty()) {
    out["total_input_low"] = json_numbers(low);
    out["total_input_high"] = json_numbers(b.table.total_at(&BudgetBands::input_high));
  }
  out["curves"] = Json::array();
  for (DesignCurve const& c : b.curves) out["curves"].push_back({{"name", c.name}, {"strain", json_numbers(c.asd)}});
  out["lines"] = Json::array();
  for (DesignCurve const& c : b.lines) out["lines"].push_back({{"name", c.name}, {"strain", json_numbers(c.asd)}});
  return out;
}

}  // namespace

Json budget_json(BudgetView const& v) {
  Json runs = Json::array();
  for (RunAbout const& r : v.runs)
    runs.push_back({{"name", r.entry},
                    {"file", r.file},
                    {"title", r.title},
                    {"model_hash", r.model_hash},
                    {"seed", r.seed},
                    {"histories", r.histories},
                    {"created", r.created}});
  return {{"title", v.title},       {"program", "straytrace"}, {"version", v.version},
          {"commit", v.commit},     {"created", utc_now()},    {"inputs", v.inputs},
          {"runs", runs},           {"margin", v.margin},      {"warnings", v.warnings},
          {"left_out", v.left_out}, {"at", json_of(v, v.at)},  {"curves", json_of(v, v.grid)}};
}

std::string budget_pygwinc(BudgetView const& v) {
  BudgetFile file;
  NoiseTable const& t = v.grid.table;
  file.hz = t.hz;
  if (v.ifo) file.ifo = v.ifo->yaml;
  file.models = v.models;
  file.total = {"Total", v.title, {}, {}};
  std::string bounds;
  for (double const h : t.total()) file.total.psd.push_back(std::isfinite(h) ? h * h : 0);
  for (BudgetEntry const& e : t.entries) {
    if (known_somewhere(e)) file.total.parts.push_back(trace_of(e));
    if (!e.note.empty()) bounds += fmt::format("{}: {}; ", e.name, e.note);
  }
  return budget_file_bytes(
      file, {{"program", "straytrace"}, {"version", v.version}, {"commit", v.commit}, {"notes", bounds}});
}

// budget.txt: a column per curve.

namespace {

// Names of columns hold no spaces.
std::string joined(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

struct Column {
  std::string name;
  std::vector<double> values;
};

// All columns of strain after the frequency, then the same of displacement for entries and total.
std::vector<Column> columns_of(BudgetOn const& b) {
  NoiseTable const& t = b.table;
  std::vector<Column> all, moved;
  auto const metres = [&](std::string const& name, std::vector<double> values) {
    for (std::size_t i = 0; i < values.size() && !b.metres.empty(); ++i) values[i] *= b.metres[i];
    if (!b.metres.empty()) moved.push_back({joined(name) + "_displacement", std::move(values)});
  };
  for (BudgetEntry const& e : t.entries) {
    all.push_back({joined(e.name) + "_strain", e.asd});
    metres(e.name, e.asd);
  }
  all.push_back({"total_strain", t.total()});
  metres("total", t.total());
  for (DesignCurve const& c : b.curves) all.push_back({joined(c.name), c.asd});
  for (DesignCurve const& c : b.lines) all.push_back({joined(c.name) + "_strain", c.asd});
  all.insert(all.end(), moved.begin(), moved.end());
  for (BudgetEntry const& e : t.entries) {
    if (!e.sigma.empty()) all.push_back({joined(e.name) + "_sigma", e.sigma});
    for (BudgetBandColumn const& c : budget_band_columns)
      if (!(e.bands.*c.curve).empty()) all.push_back({joined(e.name) + "_" + c.name, e.bands.*c.curve});
  }
  if (auto sigma = t.total_sigma(); !sigma.empty()) all.push_back({"total_sigma", std::move(sigma)});
  for (auto const& [name, end] :
       {std::pair{"total_input_low", &BudgetBands::input_low}, {"total_input_high", &BudgetBands::input_high}})
    if (auto curve = t.total_at(end); !curve.empty()) all.push_back({name, std::move(curve)});
  return all;
}

}  // namespace

std::string budget_columns(BudgetView const& v) {
  std::vector<double> const& hz = v.grid.table.hz;
  std::string text = fmt::format(
      "# {}\n# straytrace {} ({})\n# ASD, one-sided: _strain [1/sqrt(Hz)], _displacement of the difference of the arms "
      "[m/sqrt(Hz)]; nan: not known\n# of stray light [1/sqrt(Hz)]: _sigma one standard error (Monte Carlo), "
      "_input_low, "
      "_input_high range due to stated input uncertainties,\n# _speckle_05, _50, _95 percentiles of one realisation\n# "
      "Hz",
      v.title, v.version, v.commit);
  std::vector<Column> const columns = columns_of(v.grid);
  for (Column const& c : columns) text += " " + c.name;
  text += '\n';
  for (std::size_t i = 0; i < hz.size(); ++i) {
    text += fmt::format("{:.9g}", hz[i]);
    for (Column const& c : columns) text += fmt::format(" {:.6e}", c.values[i]);
    text += '\n';
  }
  return text;
}

}  // namespace straytrace::results
