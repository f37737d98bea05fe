// SPDX-License-Identifier: BSD-3-Clause
#include "cli/data_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "base/errors.hpp"
#include "io/observatory_data.hpp"
#include "scene/expression.hpp"
#include "session/build_info.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/welch.hpp"

namespace straytrace::cli {
namespace {

template <class Value>
Value one_of(std::string const& text, std::initializer_list<std::pair<char const*, Value>> words) {
  for (auto const& [word, value] : words)
    if (text == word) return value;
  throw std::logic_error("an option was not checked: " + text);
}

template <class Sheet>
Sheet with_program(Sheet sheet) {
  sheet.notes.push_back(fmt::format("straytrace {} ({})", build_info::version, build_info::commit));
  return sheet;
}

double segment_in(std::string const& text) { return option_quantity(text, dim::time, "--segment", "8 s"); }

double overlap_in(std::string const& text) {
  double const overlap = option_quantity(text, dim::plain, "--overlap", "50 %");
  if (!(overlap >= 0 && overlap < 1))
    throw InputError(fmt::format("--overlap: '{}' is not from 0 to below 100 %", text), "write --overlap \"50 %\"");
  return overlap;
}

void say_written(DataOptions const& o) {
  if (o.quiet) return;
  for (std::string const& file : o.out) std::cerr << fmt::format("wrote {}\n", file);
}

}  // namespace

void add_span_options(CLI::App& command, DataOptions& o) {
  command.add_option("--unit", o.unit, "unit of the samples, where that of the file is missing or wrong: m/s^2");
  add_gps_options(command, o.gps, o.segments);
}

void add_gps_options(CLI::App& command, std::string& gps, std::string& segments, std::string const& otherwise) {
  command.add_option("--gps", gps, "stretch A..B in GPS seconds or UTC; default: " + otherwise)
      ->check(readable(parse_gps));
  add_segments_option(command, segments);
}

void add_segments_option(CLI::App& command, std::string& segments) {
  command
      .add_option("--segments", segments,
                  "FILE or FILE::FLAG of data quality: use data only where it is active; columns of text, LIGO_LW, "
                  "HDF5 or JSON")
      ->check(is_record("--segments"));
}

void add_band_option(CLI::App& command, DataOptions& o, std::string const& meaning) {
  command.add_option("--band", o.band, meaning)->check(readable([](std::string const& text) {
    option_band(text, "--band");
  }));
}

void add_welch_options(CLI::App& command, DataOptions& o) {
  command
      .add_option("--segment", o.segment,
                  "length of the segments that are averaged; default: 8 s, or 1/8 of the record")
      ->check(readable(segment_in));
  command.add_option("--overlap", o.overlap, "overlap of neighbouring segments")
      ->default_str(o.overlap)
      ->check(readable(overlap_in));
  command
      .add_option("--window", o.window,
                  "hann, hamming, blackman, blackmanharris, flattop, tukey(0.5), kaiser(14), rectangular")
      ->default_str(o.window)
      ->check(readable(parse_window));
  command.add_option("--average", o.average, "mean or median of the segments")
      ->check(CLI::IsMember({"mean", "median"}))
      ->default_str(o.average);
  command.add_option("--detrend", o.detrend, "trend removed from each segment: none, constant or linear")
      ->check(CLI::IsMember({"none", "constant", "linear"}))
      ->default_str(o.detrend);
}

void add_output_options(CLI::App& command, DataOptions& o, char const* quiet) {
  CLI::Option& out = *command
                          .add_option("-o,--out", o.out,
                                      "file to write, by its ending: .txt .csv .hdf5 .json .png .html; may be repeated")
                          ->allow_extra_args(false);
  mark_output(command, out);
  command.add_option("--format", o.format, "text or json")->check(CLI::IsMember({"text", "json"}));
  command.add_flag(quiet, o.quiet, "results only");
}

double option_quantity(std::string const& text, Dimension dimension, std::string const& option,
                       std::string const& example) {
  static ParameterLookup const none{[](std::string_view) { return ParameterLookup::Found{}; },
                                    [] { return std::vector<std::string>(); }};
  std::string why;
  try {
    auto const value = evaluate_expression(text, none);
    if (value && (value->quantity.dimension == dimension || value->bare_zero) && std::isfinite(value->quantity.si))
      return value->quantity.si;
    why = fmt::format("'{}' is not {}", text, described(dimension));
  } catch (ExpressionProblem const& problem) {
    why = fmt::format("'{}': {}", text, problem.what);
  }
  throw InputError(fmt::format("{}: {}", option, why), fmt::format("write {} \"{}\"", option, example));
}

double positive_quantity(std::string const& text, Dimension dimension, std::string const& option,
                         std::string const& example) {
  double const value = option_quantity(text, dimension, option, example);
  if (value > 0) return value;
  throw InputError(fmt::format("{}: '{}' is not positive", option, text),
                   fmt::format("write {} \"{}\"", option, example));
}

CLI::Validator is_quantity(Dimension dimension, std::string const& option, std::string const& example) {
  return readable([=](std::string const& text) { option_quantity(text, dimension, option, example); });
}

CLI::Validator is_record(std::string const& option, bool or_channel) {
  return readable([=](std::string const& text) {
    auto const colons = text.find("::");
    std::string const file = text.substr(0, colons);
    std::error_code unknown;
    if ((or_channel && colons == text.npos) || is_observatory_data(file) || std::filesystem::exists(file, unknown))
      return;
    throw InputError(fmt::format("{}: file '{}' does not exist", option, file), "check the name and the folder");
  });
}

FrequencyBand option_band(std::string const& text, std::string const& option, FrequencyBand allowed) {
  bool const dots = text.find("..") != text.npos;
  auto const mark = dots ? text.find("..") : text.find(',');
  std::string const example = allowed.low > 0 ? "5 Hz..5 kHz" : "20 Hz..80 Hz";
  if (mark == text.npos)
    throw InputError(fmt::format("{}: '{}' is not a band", option, text),
                     fmt::format("write {} \"{}\"", option, example));
  FrequencyBand const band{option_quantity(text.substr(0, mark), dim::frequency, option, example),
                           option_quantity(text.substr(mark + (dots ? 2 : 1)), dim::frequency, option, example)};
  if (!(band.low < band.high))
    throw InputError(fmt::format("{}: '{}' is not a rising range", option, text),
                     fmt::format("write {} \"{}\"", option, example));
  if (!(band.low >= allowed.low && band.high <= allowed.high))
    throw InputError(allowed.low > 0 ? fmt::format("{}: '{}' is not between 1 uHz and 1 MHz", option, text)
                                     : fmt::format("{}: '{}' begins below 0", option, text),
                     fmt::format("write {} \"{}\"", option, example));
  return band;
}

GpsSpan requested_span(std::string const& gps, std::string const& segments) {
  GpsSpan const span = gps.empty() ? GpsSpan{} : parse_gps(gps);
  return segments.empty() ? span : only_stretch(segments_argument(segments), span);
}

GpsSpan span_of(DataOptions const& o) { return requested_span(o.gps, o.segments); }

FrequencyBand band_of(DataOptions const& o, FrequencyBand otherwise, double nyquist_hz) {
  FrequencyBand const band = o.band.empty() ? otherwise : option_band(o.band, "--band");
  if (band.high > nyquist_hz * (1 + 1e-12))
    throw InputError(fmt::format("--band: {:g} Hz is above {:g} Hz, half the sample rate", band.high, nyquist_hz),
                     "end the band there");
  return band;
}

TimeSeries series_of(DataOptions const& o, std::string const& argument) {
  return series_argument(argument, o.unit, span_of(o), true);
}

namespace {

bool has_gaps(TimeSeries const& s) {
  return std::ranges::any_of(s.samples, [](double x) { return std::isnan(x); });
}

// A filter would spread the gaps of the faster record.
void refuse_gaps_at_other_rates(std::vector<TimeSeries> const& all) {
  for (TimeSeries const& s : all)
    if (s.rate != all.front().rate && std::ranges::any_of(all, has_gaps))
      throw InputError(fmt::format("records with gaps at {:g} and {:g} Hz", all.front().rate, s.rate),
                       "reduce the rate of the faster one in stretches without gaps: straytrace signal convert --rate");
}

}  // namespace

std::vector<TimeSeries> averaged_records(DataOptions const& o, std::vector<NamedRecord> const& records, GpsSpan span,
                                         bool corrects) {
  bool const masked = !o.segments.empty();
  ActiveSegments const active = masked ? segments_argument(o.segments) : ActiveSegments{};
  if (masked) {
    auto const inside = active.within(span);
    span = inside.size() < 2 ? only_stretch(active, span) : GpsSpan{inside.front().from, inside.back().to};
  }
  std::vector<TimeSeries> all;
  for (auto const& [argument, unit] : records)
    all.push_back(series_argument(argument, unit, span, corrects, masked ? Gaps::kept : Gaps::refused));
  refuse_gaps_at_other_rates(all);
  all = aligned(all);
  if (masked)
    for (TimeSeries& s : all) leave_out_inactive(s, active);
  return all;
}

double segment_of(DataOptions const& o, std::string const& name, double duration) {
  double const seconds = o.segment.empty() ? std::min(8.0, duration / 8) : segment_in(o.segment);
  if (seconds > duration * (1 + 1e-9))
    throw InputError(
        fmt::format("--segment: {:g} s are longer than the record '{}' of {:g} s", seconds, name, duration),
        "choose a shorter one");
  return seconds;
}

WelchSettings welch_of(DataOptions const& o, TimeSeries const& s) {
  double const seconds = segment_of(o, s.name, s.duration()), samples = std::round(seconds * s.rate);
  if (!(samples >= 2))
    throw InputError(fmt::format("--segment: {:g} s contain fewer than two samples at {:g} Hz", seconds, s.rate),
                     "choose a longer one");
  NamedWindow const window = parse_window(o.window);
  return {std::size_t(samples),
          overlap_in(o.overlap),
          window.window,
          window.parameter,
          one_of<Detrend>(o.detrend,
                          {{"none", Detrend::none}, {"constant", Detrend::constant}, {"linear", Detrend::linear}}),
          one_of<Average>(o.average, {{"mean", Average::mean}, {"median", Average::median}})};
}

std::string source_note(TimeSeries const& s) {
  return fmt::format("{}: {:g} Hz, unit {}, {:g} s from GPS {} ({})", s.name, s.rate, s.unit, s.duration(),
                     gps_text(s.start), utc_of_gps(s.start));
}

std::string active_note(DataOptions const& o, TimeSeries const& s) {
  if (o.segments.empty()) return "";
  auto const used = double(std::ranges::count_if(s.samples, [](double x) { return !std::isnan(x); }));
  return fmt::format("{}: {:g} s of {:g} s are active", o.segments, used / s.rate, s.duration());
}

std::string welch_note(WelchSettings const& w, double rate, std::size_t segments, double effective,
                       double noise_bandwidth) {
  return fmt::format(
      "one-sided; {} of {} segments of {:g} s, overlap {:g} %, {:.4g} independent; window {}, ENBW {:.6g} Hz",
      w.average == Average::mean ? "mean" : "median", segments, double(w.segment) / rate, 100 * w.overlap, effective,
      window_text({w.window, w.window_parameter}), noise_bandwidth);
}

void check_outputs(DataOptions const& o) {
  for (std::string const& file : o.out) check_curve_ending(file);
}

void write_outputs(DataOptions const& o, CurveSheet const& sheet) { write_and_print(o, sheet, ""); }

void write_and_print(DataOptions const& o, CurveSheet const& sheet, std::string const& text) {
  write_curves(o.out, with_program(sheet));
  std::cout << text;
  say_written(o);
}

void answer(DataOptions const& o, CurveSheet const& sheet, std::string const& text) {
  write_and_print(o, sheet, o.json() ? curve_json(with_program(sheet)) : text);
}

void answer(DataOptions const& o, MapSheet const& map, std::string const& text) {
  write_map(o.out, with_program(map));
  std::cout << (o.json() ? curve_json(with_program(map)) : text);
  say_written(o);
}

}  // namespace straytrace::cli
