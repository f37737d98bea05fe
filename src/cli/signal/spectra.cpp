// SPDX-License-Identifier: BSD-3-Clause
// straytrace signal psd, coherence, transfer, and maps of time and frequency.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "cli/options.hpp"
#include "cli/signal/signal.hpp"
#include "session/options.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/files/unit_text.hpp"
#include "spectra/filters.hpp"
#include "spectra/welch.hpp"

namespace straytrace::cli {
namespace {

constexpr std::size_t rows_shown = 12;

struct SpectrumOptions : DataOptions {
  std::vector<std::string> files;
  bool power = false;
  double confidence = 0.95;
  std::string estimator = "h1", output_unit;
};

GpsSpan written_span(SpectrumOptions const& o) { return o.gps.empty() ? GpsSpan{} : parse_gps(o.gps); }

CurveSheet frequency_sheet(std::string title, std::vector<double> hz) {
  return {std::move(title), {}, {"frequency", "Hz", std::move(hz)}, true, true, {}};
}

void finish(SpectrumOptions const& o, CurveSheet sheet, double nyquist) {
  if (!o.band.empty()) keep_band(sheet, band_of(o, {}, nyquist));
  answer(o, sheet, note_lines(sheet.notes) + some_rows(sheet, rows_shown));
}

// Columns of one record: the density and both ends of its confidence interval.
void add_density(SpectrumOptions const& o, TimeSeries const& s, WelchSpectrum const& spectrum, CurveSheet& sheet) {
  Interval const interval = confidence(spectrum, o.confidence);
  std::string const kind = o.power ? "psd" : "asd",
                    name = o.files.size() > 1 ? fmt::format("{} {}", s.name, kind) : kind;
  std::string const unit = o.power ? psd_unit(s.unit) : asd_unit(s.unit);
  auto const column = [&](std::string const& ending, std::vector<double> values, char const* style) {
    for (double& v : values) v = o.power ? v : std::sqrt(v);
    sheet.y.push_back({name + ending, unit, std::move(values), style});
  };
  column("", spectrum.psd, "line");
  column(" low", interval.low, "band-low");
  column(" high", interval.high, "band-high");
}

int psd(SpectrumOptions const& o) {
  check_outputs(o);
  CurveSheet sheet;
  double nyquist = 0;
  for (std::string const& file : o.files) {
    TimeSeries const s = averaged_records(o, {{file, o.unit}}, written_span(o), true)[0];
    WelchSettings const settings = welch_of(o, s);
    WelchSpectrum const spectrum = welch(s.samples, s.rate, settings);
    if (sheet.y.empty())
      sheet = frequency_sheet(fmt::format("{} of {}", o.power ? "PSD" : "ASD", fmt::join(o.files, ", ")), spectrum.hz);
    if (sheet.x.values != spectrum.hz)
      throw InputError(fmt::format("'{}' and '{}' have different frequencies", file, o.files[0]),
                       "give both the same --segment and rate, or write two files");
    add_density(o, s, spectrum, sheet);
    sheet.notes.push_back(source_note(s));
    if (!o.segments.empty()) sheet.notes.push_back(active_note(o, s));
    sheet.notes.push_back(welch_note(settings, s.rate, spectrum));
    nyquist = s.rate / 2;
  }
  sheet.notes.push_back(fmt::format("low, high: {:g} % confidence for Gaussian noise", 100 * o.confidence));
  finish(o, std::move(sheet), nyquist);
  return done;
}

struct Pair {
  TimeSeries input, output;
  WelchSettings settings;
  CrossSpectra spectra;
  std::vector<std::string> notes;
};

Pair read_pair(SpectrumOptions const& o) {
  check_outputs(o);
  std::string const unit_of_output = o.output_unit.empty() ? o.unit : o.output_unit;
  std::vector<TimeSeries> const both =
      averaged_records(o, {{o.files[0], o.unit}, {o.files[1], unit_of_output}}, written_span(o));
  Pair p{both[0], both[1], welch_of(o, both[0]), {}, {}};
  p.spectra = cross_spectra(p.input.samples, p.output.samples, p.input.rate, p.settings);
  p.notes = {"input " + source_note(p.input), "output " + source_note(p.output),
             welch_note(p.settings, p.input.rate, p.spectra)};
  if (!o.segments.empty()) p.notes.push_back(active_note(o, p.input));
  if (p.spectra.effective_averages < 2)
    throw InputError("a coherence needs at least two segments; with one it is 1 everywhere",
                     "choose a shorter --segment");
  return p;
}

int show_coherence(SpectrumOptions const& o) {
  Pair const p = read_pair(o);
  double const n = p.spectra.effective_averages, level = coherence_level(n, 1 - o.confidence);
  CurveSheet sheet = frequency_sheet(fmt::format("coherence of {} and {}", o.files[0], o.files[1]), p.spectra.hz);
  std::vector<double> const c = coherence(p.spectra);
  Interval const interval = coherence_interval(c, n, o.confidence);
  sheet.log_y = false;
  sheet.notes = p.notes;
  sheet.notes.push_back(
      fmt::format("level {:.6g}: independent records exceed it with probability {:g}; low, high: {:g} % confidence",
                  level, 1 - o.confidence, 100 * o.confidence));
  sheet.y = {{"coherence", "1", c},
             {"low", "1", interval.low, "band-low"},
             {"high", "1", interval.high, "band-high"},
             {"level", "1", std::vector<double>(c.size(), level)}};
  finish(o, std::move(sheet), p.input.rate / 2);
  return done;
}

int show_transfer(SpectrumOptions const& o) {
  Pair const p = read_pair(o);
  bool const first = o.estimator == "h1";
  TransferEstimate const t = first ? h1(p.spectra) : h2(p.spectra);
  CurveSheet sheet =
      frequency_sheet(fmt::format("{} from {} to {}", first ? "H1" : "H2", o.files[0], o.files[1]), t.hz);
  std::string const unit = ratio_unit(p.output.unit, p.input.unit);
  std::size_t const n = t.hz.size();
  std::vector<double> const nothing(n, not_a_number);
  CurveColumn modulus{"modulus", unit, {}, "points"}, modulus_low{"modulus_low", unit, nothing, "band-low"},
      modulus_high{"modulus_high", unit, nothing, "band-high"}, phase{"phase", "deg", {}, "points"},
      phase_low{"phase_low", "deg", nothing, "band-low"}, phase_high{"phase_high", "deg", nothing, "band-high"},
      phase_sigma{"phase_sigma", "deg", {}, "hidden"};
  for (std::size_t k = 0; k < n; ++k) {
    double const size = std::abs(t.value[k]), angle = std::arg(t.value[k]) * 180 / pi;
    modulus.values.push_back(size);
    phase.values.push_back(angle);
    phase_sigma.values.push_back(t.phase_sigma[k] * 180 / pi);
    double const radius = confidence_radius(t.coherence[k], p.spectra.effective_averages, o.confidence);
    if (!(radius < 1)) continue;
    double const turn = std::asin(radius) * 180 / pi;
    modulus_low.values[k] = size * (1 - radius);
    modulus_high.values[k] = size * (1 + radius);
    phase_low.values[k] = angle - turn;
    phase_high.values[k] = angle + turn;
  }
  sheet.notes = p.notes;
  sheet.notes.push_back(
      "sigma: one standard error from coherence and averages; phase of exp(+2 pi i f t): a delay falls");
  sheet.notes.push_back(fmt::format(
      "low, high: {:g} % confidence, where the coherence is above the level of chance; elsewhere a point is faint",
      100 * o.confidence));
  sheet.y = {modulus,   modulus_low, modulus_high, {"modulus_sigma", unit, t.modulus_sigma, "hidden"}, phase,
             phase_low, phase_high,  phase_sigma,  {"coherence", "1", t.coherence, "hidden"}};
  finish(o, std::move(sheet), p.input.rate / 2);
  return done;
}

CLI::App& common(CLI::App& signal, char const* name, char const* what, std::shared_ptr<SpectrumOptions> const& o) {
  CLI::App& command = *signal.add_subcommand(name, what);
  add_span_options(command, *o);
  add_band_option(command, *o, "frequencies to show and write: \"10 Hz..1 kHz\"; default: all");
  add_welch_options(command, *o);
  command.add_option("--confidence", o->confidence, "of intervals and levels")
      ->check(number_between(0.01, 0.9999, "0.95"))
      ->default_str("0.95");
  add_output_options(command, *o);
  return command;
}

CLI::App& with_pair(CLI::App& signal, char const* name, char const* what, std::shared_ptr<SpectrumOptions> const& o) {
  CLI::App& command = common(signal, name, what, o);
  command.add_option("data", o->files, "input and output: FILE or FILE::CHANNEL")->required()->expected(2);
  command.add_option("--output-unit", o->output_unit, "unit of the output, where it differs from --unit");
  return command;
}

}  // namespace

void add_signal_spectra(CLI::App& signal, int& exit_code) {
  auto const o = std::make_shared<SpectrumOptions>();
  CLI::App& density = common(signal, "psd", "Estimate the one-sided amplitude or power spectral density.", o);
  density.add_option("data", o->files, "records: FILE or FILE::CHANNEL")->required();
  density.add_flag("--power", o->power, "power densities instead of amplitude densities");
  density.footer(
      "Examples:\n"
      "  straytrace signal psd examples/data/bench.csv::acc --segment \"4 s\"\n"
      "  straytrace signal psd examples/data/bench.csv::acc --average median --band \"5 Hz..50 Hz\" -o acc.hdf5");
  density.callback([o, &exit_code] { exit_code = psd(*o); });

  auto const c = std::make_shared<SpectrumOptions>();
  CLI::App& coherent =
      with_pair(signal, "coherence", "Estimate the coherence of two records, with the chance level.", c);
  coherent.footer(
      "Examples:\n"
      "  straytrace signal coherence examples/data/bench.csv::acc examples/data/bench.csv::bench --segment \"4 s\"\n"
      "  straytrace signal coherence examples/data/bench.csv::1 examples/data/bench.csv::2 -o coherence.csv");
  coherent.callback([c, &exit_code] { exit_code = show_coherence(*c); });

  auto const t = std::make_shared<SpectrumOptions>();
  CLI::App& ratio =
      with_pair(signal, "transfer", "Estimate the transfer function from one record to another, with errors.", t);
  ratio.add_option("--estimator", t->estimator, "h1: noise in the output; h2: noise in the input")
      ->check(CLI::IsMember({"h1", "h2"}))
      ->default_str(t->estimator);
  ratio.footer(
      "Examples:\n"
      "  straytrace signal transfer examples/data/bench.csv::acc examples/data/bench.csv::bench --segment \"4 s\"\n"
      "  straytrace signal transfer examples/data/bench.csv::1 examples/data/bench.csv::2 --estimator h2 -o h.txt");
  ratio.callback([t, &exit_code] { exit_code = show_transfer(*t); });
}

// straytrace signal spectrogram, q.

namespace {

struct MapOptions : DataOptions {
  std::vector<std::string> files;
  std::string stride, normalise = "none";
  double q = 12;
};

MapSheet map_of(Spectrogram const& s, FrequencyBand band, std::string title, std::string unit,
                std::vector<std::string> notes) {
  MapSheet map{std::move(title), std::move(unit), std::move(notes), s.time, {}, {}, {}, {}};
  auto const inside = [&](double f) { return f >= band.low * (1 - 1e-12) && f <= band.high * (1 + 1e-12); };
  std::copy_if(s.hz.begin(), s.hz.end(), std::back_inserter(map.frequency), inside);
  if (map.frequency.empty())
    throw InputError(fmt::format("--band: no line between {:g} Hz and {:g} Hz", band.low, band.high),
                     "choose a wider band, or longer segments");
  for (std::size_t i = 0; i < s.time.size(); ++i)
    for (std::size_t k = 0; k < s.hz.size(); ++k)
      if (inside(s.hz[k])) map.value.push_back(s.at(i, k));
  return map;
}

std::string loudest(MapSheet const& map, std::string const& what) {
  auto const top = std::max_element(map.value.begin(), map.value.end());
  auto const at = std::size_t(top - map.value.begin()), width = map.frequency.size();
  return fmt::format(
      "{} times of {:g} s, {} frequencies from {:g} Hz to {:g} Hz\nlargest {}: {:.4g} {} at GPS {} and {:.6g} Hz\n",
      map.time.size(), map.time.size() > 1 ? map.time[1] - map.time[0] : 0, width, map.frequency.front(),
      map.frequency.back(), what, *top, map.unit == "1" ? "" : map.unit, gps_text(map.time[at / width]),
      map.frequency[at % width]);
}

int show_spectrogram(MapOptions const& o) {
  check_outputs(o);
  TimeSeries const s = series_of(o, o.files[0]);
  DataOptions settings = o;
  if (o.segment.empty()) settings.segment = fmt::format("{} s", std::min(1.0, s.duration() / 32));
  WelchSettings const w = welch_of(settings, s);
  double const segment = double(w.segment) / s.rate;
  double const stride =
      o.stride.empty() ? std::min(2 * segment, s.duration()) : option_quantity(o.stride, dim::time, "--stride", "2 s");
  Spectrogram map = spectrogram(s, stride, w);
  bool const flat = o.normalise == "median";
  if (flat) map = normalised(std::move(map));
  MapSheet const sheet = map_of(
      map, band_of(o, {0, s.rate / 2}, s.rate / 2),
      fmt::format("{} of {}", flat ? "ASD over its median" : "ASD", o.files[0]), flat ? "1" : asd_unit(s.unit),
      {source_note(s), fmt::format("one-sided ASD of strides of {:g} s, segments of {:g} s, overlap {}, window {}",
                                   stride, segment, o.overlap, o.window)});
  answer(o, sheet, note_lines(sheet.notes) + loudest(sheet, flat ? "ratio" : "ASD"));
  return done;
}

int show_q(MapOptions const& o) {
  check_outputs(o);
  TimeSeries const s = series_of(o, o.files[0]);
  double const top = s.rate / 2 / (1 + std::sqrt(11) / o.q), bottom = 4 * o.q / s.duration();
  FrequencyBand const band = band_of(o, {std::min(bottom, top / 2), top}, s.rate / 2);
  WelchSettings const w = welch_of(o, s);
  Spectrogram const map = q_transform(whitened(s, w), {o.q, band.low, band.high});
  MapSheet const sheet =
      map_of(map, band, fmt::format("Q transform of {}", o.files[0]), "1",
             {source_note(s),
              fmt::format("constant-Q tiles, Q {:g}, of the record whitened by its ASD ({} of segments of {:g} s)", o.q,
                          o.average, double(w.segment) / s.rate),
              "energy over its median/ln 2 in each row: Gaussian noise exceeds e with probability exp(-e) in a tile"});
  answer(o, sheet, note_lines(sheet.notes) + loudest(sheet, "energy"));
  return done;
}

CLI::App& map_of_record(CLI::App& signal, char const* name, char const* what, std::shared_ptr<MapOptions> const& o) {
  CLI::App& command = *signal.add_subcommand(name, what);
  command.add_option("data", o->files, "record: FILE or FILE::CHANNEL")->required()->expected(1);
  add_span_options(command, *o);
  add_welch_options(command, *o);
  add_output_options(command, *o);
  return command;
}

}  // namespace

void add_signal_maps(CLI::App& signal, int& exit_code) {
  auto const o = std::make_shared<MapOptions>();
  CLI::App& s = map_of_record(signal, "spectrogram", "Compute the amplitude spectral density against time.", o);
  add_band_option(s, *o, "frequencies to show and write; default: all");
  s.add_option("--stride", o->stride, "time of each spectrum; default: two segments");
  s.add_option("--normalise", o->normalise, "median: each frequency over its median in time")
      ->check(CLI::IsMember({"none", "median"}))
      ->default_str(o->normalise);
  s.footer(
      "Examples:\n"
      "  straytrace signal spectrogram examples/data/bench.csv::acc --segment \"1 s\" --stride \"2 s\"\n"
      "  straytrace signal spectrogram examples/data/bench.csv::acc --normalise median -o map.hdf5");
  s.callback([o, &exit_code] { exit_code = show_spectrogram(*o); });

  auto const t = std::make_shared<MapOptions>();
  t->average = "median";
  CLI::App& q = map_of_record(signal, "q", "Find short bursts by their energy in tiles of constant Q.", t);
  add_band_option(q, *t, "of the tiles");
  q.add_option("--q", t->q, "centre frequency of a tile over its bandwidth")
      ->check(number_between(3.4, 1000.0, "12"))
      ->default_str("12");
  q.footer(
      "Examples:\n"
      "  straytrace signal q examples/data/bench.csv::acc --band \"5 Hz..40 Hz\"\n"
      "  straytrace signal q examples/data/bench.csv::bench --q 6 --band \"10 Hz..40 Hz\" -o q.csv");
  q.callback([t, &exit_code] { exit_code = show_q(*t); });
}

}  // namespace straytrace::cli
