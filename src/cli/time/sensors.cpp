// SPDX-License-Identifier: BSD-3-Clause
// straytrace sensors: what photodiodes and quadrants on the beams of a run read of its stray light.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "base/errors.hpp"
#include "base/text/words.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/time/time_options.hpp"
#include "noise/project/sensor_noise.hpp"
#include "noise/project/static_phase.hpp"
#include "results/results.hpp"
#include "results/text/sheets.hpp"
#include "spectra/files/series_file.hpp"

namespace straytrace::cli {
namespace {

struct SensorOptions : PrintOptions {
  TimeOptions time;
  std::string kind = "power", at, out, asd;
  std::size_t show = 6, per_route = 256;
  unsigned threads = 0;
  bool csv = false;
};

struct Kind {
  char const *name, *signal, *unit;
  SensorKind kind;
};
constexpr std::array<Kind, 3> kinds = {
    {{"power", "relative power dP/P", "1/sqrt(Hz)", SensorKind::power},
     {"phase", "phase against a local oscillator", "rad/sqrt(Hz)", SensorKind::phase},
     {"quadrant", "difference of halves X/P", "1/sqrt(Hz)", SensorKind::quadrant}}};

Kind const& kind_of(SensorOptions const& o) {
  std::vector<std::string> names;
  for (Kind const& k : kinds) {
    if (k.name == o.kind) return k;
    names.emplace_back(k.name);
  }
  throw InputError(fmt::format("--kind cannot be '{}'", o.kind),
                   did_you_mean(o.kind, names, "write one of: power, phase, quadrant"));
}

std::vector<double> frequencies_of(SensorOptions const& o, FrequencyGrid const& grid) {
  if (!o.at.empty()) return parse_frequencies(o.at, "--at");
  std::vector<double> hz;
  for (double const f : {10.0, 30.0, 100.0})
    if (grid.bin_of(f) < grid.size()) hz.push_back(f);
  if (hz.empty()) hz.push_back(std::sqrt(grid.edges.front() * grid.edges.back()));
  return hz;
}

void add_levels(std::vector<Sheet::Cell>& row, NoiseTrace const& t, FrequencyGrid const& grid,
                std::vector<double> const& hz) {
  for (double const f : hz) {
    std::size_t const bin = grid.bin_of(f);
    bool const known = bin < grid.size() && bin < t.asd.size();
    row.emplace_back(known ? t.asd[bin] : not_a_number);
    row.emplace_back(known && bin < t.sigma.size() ? t.sigma[bin] : not_a_number);
  }
}

void add_level_columns(Sheet& sheet, char const* unit, std::vector<double> const& hz) {
  for (double const f : hz) {
    sheet.columns.push_back({fmt::format("asd_{:g}Hz", f), unit, 4});
    sheet.columns.push_back({fmt::format("error_{:g}Hz", f), unit, 2});
  }
}

struct Answers {
  std::vector<SensorNoise> sensors;
  std::vector<double> hz;
};

Sheet sensor_sheet(TimeInputs const& in, Answers const& a, Kind const& kind) {
  Sheet s{
      "sensors",
      fmt::format(
          "{} by stray light, one-sided ASD with one standard error, mean over random static phases; -: unknown.\n"
          "light: main light to which the couplings of the port refer; bound: lower bound where routes are unresolved.",
          kind.signal),
      {{"sensor", ""}, {"light", "W", 4}},
      {}};
  add_level_columns(s, kind.unit, a.hz);
  s.columns.push_back({"bound", ""});
  for (SensorNoise const& n : a.sensors) {
    double const power = in.model.traced.ports.at(n.port.value).power;
    std::vector<Sheet::Cell> row{in.coupling().ports[n.port.value], power > 0 ? power : not_a_number};
    add_levels(row, n.budget.total, n.budget.grid, a.hz);
    row.emplace_back(std::string(n.budget.unresolved.empty() ? "" : "lower bound"));
    s.rows.push_back(std::move(row));
  }
  return s;
}

// The loudest sources of each sensor at the first frequency.
Sheet source_sheet(TimeInputs const& in, Answers const& a, Kind const& kind, std::size_t most) {
  Sheet s{"sources",
          fmt::format("Sources by sensor; share: of the power of the signal at {:g} Hz; coupling: mean, to the mode of "
                      "the sensor.",
                      a.hz.front()),
          {{"sensor", ""}, {"source", ""}, {"coupling", "", 4}, {"share", "", 3}},
          {}};
  add_level_columns(s, kind.unit, a.hz);
  s.columns.push_back({"status", ""});
  for (SensorNoise const& n : a.sensors) {
    std::size_t const bin = std::min(n.budget.grid.bin_of(a.hz.front()), n.budget.grid.size() - 1);
    std::vector<std::size_t> order(n.routes.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    auto const psd = [&](std::size_t i) {
      double const x = n.budget.routes[i].psd(bin);
      return std::isnan(x) ? -1 : x;
    };
    std::ranges::stable_sort(order, [&](std::size_t i, std::size_t j) { return psd(i) > psd(j); });
    for (std::size_t k = 0; k < std::min(most, order.size()); ++k) {
      CouplingClass const& c = in.coupling().classes[n.routes[order[k]]];
      NoiseTrace const& t = n.budget.routes[order[k]];
      std::vector<Sheet::Cell> row{in.coupling().ports[n.port.value], route_name(in.coupling(), c),
                                   c.reverse * c.coupling.mean, t.psd(bin) / n.budget.total.psd(bin)};
      add_levels(row, t, n.budget.grid, a.hz);
      row.emplace_back(t.resolved ? std::string(t.upper_bound ? "upper bound" : "") : "unresolved: " + t.why_not);
      s.rows.push_back(std::move(row));
    }
  }
  return s;
}

CurveSheet curves_of(TimeInputs const& in, Answers const& a, Kind const& kind) {
  CurveSheet sheet;
  sheet.title = fmt::format("{} by stray light", kind.signal);
  sheet.x = {"frequency", "Hz", {}};
  FrequencyGrid const& grid = a.sensors.front().budget.grid;
  for (std::size_t i = 0; i < grid.size(); ++i) sheet.x.values.push_back(grid.centre(i));
  for (SensorNoise const& n : a.sensors) {
    std::string const name = in.coupling().ports[n.port.value];
    sheet.y.push_back({name, kind.unit, n.budget.total.asd});
    sheet.y.push_back({name + "_error", kind.unit, n.budget.total.sigma, "hidden"});
  }
  return sheet;
}

void write_channels(SensorOptions const& o, TimeInputs const& in) {
  TimeDomainSettings s;
  s.paths = {in.routes, o.per_route, o.time.seed, 0,
             known_phases(in.coupling(), in.model.motion, in.model.noise.static_phases,
                          SensorResponse(PortId{0}, SensorKind::power))};
  s.start = in.start;
  s.duration = in.duration;
  s.rate = o.time.rate;
  s.band_low = in.model.noise.grid.edges.front();
  s.band_high = in.model.noise.grid.edges.back();
  s.delay = in.model.noise.delay ? Delay::by_hit : Delay::none;
  s.threads = o.threads;
  SensorSeries const series = sensor_series(in.coupling(), in.model.motion, s);
  if (o.out.ends_with(".hdf5") || o.out.ends_with(".h5")) {
    write_file(o.out, series_hdf5(series.channels));
    return;
  }
  CurveSheet sheet;
  sheet.title = "signals of sensors by stray light";
  sheet.x = {"gps", "s", {}};
  sheet.log_x = sheet.log_y = false;
  for (std::size_t i = 0; i < series.times.samples; ++i)
    sheet.x.values.push_back(series.times.start + double(i) / series.times.rate);
  for (TimeSeries const& c : series.channels) sheet.y.push_back({c.name, c.unit, c.samples});
  write_curves({o.out}, sheet);
}

int sensors(SensorOptions const& o) {
  Kind const& kind = kind_of(o);
  refuse_two_formats(o.csv, o);
  if (!o.out.empty()) check_curve_ending(o.out, "-o");
  if (!o.asd.empty()) check_curve_ending(o.asd, "--asd");
  TimeInputs const in(request_of(o.time));
  if (!o.quiet) std::cerr << (o.json() ? in.model.warnings_json : in.model.warnings);
  Answers a{{}, frequencies_of(o, in.model.noise.grid)};
  for (std::uint32_t p = 0; p < in.coupling().ports.size(); ++p) {
    bool const chosen =
        std::ranges::any_of(in.routes, [&](std::uint32_t r) { return in.coupling().classes[r].port.value == p; });
    if (chosen) a.sensors.push_back(sensor_noise(in.coupling(), in.model.motion, in.model.noise, PortId{p}, kind.kind));
  }
  std::size_t left_out = 0;
  for (SensorNoise const& n : a.sensors) left_out += n.left_out;
  if (left_out > 0)
    std::cerr << fmt::format(
        "warning: {} of ghosts, halo or edges left out: their pattern across a quadrant is not known\n"
        "  write --kind power for all light\n",
        counted(left_out, "route"));
  std::vector<Sheet> const sheets = {sensor_sheet(in, a, kind), source_sheet(in, a, kind, o.show)};
  std::cout << (o.json() ? json_of(sheets).dump() + "\n" : o.csv ? csv_of(sheets) : text_of(sheets));
  if (!o.asd.empty()) write_curves({o.asd}, curves_of(in, a, kind));
  if (!o.out.empty()) write_channels(o, in);
  return done;
}

}  // namespace

void add_sensors(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<SensorOptions>();
  SensorOptions& o = *options;
  auto* const command = app.add_subcommand(
      "sensors", "Signals of photodiodes and quadrants on the beams of a run: spectra by source, time series.");
  command->add_option("run", o.time.run, "run file (HDF5)")->required();
  command->add_option("--kind", o.kind, "power (default), phase by a local oscillator, or quadrant");
  command->add_option("--at", o.at, "frequencies of the tables; default \"10 Hz, 30 Hz, 100 Hz\" in the band");
  command->add_option("--show", o.show, "sources of each sensor; default 6")->check(whole_between(1, 1e6, "6"));
  add_motion_options(*command, o.time);
  add_stretch_options(*command, o.time);
  add_route_options(*command, o.time);
  command->add_option("--paths-per-route", o.per_route, "fields of the time series drawn for each route; default 256")
      ->check(whole_between(1, 1e6, "64"));
  command->add_option("--threads", o.threads, "default: all cores; does not change the result")
      ->check(whole_between(1, 1024, "4"));
  mark_output(*command, *command->add_option("-o,--out", o.out,
                                             "time series of one realisation: power, phase, X and Y of each sensor "
                                             "(.hdf5 .txt .csv .png .html)"));
  mark_output(*command,
              *command->add_option("--asd", o.asd, "spectra of the sensors: .txt .csv .hdf5 .json .png .html"));
  command->add_flag("--csv", o.csv, "all digits, SI");
  command->add_flag("--quiet", o.quiet, "results only");
  add_format_option(*command, o);
  command->footer(
      "Examples:\n"
      "  straytrace sensors demo/run.h5\n"
      "  straytrace sensors demo/run.h5 --kind quadrant --motion examples/storm.yaml -o sensors.hdf5");
  command->callback([options, &exit_code] { exit_code = sensors(*options); });
}

}  // namespace straytrace::cli
