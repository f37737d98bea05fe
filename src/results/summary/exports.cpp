// SPDX-License-Identifier: BSD-3-Clause
// Files for other programs: h_asd.txt, paths.csv, JSON.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/text/json_text.hpp"
#include "results/curves/band.hpp"
#include "results/receivers/receivers.hpp"
#include "results/results.hpp"
#include "results/route_table/route_columns.hpp"
#include "results/text/columns.hpp"

namespace straytrace::results {

std::string file_header(RunContent const& run) {
  Provenance const& p = run.provenance;
  std::string title = run.title;
  std::replace(title.begin(), title.end(), '\n', ' ');  // a second line would not be a comment
  return fmt::format("# {}\n# {} {} ({}), created {}\n# model {}\n# seed {}, histories {}\n", title, p.program,
                     p.version, p.commit, p.created, run.model_hash, run.trace->coupling.seed,
                     run.trace->coupling.histories);
}

namespace {

// Below, totals state too small an error too often (docs/theory/blind.md, coverage of other statements).
constexpr std::uint64_t enough_histories = 16384;

}  // namespace

std::vector<std::string> RunContent::all_warnings() const {
  std::vector<std::string> all = warnings;
  all.insert(all.end(), trace->warnings.begin(), trace->warnings.end());
  if (noise) all.insert(all.end(), noise->warnings.begin(), noise->warnings.end());
  if (std::uint64_t const traced = trace->coupling.histories; traced > 0 && traced < enough_histories)
    all.push_back(
        fmt::format("{} histories are few: a run that misses a rare bright path also states too small an error. In "
                    "trials with 8192 the true total lay within two errors in 90 % of the runs, not in 95 %; trace {} "
                    "or more",
                    traced, enough_histories));
  return all;
}

std::vector<BalanceRow> balance_rows(BlockSums const& total) {
  std::vector<BalanceRow> rows = {{"emitted", estimate(total.emitted, total.histories, total.blocks)}};
  for (int i = 0; i < balance_term_count; ++i)
    rows.push_back(
        {name_of(BalanceTerm(i)), estimate(total.energy_balance[std::size_t(i)], total.histories, total.blocks)});
  return rows;
}

std::vector<ObjectRow> object_rows(TraceResult const& trace) {
  BlockSums const& total = trace.total;
  std::vector<std::string> const& groups = trace.coupling.groups;
  auto const at = [&](std::vector<Moments> const& list, std::size_t i) -> std::optional<Estimate> {
    if (i >= list.size()) return std::nullopt;
    return estimate(list[i], total.histories, total.blocks);
  };
  std::vector<ObjectRow> rows;
  for (std::size_t i = 0; i < std::max(groups.size(), total.absorbed.size()); ++i)
    rows.push_back({i < groups.size() ? groups[i] : "(in media)", at(total.arrived, i), at(total.absorbed, i)});
  return rows;
}

std::string reverse_words(bool on) {
  return on ? "C_rev on: a route and its reverse add in amplitude"
            : "C_rev off: reverse routes are not added in amplitude";
}

namespace {

using Json = nlohmann::ordered_json;

Json routes_json(PathTable const& table) {
  TableWriter<RouteRow> const list(route_columns(table));
  Json all = Json::array();
  for (PathRow const& row : table.rows) all.push_back(list.json_row({table, row}));
  return all;
}

Json origin(RunContent const& run) {
  Provenance const& p = run.provenance;
  return {{"program", p.program},
          {"version", p.version},
          {"commit", p.commit},
          {"created", p.created},
          {"model_hash", run.model_hash},
          {"seed", run.trace->coupling.seed},
          {"histories", run.trace->coupling.histories},
          {"reverse_routes", run.trace->coupling.reverse_routes}};
}

Json estimate_json(std::optional<Estimate> const& e) { return e ? error_json({e->mean, e->std_error}) : Json(nullptr); }

Json energy_balance(RunContent const& run) {
  Json energy_balance;
  for (BalanceRow const& row : balance_rows(run.trace->total)) energy_balance[row.name] = estimate_json(row.power);
  energy_balance["lost_histories"] = run.trace->total.lost;
  return energy_balance;
}

Json objects(RunContent const& run) {
  Json all = Json::array();
  for (ObjectRow const& row : object_rows(*run.trace))
    all.push_back(
        {{"name", row.name}, {"arriving", estimate_json(row.arriving)}, {"absorbed", estimate_json(row.absorbed)}});
  return all;
}

Json total_strain(PathTable const& table) {
  Json all = Json::array();
  for (std::size_t i = 0; i < table.total_strain.size(); ++i) {
    Json h = error_json(table.total_strain[i]);
    h["frequency_Hz"] = table.frequencies[i];
    if (BinLine const& line = table.lines[i]; !std::isnan(line.rms.value)) {
      h["line_rms"] = error_json(line.rms);
      h["line_rms"]["bin_Hz"] = {line.low, line.high};
    }
    all.push_back(h);
  }
  return all;
}

void add_receivers(Json& j, RunContent const& run) {
  if (run.trace->coupling.receivers.empty()) return;
  Json const table = read_ordered_json(receiver_json(receiver_table(run), run));
  j["beam_power_W"] = table["beam_power_W"];
  j["receivers"] = table["receivers"];
}

void add_positions(Json& j, NoiseBudget const& b, std::vector<double> const& frequencies) {
  PositionBand const band = position_band(b);
  for (std::size_t i = 0; !b.positions.empty() && i < frequencies.size(); ++i) {
    double const hz = frequencies[i];
    Json all = Json::array();
    for (PositionCurve const& p : b.positions)
      all.push_back({{"static_phase_deg", p.phase * 180 / pi}, {"h", band_at(p.asd, b.grid, hz)}});
    j["total_strain"][i]["positions"] = {{"body", b.scanned_body},
                                         {"lowest", band_at(band.low, b.grid, hz)},
                                         {"highest", band_at(band.high, b.grid, hz)},
                                         {"curves", std::move(all)}};
  }
}

void add_bands(Json& j, NoiseBudget const& b, std::vector<double> const& frequencies) {
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    double const hz = frequencies[i];
    Json& h = j["total_strain"][i];
    h["input"] = {band_at(b.bands.input_low, b.grid, hz), band_at(b.bands.input_high, b.grid, hz)};
    h["speckle_percentiles"] = {{"5", band_at(b.bands.speckle_05, b.grid, hz)},
                                {"50", band_at(b.bands.speckle_50, b.grid, hz)},
                                {"95", band_at(b.bands.speckle_95, b.grid, hz)}};
    h["coherent_sum"] = band_at(b.bands.coherent, b.grid, hz);
  }
  j["inputs"] = Json::array();
  for (SourceRow const& row : source_rows(b.bands)) j["inputs"].push_back(source_table().json_row(row));
  j["taken_as_exact"] = b.bands.taken_as_exact;
}

// Bytes of names that are not UTF-8 are replaced; they are never an error.
std::string dumped(Json const& j) { return json_text(j, 2) + "\n"; }

}  // namespace

std::string path_csv(PathTable const& table, RunContent const& run) {
  std::string text =
      file_header(run) + "# one row per ordered route; coupling: recoupled power fraction [1], C_rev not included\n";
  text += "# h: one-sided strain ASD [1/sqrt(Hz)], mean over random static phases; " +
          reverse_words(table.reverse_routes) + "\n";
  text +=
      fmt::format("# share_percent: of the resolved strain noise power between {} and {} Hz\n", table.low, table.high);
  text +=
      "# sigma: one standard error; phase_sensitivity: rms over paths, of rows 'other' weighted by noise; "
      "nan: not resolved or not computed, see status\n";
  text += "# input_low, input_high: what stated brackets and uncertainties of materials and motion leave open of h\n";
  TableWriter<RouteRow> const list(route_columns(table));
  text += list.csv_head();
  for (PathRow const& row : table.rows) text += list.csv_row({table, row});
  return text;
}

std::string path_json(PathTable const& table, RunContent const& run) {
  Json j;
  j["run"] = origin(run);
  j["band_Hz"] = {table.low, table.high};
  j["bound"] = bound_name(table.has_upper_bounds(), table.incomplete());
  j["lower_bound"] = j["bound"] == "lower";
  j["total_strain"] = total_strain(table);
  j["routes"] = routes_json(table);
  j["columns"] = TableWriter<RouteRow>(route_columns(table)).json_columns();
  j["objects"] = objects(run);
  add_receivers(j, run);
  return dumped(j);
}

// Strain in 1/sqrt(Hz); null: not resolved.
static Json seam_json(SeamCheck const& c) {
  auto const with_sigma = [](double value, double sigma) -> Json {
    if (std::isnan(value)) return nullptr;
    return {{"value", value}, {"sigma", sigma}};
  };
  auto const light = [&](SeamCheck::Light const& l) -> Json {
    return {{"strain", with_sigma(l.strain, l.strain_sigma)},
            {"other", with_sigma(l.other, l.other_sigma)},
            {"change", with_sigma(l.change, l.change_sigma)}};
  };
  return {{"frequency_hz", c.frequency}, {"crossover_rad", c.crossover}, {"other_crossover_rad", c.other_crossover},
          {"histories", c.histories},    {"baffles", light(c.baffles)},  {"total", light(c.total)}};
}

std::string summary_json(RunContent const& run, PathTable const& table) {
  Json j;
  j["title"] = run.title;
  j["run"] = origin(run);
  j["complete"] = !run.trace->checkpointed();
  if (run.noise) j["verdict"] = verdict_sentence(*run.noise, table.low, table.high);
  if (run.seam) j["seam"] = seam_json(*run.seam);
  j["bound"] = bound_name(table.has_upper_bounds(), table.incomplete());
  j["lower_bound"] = j["bound"] == "lower";
  j["total_strain"] = total_strain(table);
  if (run.noise) add_positions(j, *run.noise, table.frequencies);
  if (run.noise && run.noise->bands.made()) add_bands(j, *run.noise, table.frequencies);
  j["unresolved"] = Json::array();
  for (PathRow const& row : table.rows)
    if (!row.resolved) j["unresolved"].push_back({{"sequence", row.sequence}, {"why_not", row.why_not}});
  j["energy_balance"] = energy_balance(run);
  j["objects"] = objects(run);
  j["warnings"] = run.all_warnings();
  j["routes"] = routes_json(table);
  add_receivers(j, run);
  return dumped(j);
}

// h_asd.txt: the total over frequency, for other programs.

// Which bounds the total is.
static std::string bound_lines(NoiseBudget const& b) {
  std::size_t const bounds = bound_bins(b);
  bool const missing = !b.unresolved.empty(), neither = missing && bounds > 0;
  std::string text = missing ? "" : "# unresolved: none\n";
  if (missing)
    text += fmt::format("# {}: h contains the observed part of these unresolved routes, with an equal error:\n",
                        neither ? "NO BOUND" : "LOWER BOUND");
  for (std::string const& name : b.unresolved) text += "#   " + name + "\n";
  if (bounds == 0) return text;
  return text + fmt::format("# {}: in {} of {} bins {}\n", neither ? "CONTAINS UPPER BOUNDS" : "AT MOST", bounds,
                            b.grid.size(), neither ? "they contribute to h" : "h is an upper bound");
}

std::string asd_text(RunContent const& run) {
  if (!run.noise) throw InputError("this run has no noise yet", "write straytrace noise RUN_FILE -o FOLDER");
  NoiseBudget const& b = *run.noise;
  std::string text = file_header(run) + "# one-sided strain ASD, mean over random static phases\n# " +
                     reverse_words(run.trace->coupling.reverse_routes) + "\n";
  text += "# h_low, h_high: one standard error of the Monte Carlo\n";
  text += "# input_low, input_high: what stated brackets and uncertainties of materials and motion leave open\n";
  text += "# speckle_05, _50, _95: percentiles of one realisation of the static phases\n";
  text += fmt::format("# coherent: linear sum of the ASDs of {}, as if all were in phase{}\n",
                      b.unresolved.empty() ? "all routes" : "the resolved routes",
                      b.unresolved.empty() ? ": upper bound" : "");
  text += "# resolved: 1, or 0 where routes are unresolved\n";
  text += "# bound_share: part of h_mean^2 that is an upper bound (routes of kind edge)\n";
  if (!b.positions.empty())
    text += fmt::format(
        "# static_phase_...: '{}' at this phase, of {} positions over a quarter of the wavelength; positions_low, "
        "positions_high: their range\n",
        b.scanned_body, b.positions.size());
  text += "# design: " + (b.design.empty() ? "none" : b.design.front().name) + "; ratio = h_mean/design\n";
  text += bound_lines(b);
  text += "# units: frequency Hz, ratio 1, all others 1/sqrt(Hz)\n";
  text +=
      "# frequency_Hz h_mean h_low h_high input_low input_high speckle_05 speckle_50 speckle_95 resolved sigma "
      "phase_only amplitude_only coherent design ratio bound_share";
  for (PositionCurve const& p : b.positions) text += fmt::format(" static_phase_{:g}deg", p.phase * 180 / pi);
  text += b.positions.empty() ? "\n" : " positions_low positions_high\n";
  PositionBand const positions = position_band(b);
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    double const h = b.total.asd.at(i), s = b.total.sigma.at(i);
    double const design = b.design.empty() ? not_a_number : b.design.front().asd.at(i);
    auto const band = [&](std::vector<double> const& curve) { return curve.empty() ? not_a_number : curve.at(i); };
    NoiseBands const& d = b.bands;
    double const low = h < s ? 0 : h - s;  // nan stays nan: not resolved is not zero
    text += fmt::format("{:.9e} {:.9e} {:.9e} {:.9e}", b.grid.centre(i), h, low, h + s);
    for (auto const* curve : {&d.input_low, &d.input_high, &d.speckle_05, &d.speckle_50, &d.speckle_95})
      text += fmt::format(" {:.9e}", band(*curve));
    text += fmt::format(" {} {:.3e} {:.9e} {:.9e} {:.9e} {:.9e} {:.6e} {:.4g}", int(b.unresolved.empty()), s,
                        b.total.phase_asd.at(i), b.total.amplitude_asd.at(i), band(d.coherent), design, h / design,
                        b.total.bound_share.empty() ? 0 : b.total.bound_share.at(i));
    for (PositionCurve const& p : b.positions) text += fmt::format(" {:.9e}", p.asd.at(i));
    if (!b.positions.empty()) text += fmt::format(" {:.9e} {:.9e}", positions.low.at(i), positions.high.at(i));
    text += '\n';
  }
  return text;
}

// Files that appear complete or not at all.

void write_file(std::string const& file, std::string_view bytes) {
  AtomicFile temporary(file);
  temporary.write(bytes);
  temporary.publish();
}

void write_files(std::vector<std::pair<std::string, std::string>> const& files) {
  std::vector<std::unique_ptr<AtomicFile>> all;
  for (auto const& [file, bytes] : files) all.emplace_back(std::make_unique<AtomicFile>(file))->write(bytes);
  for (auto const& temporary : all) temporary->publish();
}

std::string read_file(std::string const& file) {
  FileBytes read = bytes_of_file(file);
  if (!read.why.empty())
    throw InputError(fmt::format("cannot read '{}': {}", file, read.why), remedy_for_unreadable(file));
  return std::move(read.bytes);
}

}  // namespace straytrace::results
