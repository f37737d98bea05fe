// SPDX-License-Identifier: BSD-3-Clause
// straytrace couple impulse: ringing modes after impulse excitation; straytrace couple events: times of injections.
#include "analysis/coupling/impulse.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>

#include "analysis/coupling/taps.hpp"
#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "cli/couple/couple.hpp"
#include "cli/options.hpp"
#include "results/text/columns.hpp"
#include "spectra/files/gps.hpp"

namespace straytrace::cli {
namespace {

struct ImpulseOptions {
  DataOptions data;
  std::string force, target, force_unit, target_unit, list, length = "2 s", before = "10 ms";
  double threshold = 8;
  int modes = 3;
  bool sweeps = false;
};

std::string text_of(ImpulseResponse const& r, ImpulseOptions const& o, std::string const& unit) {
  std::string text =
      fmt::format("{} of {}\n", r.stretches == 1 ? "1 stretch" : fmt::format("{} stretches", r.stretches), o.length);
  if (r.modes.empty()) return text + "no mode above the noise\n";
  Columns table{{"frequency [Hz]", "Q", "rings for [s]", "amplitude [" + unit + "/s]", "chi^2"}, {}, {}};
  for (RingDown const& m : r.modes)
    table.rows.push_back({plus_minus(m.hz, m.hz_sigma), plus_minus(m.quality, m.quality_sigma),
                          plus_minus(m.tau, m.tau * m.quality_sigma / m.quality),
                          plus_minus(m.amplitude, m.amplitude_sigma),
                          fmt::format("{:.0f} of {}", m.chi_square, m.degrees)});
  return text + aligned(table);
}

nlohmann::json json_of(ImpulseResponse const& r) {
  nlohmann::json modes = nlohmann::json::array();
  for (RingDown const& m : r.modes)
    modes.push_back({{"frequency", m.hz},
                     {"frequency_sigma", m.hz_sigma},
                     {"quality", m.quality},
                     {"quality_sigma", m.quality_sigma},
                     {"tau", m.tau},
                     {"amplitude", m.amplitude},
                     {"amplitude_sigma", m.amplitude_sigma},
                     {"phase", m.phase},
                     {"chi_square", m.chi_square},
                     {"degrees", m.degrees}});
  return {{"stretches", r.stretches}, {"modes", modes}, {"response_sigma", r.value_sigma}};
}

int run_impulse(ImpulseOptions const& o) {
  check_outputs(o.data);
  auto const both = aligned({series_argument(o.force, o.force_unit, span_of(o.data)),
                             series_argument(o.target, o.target_unit, span_of(o.data))});
  ImpulseSettings s;
  s.length = option_quantity(o.length, dim::time, "--length", "2 s");
  s.before = option_quantity(o.before, dim::time, "--before", "10 ms");
  s.modes = o.modes;
  s.cut = !o.sweeps;
  FrequencyBand const band = band_of(o.data, {0, both[0].rate / 2}, both[0].rate / 2);
  s.low = band.low;
  s.high = band.high;
  std::vector<double> starts;
  if (o.list.empty())
    starts = find_taps(both[0], o.threshold, s.length);
  else
    for (TapPlace const& p : parse_tap_list(read_text(o.list), o.list)) starts.push_back(p.start);
  ImpulseResponse const r = impulse_response(both[0], both[1], starts, s);
  std::string const unit = coupling_unit(both[1].unit, both[0].unit);
  CurveSheet sheet;
  sheet.title = fmt::format("response of {} to an impulse", both[1].name);
  sheet.notes = {source_note(both[0]), source_note(both[1]),
                 fmt::format("{} stretches of {:g} s, divided by the force, damped by the coherence; one sigma {:.3g}",
                             r.stretches, s.length, r.value_sigma)};
  sheet.x = {"time", "s", r.time};
  sheet.log_x = sheet.log_y = false;
  sheet.y = {{"response", unit + "/s", r.value},
             {"response_sigma", unit + "/s", std::vector<double>(r.value.size(), r.value_sigma), "hidden"}};
  if (!r.modes.empty()) sheet.y.push_back({"modes", unit + "/s", r.ringing()});
  answer_with_result(o.data, sheet, text_of(r, o, unit), json_of(r));
  return 0;
}

struct EventOptions {
  DataOptions data;
  std::string record, quiet;
  EventSettings settings;
};

int run_events(EventOptions o) {
  check_outputs(o.data);
  TimeSeries const all = series_argument(o.record, o.data.unit, {});
  if (o.data.segment.empty()) o.data.segment = "1 s";
  o.settings.welch = welch_of(o.data, all);
  if (!o.data.band.empty()) {
    FrequencyBand const band = band_of(o.data, {}, all.rate / 2);
    o.settings.low = band.low;
    o.settings.high = band.high;
  }
  bool const part = !o.data.gps.empty() || !o.data.segments.empty();
  TimeSeries const searched = part ? cut(all, span_of(o.data)) : all;
  std::vector<LoudStretch> const events = find_events(searched, cut(all, parse_gps(o.quiet)), o.settings);
  Columns table{{"from", "to", "frequency", "x quiet", "significance", "with all looks", "bins"}, {}, {}};
  nlohmann::json list = nlohmann::json::array();
  for (LoudStretch const& e : events) {
    table.rows.push_back({gps_text(e.from), gps_text(e.to), fmt::format("{:g} Hz", e.hz),
                          fmt::format("{:.3g}", e.ratio), fmt::format("{:.1f}", e.significance),
                          fmt::format("{:.1f}", e.overall), std::to_string(e.bins)});
    list.push_back({{"from", e.from},
                    {"to", e.to},
                    {"frequency", e.hz},
                    {"ratio", e.ratio},
                    {"significance", e.significance},
                    {"overall_significance", e.overall},
                    {"bins", e.bins}});
  }
  CurveSheet sheet;
  sheet.title = "events of " + all.name;
  sheet.notes = {source_note(searched)};
  sheet.x = {"time", "s", {}};
  sheet.log_x = false;
  sheet.y = {{"frequency", "Hz", {}, "points"}, {"ratio", "1", {}, "hidden"}, {"significance", "1", {}, "hidden"}};
  for (LoudStretch const& e : events) {
    sheet.x.values.push_back(e.from);
    double const values[] = {e.hz, e.ratio, e.significance};
    for (std::size_t i = 0; i < 3; ++i) sheet.y[i].values.push_back(values[i]);
  }
  answer_with_result(o.data, sheet, events.empty() ? "no excess above the quiet stretch\n" : aligned(table), list);
  return 0;
}

}  // namespace

void add_couple_impulse(CLI::App& couple, int& exit_code) {
  auto* const command = couple.add_subcommand(
      "impulse", "Measure the response to impulse excitation in time, and frequency and Q of the modes.");
  auto const options = std::make_shared<ImpulseOptions>();
  ImpulseOptions& o = *options;
  command->add_option("--force", o.force, "FILE::CHANNEL of the hammer or drive")->required();
  command->add_option("--target", o.target, "FILE::CHANNEL of strain, or of another disturbed signal")->required();
  command->add_option("--force-unit", o.force_unit, "unit, where the file has none: N");
  command->add_option("--target-unit", o.target_unit, "unit, where the file has none: 1 for strain");
  add_gps_options(*command, o.data.gps, o.data.segments);
  command
      ->add_option("--list", o.list, "CSV with start times (place, start, duration) instead of a search for impulses")
      ->check(CLI::ExistingFile);
  command->add_flag("--sweeps", o.sweeps, "drive and response have ended at the end of each stretch");
  command->add_option("--length", o.length, "length of the stretch after each start")->default_str(o.length);
  command->add_option("--before", o.before, "silence before each start")->default_str(o.before);
  command->add_option("--threshold", o.threshold, "threshold of an impulse, in standard deviations of the force")
      ->default_str("8")
      ->check(number_between(0.0, 1e9, "8"));
  command->add_option("--modes", o.modes, "largest number of modes")
      ->default_str("3")
      ->check(whole_between(0, 100, "3"));
  add_band_option(*command, o.data, "LOW..HIGH searched for modes");
  add_output_options(*command, o.data, "--silent");  // --quiet names a stretch
  command->footer(
      "Examples:\n"
      "  straytrace couple impulse --force examples/data/taps.csv::HAMMER --target examples/data/taps.csv::H --gps "
      "26..32 "
      "--length \"1.5 s\"\n"
      "  straytrace couple impulse --force examples/data/taps.csv::HAMMER --target examples/data/taps.csv::H --gps "
      "26..32 "
      "--length \"1.5 s\" --band \"10 Hz..45 Hz\" --modes 1 -o response.txt");
  command->callback([options, &exit_code] { exit_code = run_impulse(*options); });
}

void add_couple_events(CLI::App& couple, int& exit_code) {
  auto* const command = couple.add_subcommand("events", "Find when a record rises above a quiet stretch of it.");
  auto const options = std::make_shared<EventOptions>();
  EventOptions& o = *options;
  command->add_option("record", o.record, "FILE::CHANNEL")->required();
  command->add_option("--quiet", o.quiet, "stretch A..B without injection")->required()->group("Data");
  add_span_options(*command, o.data);
  add_band_option(*command, o.data, "LOW..HIGH to search");
  add_welch_options(*command, o.data);
  command->add_option("--averages", o.settings.averages, "segments of each stretch")
      ->default_str("20")
      ->check(whole_between(2, 100000, "20"));
  add_significance_option(*command, o.settings.overall_significance,
                          "significance of an event, corrected for all bins and stretches");
  add_output_options(*command, o.data, "--silent");  // --quiet names a stretch
  command->footer(
      "Examples:\n"
      "  straytrace couple events examples/data/shaken.csv::H --quiet 0..24 --averages 8\n"
      "  straytrace couple events examples/data/shaken.csv::ACC --quiet 0..24 --averages 8 --band "
      "\"5 Hz..20 Hz\" --format json");
  command->callback([options, &exit_code] { exit_code = run_events(*options); });
}

}  // namespace straytrace::cli
