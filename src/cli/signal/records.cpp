// SPDX-License-Identifier: BSD-3-Clause
// straytrace signal displacement, whiten, convert.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numeric>

#include "base/errors.hpp"
#include "cli/signal/signal.hpp"
#include "results/results.hpp"
#include "session/options.hpp"
#include "spectra/curve.hpp"
#include "spectra/files/unit_text.hpp"
#include "spectra/filters.hpp"
#include "spectra/welch.hpp"

namespace straytrace::cli {
namespace {

constexpr double usual_corner = 1;  // Hz

struct RecordOptions : DataOptions {
  std::vector<std::string> files;
  std::string to = "displacement", domain = "frequency", corner, rate;
  std::vector<std::string> notches;
  bool asd = false;
};

std::string summary(TimeSeries const& s) {
  auto const [low, high] = std::minmax_element(s.samples.begin(), s.samples.end());
  double const mean = std::accumulate(s.samples.begin(), s.samples.end(), 0.0) / double(s.samples.size());
  return fmt::format("{}: {} samples at {:g} Hz, mean {:.4g}, rms {:.4g}, from {:.4g} to {:.4g} {}\n", s.name,
                     s.samples.size(), s.rate, mean, rms(s.samples), *low, *high, s.unit);
}

CurveSheet sheet_of(std::vector<TimeSeries> const& all, std::string const& title,
                    std::vector<std::string> const& notes) {
  CurveSheet sheet{title, notes, {"time", "s", {}}, false, false, {}};
  for (std::size_t i = 0; i < all[0].samples.size(); ++i) sheet.x.values.push_back(all[0].time(i));
  for (TimeSeries const& s : all) sheet.y.push_back({s.name, s.unit, s.samples});
  return sheet;
}

// Records to stdout in short, and to files; HDF5 keeps the rate to the last bit.
void answer_records(DataOptions const& o, std::vector<TimeSeries> const& all, std::string const& title,
                    std::vector<std::string> const& notes) {
  CurveSheet const sheet = sheet_of(all, title, notes);
  std::string text = note_lines(notes);
  for (TimeSeries const& s : all) text += summary(s);
  DataOptions others = o;
  std::erase_if(others.out, [&](std::string const& file) {
    std::string const ending = std::filesystem::path(file).extension().string();
    if (ending != ".hdf5" && ending != ".h5") return false;
    write_file(file, series_hdf5(all));
    if (!o.quiet) std::cerr << fmt::format("wrote {}\n", file);
    return true;
  });
  answer(others, sheet, text);
}

int integrations(RecordOptions const& o, TimeSeries const& s) {
  int const times = integrations_to_displacement(s.unit) - (o.to == "velocity" ? 1 : 0);
  if (times < 0)
    throw InputError(fmt::format("'{}' in {} does not become a velocity by integration", s.name, s.unit),
                     "remove --to velocity");
  return times;
}

// eq. 11.3 line by line, with the confidence of the spectrum.
CurveSheet displacement_asd(RecordOptions const& o, TimeSeries const& s, int times) {
  WelchSettings const settings = welch_of(o, s);
  WelchSpectrum const spectrum = welch(s.samples, s.rate, settings);
  Interval const interval = confidence(spectrum);
  double const factor = parse_unit(s.unit)->si;
  std::string const unit = asd_unit(o.to == "velocity" ? "m/s" : "m");
  CurveSheet sheet{fmt::format("{} of {}", o.to, o.files[0]),
                   {source_note(s), welch_note(settings, s.rate, spectrum),
                    fmt::format("ASD/(2 pi f)^{}; low, high: 95 % confidence for Gaussian noise", times)},
                   {"frequency", "Hz", {}},
                   true,
                   true,
                   {{"asd", unit, {}}, {"asd low", unit, {}, "band-low"}, {"asd high", unit, {}, "band-high"}}};
  for (std::size_t k = 1; k < spectrum.hz.size(); ++k) {
    sheet.x.values.push_back(spectrum.hz[k]);
    for (auto const& [column, psd] : {std::pair{0, spectrum.psd[k]}, {1, interval.low[k]}, {2, interval.high[k]}})
      sheet.y[std::size_t(column)].values.push_back(factor * integrated_asd(std::sqrt(psd), spectrum.hz[k], times));
  }
  if (!o.band.empty()) keep_band(sheet, band_of(o, {}, s.rate / 2));
  return sheet;
}

TimeSeries in_si(TimeSeries s) {
  Quantity const unit = *parse_unit(s.unit);
  for (double& v : s.samples) v = to_si(v, unit);
  s.unit = unit.dimension == dim::length ? "m" : "m/s";
  return s;
}

int displacement(RecordOptions const& o) {
  check_outputs(o);
  TimeSeries const s = series_of(o, o.files[0]);
  int const times = integrations(o, s);
  if (o.asd) {
    CurveSheet const sheet = displacement_asd(o, s, times);
    answer(o, sheet, note_lines(sheet.notes) + some_rows(sheet, 12));
    return done;
  }
  std::string const title = fmt::format("{} of {}", o.to, o.files[0]);
  if (times == 0 && o.corner.empty()) {  // no growth towards low frequencies
    answer_records(o, {in_si(s)}, title, {source_note(s), "not integrated, so without a high pass"});
    return done;
  }
  double const corner = o.corner.empty() ? usual_corner : option_quantity(o.corner, dim::frequency, "--corner", "1 Hz");
  bool const causal = o.domain == "causal";
  TimeSeries const x = causal ? integrated_causal(s, times, corner) : integrated(s, times, corner);
  std::string const integrations =
      times == 0 ? "not integrated" : fmt::format("integrated {} time{}", times, times == 1 ? "" : "s");
  answer_records(o, {x}, title,
                 {source_note(s), fmt::format("{} {}, high pass at {:g} Hz{}; uncertain within {:g} s of {}",
                                              integrations, causal ? "sample by sample" : "in the frequency domain",
                                              corner, o.corner.empty() ? " (default)" : "", 1 / corner,
                                              causal ? "the beginning" : "both ends")});
  return done;
}

int whiten(RecordOptions const& o) {
  check_outputs(o);
  TimeSeries const s = series_of(o, o.files[0]);
  WelchSettings const settings = welch_of(o, s);
  answer_records(
      o, {whitened(s, settings)}, fmt::format("{}, whitened", o.files[0]),
      {source_note(s),
       fmt::format(
           "divided by its own ASD ({} of segments of {:g} s) and sqrt(2/rate); uncertain within {:g} s of both ends",
           o.average, double(settings.segment) / s.rate, double(settings.segment) / s.rate / 2)});
  return done;
}

TimeSeries filtered_as_asked(RecordOptions const& o, TimeSeries s) {
  if (!o.band.empty()) {
    FrequencyBand const band = band_of(o, {}, s.rate / 2);
    s = band_passed(s, band.low, band.high);
  }
  for (std::string const& notch : o.notches) s = notched(s, option_quantity(notch, dim::frequency, "--notch", "50 Hz"));
  if (o.rate.empty()) return s;
  double const rate = option_quantity(o.rate, dim::frequency, "--rate", "256 Hz"), factor = std::round(s.rate / rate);
  if (!(factor >= 1 && std::abs(s.rate / rate - factor) < 1e-9 * factor))
    throw InputError(fmt::format("--rate: {:g} Hz is not a whole fraction of {:g} Hz", rate, s.rate),
                     fmt::format("write for example --rate \"{:g} Hz\"", s.rate / 2));
  return decimated(s, std::size_t(factor));
}

int convert(RecordOptions const& o) {
  check_outputs(o);
  std::vector<TimeSeries> all;
  std::vector<std::string> notes;
  for (std::string const& file : o.files) {
    TimeSeries const s = series_of(o, file);
    notes.push_back(source_note(s));
    all.push_back(filtered_as_asked(o, s));
  }
  answer_records(o, aligned(all), fmt::format("{}", fmt::join(o.files, ", ")), notes);
  return done;
}

CLI::App& one_record(CLI::App& signal, char const* name, char const* what, std::shared_ptr<RecordOptions> const& o) {
  CLI::App& command = *signal.add_subcommand(name, what);
  command.add_option("data", o->files, "record: FILE or FILE::CHANNEL")->required()->expected(1);
  add_span_options(command, *o);
  return command;
}

void add_displacement(CLI::App& signal, int& exit_code) {
  auto const o = std::make_shared<RecordOptions>();
  CLI::App& c = one_record(signal, "displacement",
                           "Integrate an accelerometer or velocity meter to displacement: x = a/(2 pi f)^2.", o);
  c.add_option("--to", o->to, "displacement or velocity")
      ->check(CLI::IsMember({"displacement", "velocity"}))
      ->default_str(o->to);
  c.add_option("--domain", o->domain,
               "integration of the record: frequency (no phase error) or causal (from past samples)")
      ->check(CLI::IsMember({"frequency", "causal"}))
      ->default_str(o->domain);
  c.add_option("--corner", o->corner, "corner of the high pass; default: 1 Hz for an integrated record, else none");
  c.add_flag("--asd", o->asd, "compute the spectrum instead of the record");
  add_band_option(c, *o, "frequencies to show and write, for --asd");
  add_welch_options(c, *o);
  add_output_options(c, *o);
  c.footer(
      "Examples:\n"
      "  straytrace signal displacement examples/data/bench.csv::acc --corner \"2 Hz\" -o x.hdf5\n"
      "  straytrace signal displacement examples/data/bench.csv::acc --asd --segment \"4 s\"");
  c.callback([o, &exit_code] { exit_code = displacement(*o); });
}

}  // namespace

void add_signal_records(CLI::App& signal, int& exit_code) {
  add_displacement(signal, exit_code);
  auto const w = std::make_shared<RecordOptions>();
  CLI::App& white = one_record(signal, "whiten", "Whiten a record: equal power at all frequencies.", w);
  add_welch_options(white, *w);
  add_output_options(white, *w);
  white.footer(
      "Examples:\n"
      "  straytrace signal whiten examples/data/bench.csv::acc --segment \"2 s\" -o white.hdf5\n"
      "  straytrace signal whiten examples/data/bench.csv::acc --average median");
  white.callback([w, &exit_code] { exit_code = whiten(*w); });
  add_signal_rms(signal, exit_code);

  auto const o = std::make_shared<RecordOptions>();
  CLI::App& c =
      *signal.add_subcommand("convert", "Convert records from one format to another, with filters, on a common clock.");
  c.add_option("data", o->files, "records: FILE or FILE::CHANNEL")->required();
  add_span_options(c, *o);
  add_band_option(c, *o, "band pass without phase (Butterworth of order 4, both ways)");
  c.add_option("--notch", o->notches, "remove a line, without phase (Q 30); may be repeated")->allow_extra_args(false);
  c.add_option("--rate", o->rate, "reduce the sample rate, after a low pass without phase");
  add_output_options(c, *o);
  c.footer(
      "Examples:\n"
      "  straytrace signal convert examples/data/bench.csv::acc examples/data/bench.csv::bench -o bench.hdf5\n"
      "  straytrace signal convert examples/data/bench.csv::acc --notch \"50 Hz\" --rate \"64 Hz\" -o slow.txt");
  c.callback([o, &exit_code] { exit_code = convert(*o); });
}

}  // namespace straytrace::cli
