// SPDX-License-Identifier: BSD-3-Clause
// Options of all commands that work with data: which records, which stretch, how spectra are averaged, where results
// go.
#pragma once

#include <CLI/CLI.hpp>

#include <limits>
#include <string>
#include <vector>

#include "base/units/quantity.hpp"
#include "cli/options.hpp"
#include "results/curves/curve_file.hpp"
#include "spectra/files/series_file.hpp"
#include "spectra/welch.hpp"

namespace straytrace::cli {

// As written on the command line; the functions below report errors with the name of the option.
struct DataOptions {
  std::string unit, gps, segments, band, segment, overlap = "50 %", window = "hann", average = "mean",
                                                  detrend = "constant";
  std::vector<std::string> out;
  std::string format = "text";
  bool quiet = false;

  bool json() const { return format == "json"; }
};

void add_span_options(CLI::App&, DataOptions&);  // --unit, --gps, --segments
// --gps and --segments of options that are no DataOptions.
void add_gps_options(CLI::App&, std::string& gps, std::string& segments, std::string const& otherwise = "all");
void add_segments_option(CLI::App&, std::string& segments);
void add_band_option(CLI::App&, DataOptions&, std::string const& meaning);  // --band
void add_welch_options(CLI::App&, DataOptions&);  // --segment, --overlap, --window, --average, --detrend
// -o (repeatable), --format, and `quiet` for results only.
void add_output_options(CLI::App&, DataOptions&, char const* quiet = "--quiet");

// A number with a unit of this dimension: "8 s", "20 Hz", "50 %", "sqrt(2)*1 um". InputError names the option.
double option_quantity(std::string const& text, Dimension, std::string const& option, std::string const& example);
// The same; InputError unless it is above zero.
double positive_quantity(std::string const& text, Dimension, std::string const& option, std::string const& example);
CLI::Validator is_quantity(Dimension, std::string const& option, std::string const& example);
// FILE or FILE::CHANNEL of a file that exists. A word without colons may be a channel of another file.
CLI::Validator is_record(std::string const& option, bool or_channel = false);
struct FrequencyBand {
  double low = 0, high = 0;  // Hz
};
constexpr FrequencyBand any_band{0, std::numeric_limits<double>::infinity()};
constexpr FrequencyBand curve_band{lowest_frequency, highest_frequency};  // curves over the logarithm of frequency
// "20 Hz..80 Hz", or with a comma; low < high. InputError names the option, also where an end is not within `allowed`.
FrequencyBand option_band(std::string const& text, std::string const& option, FrequencyBand allowed = any_band);

// --gps, or the stretch in it where --segments are active without interruption.
GpsSpan requested_span(std::string const& gps, std::string const& segments);
GpsSpan span_of(DataOptions const&);
// --band, or `otherwise` where none is given; within 0 to half the rate.
FrequencyBand band_of(DataOptions const&, FrequencyBand otherwise, double nyquist_hz);
// FILE or FILE::CHANNEL, with --unit and --gps.
TimeSeries series_of(DataOptions const&, std::string const& argument);
// For averaged spectra, on a common clock; with --segments NaN outside of them.
struct NamedRecord {
  std::string argument, unit;
};
std::vector<TimeSeries> averaged_records(DataOptions const&, std::vector<NamedRecord> const&, GpsSpan,
                                         bool corrects = false);
// --segment, in s, which fits a record of that name and duration; without it 8 s, or an eighth of the record where that
// is shorter.
double segment_of(DataOptions const&, std::string const& record, double duration_s);
WelchSettings welch_of(DataOptions const&, TimeSeries const&);

// Lines for notes of curves: source with unit, rate and span; segments, window, averages.
std::string source_note(TimeSeries const&);
// "flags.txt: 20 s of 32 s are active"; empty without --segments.
std::string active_note(DataOptions const&, TimeSeries const&);
std::string welch_note(WelchSettings const&, double rate, std::size_t segments, double effective,
                       double noise_bandwidth);
std::string welch_note(WelchSettings const& settings, double rate, auto const& spectra) {
  return welch_note(settings, rate, spectra.segments, spectra.effective_averages, spectra.noise_bandwidth);
}

// Rejects endings before anything is computed. Writes all files of -o or none; prints their names on stderr unless
// --quiet.
void check_outputs(DataOptions const&);
void write_outputs(DataOptions const&, CurveSheet const&);
// The same, and when they are written `text` to stdout.
void write_and_print(DataOptions const&, CurveSheet const&, std::string const& text);
// The same; with --format json the JSON of the sheet instead of `text`.
void answer(DataOptions const&, CurveSheet const&, std::string const& text);
void answer(DataOptions const&, MapSheet const&, std::string const& text);

}  // namespace straytrace::cli
