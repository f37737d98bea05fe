// SPDX-License-Identifier: BSD-3-Clause
// straytrace signal: spectra, transfer functions, displacement, maps of recorded data.
#include "cli/signal/signal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "cli/commands.hpp"
#include "results/results.hpp"
#include "results/text/columns.hpp"
#include "session/options.hpp"
#include "spectra/filters.hpp"
#include "spectra/welch.hpp"

namespace straytrace::cli {

std::string note_lines(std::vector<std::string> const& notes) {
  std::string text;
  for (std::string const& note : notes) text += note + "\n";
  return text;
}

void keep_band(CurveSheet& sheet, FrequencyBand band) {
  std::vector<double> const x = sheet.x.values;
  auto const kept = [&](CurveColumn& c) {
    std::vector<double> values;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (x[i] >= band.low * (1 - 1e-12) && x[i] <= band.high * (1 + 1e-12)) values.push_back(c.values[i]);
    c.values = std::move(values);
  };
  for (CurveColumn& c : sheet.y) kept(c);
  kept(sheet.x);
  if (sheet.x.values.empty())
    throw InputError(fmt::format("--band: no line between {:g} Hz and {:g} Hz", band.low, band.high),
                     "choose a wider band, or longer segments");
}

std::string some_rows(CurveSheet const& sheet, std::size_t count) {
  std::vector<double> const& x = sheet.x.values;
  std::size_t const first = sheet.log_x && x.size() > 1 && x[0] <= 0 ? 1 : 0;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < count && first < x.size(); ++i) {
    double const share = count > 1 ? double(i) / double(count - 1) : 0;
    double const at =
        sheet.log_x ? x[first] * std::pow(x.back() / x[first], share) : std::lerp(x[first], x.back(), share);
    auto const hit = std::min<std::ptrdiff_t>(std::lower_bound(x.begin(), x.end(), at * (1 - 1e-9)) - x.begin(),
                                              std::ptrdiff_t(x.size()) - 1);
    if (rows.empty() || rows.back() != std::size_t(hit)) rows.push_back(std::size_t(hit));
  }
  Columns table;
  table.titles.push_back(fmt::format("{} [{}]", sheet.x.name, sheet.x.unit));
  for (CurveColumn const& c : sheet.y)
    table.titles.push_back(c.unit.empty() || c.unit == "1" ? c.name : fmt::format("{} [{}]", c.name, c.unit));
  for (std::size_t const i : rows) {
    table.rows.push_back({fmt::format("{:.{}g}", x[i], sheet.x.unit == "s" ? 13 : 10)});  // GPS s to a millisecond
    for (CurveColumn const& c : sheet.y)
      table.rows.back().push_back(std::isfinite(c.values[i]) ? fmt::format("{:.4g}", c.values[i]) : "not known");
  }
  return aligned(table);
}

void add_signal(CLI::App& app, int& exit_code) {
  auto* const signal =
      app.add_subcommand("signal", "Analyse recorded data: spectra, transfer functions, displacement, maps.");
  signal->require_subcommand(1);
  add_signal_spectra(*signal, exit_code);
  add_signal_records(*signal, exit_code);
  add_signal_maps(*signal, exit_code);
  signal->footer(
      "Examples:\n"
      "  straytrace signal psd examples/data/bench.csv::acc --segment \"4 s\"\n"
      "  straytrace signal transfer examples/data/bench.csv::acc examples/data/bench.csv::bench --segment \"4 s\"\n"
      "Data are FILE or FILE::CHANNEL: columns of text, CSV, HDF5 of gwpy or GWOSC.");
}

// straytrace signal rms.

namespace {

struct RmsOptions : DataOptions {
  std::string file, stride;
};

int show_trend(RmsOptions const& o, TimeSeries const& s, FrequencyBand band) {
  RmsTrend const trend = rms_trend(s, band.low, band.high, option_quantity(o.stride, dim::time, "--stride", "10 s"));
  CurveSheet sheet{fmt::format("rms of {} from {:g} Hz to {:g} Hz", o.file, band.low, band.high),
                   {source_note(s),
                    "band-passed without phase, then rms of each stride; sigma: one standard error for Gaussian noise"},
                   {"time", "s", trend.time},
                   false,
                   true,
                   {{"rms", s.unit, trend.rms}, {"sigma", s.unit, trend.sigma, "hidden"}}};
  answer(o, sheet, note_lines(sheet.notes) + some_rows(sheet, 20));
  return done;
}

// The rms from each frequency up to the end of the band; the first row is that of the band.
CurveSheet rms_sheet(RmsOptions const& o, TimeSeries const& s, WelchSpectrum const& spectrum,
                     WelchSettings const& settings, FrequencyBand band, double filtered) {
  constexpr std::size_t most = 200;
  CurveSheet sheet{fmt::format("rms of {} from a frequency to {:g} Hz", o.file, band.high),
                   {source_note(s), welch_note(settings, s.rate, spectrum)},
                   {"frequency", "Hz", {}},
                   true,
                   true,
                   {{"high", "Hz", {}, "hidden"},
                    {"rms", s.unit, {}},
                    {"sigma", s.unit, {}, "hidden"},
                    {"rms of the filtered record", s.unit, {}, "hidden"}}};
  std::vector<double> lows{band.low};
  double last = 0;
  for (double const hz : spectrum.hz)
    if (hz > band.low && hz < band.high && hz > last * std::pow(s.rate / 2 / spectrum.hz[1], 1.0 / most))
      lows.push_back(last = hz);
  for (double const low : lows) {
    BandPower const p = band_power(spectrum, settings, low, band.high);
    sheet.x.values.push_back(low);
    bool const whole = low == band.low;
    for (auto const& [column, v] :
         {std::pair{0, band.high}, {1, p.rms()}, {2, p.rms_sigma()}, {3, whole ? filtered : not_a_number}})
      sheet.y[std::size_t(column)].values.push_back(v);
  }
  return sheet;
}

int show_rms(RmsOptions const& o) {
  check_outputs(o);
  TimeSeries const s = series_of(o, o.file);
  FrequencyBand const band = band_of(o, {0, s.rate / 2}, s.rate / 2);
  if (!o.stride.empty()) return show_trend(o, s, band);
  WelchSettings const settings = welch_of(o, s);
  WelchSpectrum const spectrum = welch(s.samples, s.rate, settings);
  BandPower const p = band_power(spectrum, settings, band.low, band.high);
  double const filtered = rms(band_passed(s, band.low, band.high).samples);
  CurveSheet const sheet = rms_sheet(o, s, spectrum, settings, band, filtered);
  answer(o, sheet,
         note_lines(sheet.notes) +
             fmt::format("{:g} Hz to {:g} Hz: rms {} {} from the PSD, {:.4g} {} of the band-passed record\n", band.low,
                         band.high, with_error(p.rms(), p.rms_sigma()), s.unit, filtered, s.unit));
  return done;
}

}  // namespace

void add_signal_rms(CLI::App& signal, int& exit_code) {
  auto const o = std::make_shared<RmsOptions>();
  CLI::App& c =
      *signal.add_subcommand("rms", "Compute the rms within a band, of the whole record or stride by stride.");
  c.add_option("data", o->file, "record: FILE or FILE::CHANNEL")->required();
  add_span_options(c, *o);
  add_band_option(c, *o, "default: 0 to half the sample rate");
  c.add_option("--stride", o->stride, "interval of a trend, one value for each: for example \"10 s\"");
  add_welch_options(c, *o);
  add_output_options(c, *o);
  c.footer(
      "Examples:\n"
      "  straytrace signal rms examples/data/bench.csv::acc --band \"5 Hz..20 Hz\"\n"
      "  straytrace signal rms examples/data/bench.csv::acc --band \"5 Hz..20 Hz\" --stride \"4 s\" -o trend.csv");
  c.callback([o, &exit_code] { exit_code = show_rms(*o); });
}

}  // namespace straytrace::cli
