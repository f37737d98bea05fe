// SPDX-License-Identifier: BSD-3-Clause
// straytrace signal spectrogram, q.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/errors.hpp"
#include "cli/options.hpp"
#include "cli/signal/signal.hpp"
#include "session/options.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/files/unit_text.hpp"
#include "spectra/filters.hpp"
#include "spectra/spectrogram.hpp"

namespace straytrace::cli {
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
