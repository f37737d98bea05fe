// SPDX-License-Identifier: BSD-3-Clause
// straytrace couple taps: a hammer at many places, ranked per frequency.
#include "analysis/coupling/taps.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/text/words.hpp"
#include "cli/couple/couple.hpp"
#include "cli/options.hpp"
#include "results/results.hpp"
#include "results/text/columns.hpp"
#include "session/open_run.hpp"
#include "spectra/files/gps.hpp"

namespace straytrace::cli {
namespace {

struct TapOptions {
  DataOptions data;
  std::string force, target, force_unit, target_unit, list, quiet;
  std::vector<std::string> local;
  TapThresholds thresholds;
  std::size_t show = 12;
};

// With --segments only from the first stretch to the last: a flag may be active long before the data and after them.
TapSeries read_series(TapOptions const& o, std::vector<TapPlace> const& places, GpsSpan needed) {
  std::vector<NamedRecord> records{{o.force, o.force_unit}, {o.target, o.target_unit}};
  for (std::string const& l : o.local) records.push_back({l, ""});
  for (TapPlace const& p : places) needed = {std::min(needed.from, p.start), std::max(needed.to, p.start + p.duration)};
  std::vector<TimeSeries> all = averaged_records(o.data, records, o.data.segments.empty() ? GpsSpan{} : needed);
  TapSeries s{all[0], all[1], {}};
  s.local.assign(all.begin() + 2, all.end());
  return s;
}

// With --segments the places that hold data enough, from their first active sample to their last; `notes`: one on each
// other.
std::vector<TapPlace> active_places(std::vector<TapPlace> const& places, TapOptions const& o, WelchSettings const& w,
                                    double rate, std::vector<std::string>& notes) {
  if (o.data.segments.empty()) return places;
  ActiveSegments const active = segments_argument(o.data.segments);
  double const length = double(w.segment), step = length * (1 - w.overlap);
  std::vector<TapPlace> kept;
  for (TapPlace p : places) {
    std::vector<GpsSpan> const inside = active.within({p.start, p.start + p.duration});
    double segments = 0;
    for (GpsSpan const& s : inside)
      segments += std::max(0.0, std::floor(((s.to - s.from) * rate - length) / step + 1 + 1e-9));
    if (segments < fewest_tap_segments) {
      notes.push_back(fmt::format("'{}' at {} is left out: '{}' is active there for {:g} of {} segments", p.name,
                                  gps_text(p.start), active.source, segments, fewest_tap_segments));
      continue;
    }
    p.start = inside.front().from;
    p.duration = inside.back().to - p.start;
    kept.push_back(std::move(p));
  }
  if (kept.empty())
    throw InputError(fmt::format("'{}' leaves out all places of '{}'", active.source, o.list),
                     "choose another flag, or a shorter --segment");
  return kept;
}

std::string remark(TapAnswer const& a) {
  std::string text;
  if (std::isfinite(a.slope))
    text = fmt::format("slope {:.2f} ± {:.2g}{}", a.slope, a.slope_sigma, a.not_linear ? ": not linear" : "");
  if (!a.local.empty()) text += fmt::format("{}{} x {:.3g}", text.empty() ? "" : ", ", a.local, a.local_ratio);
  return text;
}

// The strongest peaks, in the order of frequency.
std::vector<TapPeak> strongest(std::vector<TapPeak> peaks, std::size_t count) {
  std::stable_sort(peaks.begin(), peaks.end(), [](TapPeak const& a, TapPeak const& b) {
    return a.places[0].target_ratio > b.places[0].target_ratio;
  });
  if (peaks.size() > count) peaks.resize(count);
  std::sort(peaks.begin(), peaks.end(), [](TapPeak const& a, TapPeak const& b) { return a.hz < b.hz; });
  return peaks;
}

std::string text_of(std::vector<TapPeak> const& peaks, TapOptions const& o, std::string const& unit) {
  if (peaks.empty()) return "no place raises the target\n";
  Columns table{{"frequency", "place", "target x", "force x", "ratio", "coupling [" + unit + "]", "lead", ""},
                {false, true, false, false, false, false, false, true},
                {}};
  for (TapPeak const& p : strongest(peaks, o.show)) {
    for (std::size_t i = 0; i < p.places.size(); ++i) {
      TapAnswer const& a = p.places[i];
      std::string const lead = i > 0 ? "" : std::isfinite(p.lead) ? fmt::format("{:.1f} σ", p.lead) : "alone";
      table.rows.push_back({i == 0 ? fmt::format("{:g} Hz", p.hz) : "", a.place, fmt::format("{:.3g}", a.target_ratio),
                            fmt::format("{:.3g}", a.force_ratio), plus_minus(a.ratio, a.sigma),
                            plus_minus(a.coupling, a.coupling_sigma), lead, remark(a)});
    }
    table.rows.emplace_back();
  }
  table.rows.pop_back();
  std::string text = aligned(table);
  if (peaks.size() > o.show)
    text += fmt::format("and {}: --show {}\n", counted(peaks.size() - o.show, "more peak"), peaks.size());
  return text;
}

CurveSheet sheet_of(std::vector<TapPeak> const& peaks, std::vector<TapPlace> const& places, std::string const& unit) {
  CurveSheet sheet;
  sheet.title = "places by their coupling";
  sheet.x = {"frequency", "Hz", {}};
  std::map<std::string, std::array<CurveColumn, 3>> columns;
  std::vector<double> const nothing(peaks.size(), not_a_number);
  for (TapPlace const& p : places)
    columns[p.name] = {CurveColumn{p.name, unit, nothing, "points"},
                       {p.name + "_sigma", unit, nothing, "hidden"},
                       {p.name + "_limit", unit, nothing, "upper-limit"}};
  for (std::size_t i = 0; i < peaks.size(); ++i) {
    sheet.x.values.push_back(peaks[i].hz);
    for (TapAnswer const& a : peaks[i].places) {
      columns[a.place][0].values[i] = a.coupling;
      columns[a.place][1].values[i] = a.coupling_sigma;
    }
    for (TapLimit const& l : peaks[i].limits) columns[l.place][2].values[i] = l.coupling;
  }
  for (auto& [name, three] : columns)
    for (CurveColumn& c : three) sheet.y.push_back(std::move(c));
  return sheet;
}

nlohmann::json json_of(std::vector<TapPeak> const& peaks) {
  nlohmann::json all = nlohmann::json::array();
  for (TapPeak const& p : peaks) {
    nlohmann::json places = nlohmann::json::array();
    for (TapAnswer const& a : p.places)
      places.push_back({{"place", a.place},
                        {"repeats", a.repeats},
                        {"target_ratio", a.target_ratio},
                        {"force_ratio", a.force_ratio},
                        {"ratio", a.ratio},
                        {"ratio_sigma", a.sigma},
                        {"coupling", a.coupling},
                        {"coupling_sigma", a.coupling_sigma},
                        {"significance", a.significance},
                        {"slope", number_or_null(a.slope)},
                        {"slope_sigma", number_or_null(a.slope_sigma)},
                        {"not_linear", a.not_linear},
                        {"local", a.local},
                        {"local_ratio", a.local_ratio}});
    nlohmann::json limits = nlohmann::json::array();
    for (TapLimit const& l : p.limits) limits.push_back({{"place", l.place}, {"coupling", l.coupling}});
    all.push_back({{"frequency", p.hz}, {"lead", number_or_null(p.lead)}, {"places", places}, {"limits", limits}});
  }
  return all;
}

int run_taps(TapOptions const& o) {
  check_outputs(o.data);
  std::vector<TapPlace> const places = parse_tap_list(read_text(o.list), o.list);
  GpsSpan const quiet = parse_gps(o.quiet);
  std::vector<FoundStretch> stretches{{"--quiet " + o.quiet, o.list, quiet.from, quiet.to}};
  for (TapPlace const& p : places)
    stretches.push_back({fmt::format("'{}' of {}", p.name, o.list), o.list, p.start, p.start + p.duration});
  refuse_overlaps(stretches);
  TapSeries const series = read_series(o, places, quiet);
  DataOptions data = o.data;
  if (data.segment.empty()) data.segment = "1 s";
  WelchSettings const w = welch_of(data, series.target);
  std::vector<std::string> left_out;
  std::vector<TapPlace> const used = active_places(places, o, w, series.target.rate, left_out);
  for (std::string const& note : left_out) print_warning(note, {o.data.format, o.data.quiet});
  std::vector<TapPeak> peaks = tap_peaks(series, used, quiet, w, o.thresholds);
  if (!o.data.band.empty()) {
    FrequencyBand const band = option_band(o.data.band, "--band");
    std::erase_if(peaks, [&](TapPeak const& p) { return p.hz < band.low || p.hz > band.high; });
  }
  std::string const unit = coupling_unit(series.target.unit, series.force.unit);
  CurveSheet sheet = sheet_of(peaks, used, unit);
  sheet.notes = {
      source_note(series.force), source_note(series.target),
      fmt::format("thresholds: target {:g} x and force {:g} x quiet; limits: 95 %, of places where only the force rose",
                  o.thresholds.target, o.thresholds.force)};
  if (!o.data.segments.empty()) sheet.notes.push_back(active_note(o.data, series.target));
  sheet.notes.insert(sheet.notes.end(), left_out.begin(), left_out.end());
  answer_with_result(o.data, sheet, text_of(peaks, o, unit), json_of(peaks));
  return 0;
}

}  // namespace

void add_couple_taps(CLI::App& couple, int& exit_code) {
  auto* const command =
      couple.add_subcommand("taps", "Rank places struck with a hammer by their coupling to the target.");
  auto const options = std::make_shared<TapOptions>();
  TapOptions& o = *options;
  command->add_option("--force", o.force, "FILE::CHANNEL of the hammer")->required();
  command->add_option("--target", o.target, "FILE::CHANNEL of strain, or of another disturbed signal")->required();
  command->add_option("--list", o.list, "CSV: place, start (GPS s), duration (s), optionally strength")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--quiet", o.quiet, "stretch A..B without taps")->required()->group("Data");
  add_segments_option(*command, o.data.segments);
  command->add_option("--local", o.local, "FILE::CHANNEL of an accelerometer nearby; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--force-unit", o.force_unit, "unit, where the file has none: N");
  command->add_option("--target-unit", o.target_unit, "unit, where the file has none: 1 for strain");
  add_ratio_option(*command, "--target-ratio", o.thresholds.target, "amplitude over quiet");
  add_ratio_option(*command, "--force-ratio", o.thresholds.force, "amplitude over quiet");
  add_significance_option(*command, o.thresholds.significance, "significance of the target, standard deviations");
  add_band_option(*command, o.data, "LOW..HIGH of the result");
  add_welch_options(*command, o.data);
  command->add_option("--show", o.show, "peaks of the table")->default_str("12")->check(whole_between(1, 1e6, "20"));
  add_output_options(*command, o.data, "--silent");  // --quiet names a stretch
  command->footer(
      "Examples:\n"
      "  straytrace couple taps --force examples/data/taps.csv::HAMMER --target examples/data/taps.csv::H --list "
      "examples/data/tap_list.csv --quiet 0..8\n"
      "  straytrace couple taps --force examples/data/taps.csv::HAMMER --target examples/data/taps.csv::H --list "
      "examples/data/tap_list.csv --quiet 0..8 --band \"20 Hz..45 Hz\" --format json");
  command->callback([options, &exit_code] { exit_code = run_taps(*options); });
}

}  // namespace straytrace::cli
