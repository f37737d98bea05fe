// SPDX-License-Identifier: BSD-3-Clause
// straytrace sensors: what photodiodes and quadrants on the beams of a run read of its stray light.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <memory>

#include "base/errors.hpp"
#include "base/text/json_text.hpp"
#include "base/text/words.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/time/time_options.hpp"
#include "noise/project/sensor_noise.hpp"
#include "noise/project/static_phase.hpp"
#include "results/results.hpp"
#include "results/text/table.hpp"
#include "session/open_run.hpp"
#include "session/records/time_inputs.hpp"
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

// The signals of one port: of the beat with the main light, and of light without overlap on its receiver.
struct Answer {
  SensorNoise beat;
  Sensor sensor;
  double light = not_a_number;  // W, main light on the sensor
  std::vector<CouplingClass const*> incoherent = {};
  double watts = not_a_number;  // of the main mode, unit of couplings to receivers
  // Over the main light, and its standard error; empty: this kind does not read it.
  std::vector<double> incoherent_asd = {}, incoherent_sigma = {};
};

struct Answers {
  std::vector<Answer> sensors;
  std::vector<double> hz;
};

// ASD of a source without overlap over the main light of the sensor.
std::vector<double> relative_asd(TimeInputs const& in, Answer const& a, std::span<CouplingClass const* const> light) {
  std::vector<double> asd = asd_of(source_lines(light, in.model.motion.light), a.beat.budget.grid);
  for (double& x : asd) x *= a.watts / a.light;
  return asd;
}

double relative_error(CouplingClass const& c) {
  return c.coupling.mean > 0 ? c.coupling.std_error / c.coupling.mean : 0;
}

// The errors of the watts of different routes are independent.
void add_incoherent(TimeInputs const& in, Answer& a) {
  a.incoherent_asd = relative_asd(in, a, a.incoherent);
  a.incoherent_sigma.assign(a.incoherent_asd.size(), 0);
  for (CouplingClass const* c : a.incoherent) {
    std::vector<double> const one = relative_asd(in, a, {&c, 1});
    for (std::size_t i = 0; i < one.size(); ++i)
      a.incoherent_sigma[i] = std::hypot(a.incoherent_sigma[i], one[i] * relative_error(*c));
  }
}

Answer answer_of(TimeInputs const& in, CouplingTable const& table, Sensor const& sensor, SensorKind kind) {
  Answer a{sensor_noise(table, in.model.motion, in.model.noise, sensor.port, kind), sensor};
  if (in.file.about.beam_power > 0) a.watts = in.file.about.beam_power;
  a.light = a.watts * sensor.share * sensor.caught;
  if (!sensor.receiver) return a;
  if (std::isnan(a.watts))
    throw InputError(fmt::format("no beam states its power, so the light on the receiver of sensor '{}' cannot be "
                                 "compared with its main light",
                                 sensor.name),
                     "write 'power' for the main beam and for that of the sensor");
  for (CouplingClass const& c : table.received)
    if (c.port.value == *sensor.receiver) a.incoherent.push_back(&c);
  if (kind == SensorKind::power) add_incoherent(in, a);
  return a;
}

// Of the sum in power with the beat.
NoiseTrace total_of(Answer const& a) {
  NoiseTrace t = a.beat.budget.total;
  for (std::size_t i = 0; i < t.asd.size() && !a.incoherent_asd.empty(); ++i) {
    double const beat = t.asd[i];
    t.asd[i] = std::hypot(beat, a.incoherent_asd[i]);
    if (t.asd[i] > 0 && i < t.sigma.size())
      t.sigma[i] = std::hypot(beat * t.sigma[i], a.incoherent_asd[i] * a.incoherent_sigma[i]) / t.asd[i];
  }
  return t;
}

Sheet sensor_sheet(Answers const& a, Kind const& kind) {
  Sheet s{"sensors",
          fmt::format(
              "{} by stray light, one-sided ASD with one standard error, mean over random static phases; -: unknown.\n"
              "light: main light on the sensor; bound: lower bound where routes are unresolved.",
              kind.signal),
          {{"sensor", ""}, {"light", "W", 4}},
          {}};
  add_level_columns(s, kind.unit, a.hz);
  s.columns.push_back({"bound", ""});
  for (Answer const& n : a.sensors) {
    NoiseBudget const& b = n.beat.budget;
    std::vector<Sheet::Cell> row{n.sensor.name, n.light};
    add_levels(row, total_of(n), b.grid, a.hz);
    row.emplace_back(std::string(b.unresolved.empty() ? "" : "lower bound"));
    s.rows.push_back(std::move(row));
  }
  return s;
}

// A row of the table of sources, with the power of its signal in the first bin.
struct Source {
  double psd;
  std::vector<Sheet::Cell> row;
};

Source beat_source(CouplingTable const& table, Answer const& n, std::size_t i, std::vector<double> const& hz,
                   double all) {
  CouplingClass const& c = table.classes[n.beat.routes[i]];
  NoiseTrace const& t = n.beat.budget.routes[i];
  std::size_t const bin = std::min(t.asd.size() - 1, n.beat.budget.grid.bin_of(hz.front()));
  double const coupling = c.reverse * c.coupling.mean;
  std::vector<Sheet::Cell> row{n.sensor.name,
                               route_name(table, c),
                               std::string("beat"),
                               coupling * n.light,
                               c.reverse * c.coupling.std_error * n.light,
                               coupling,
                               t.psd(bin) / all};
  add_levels(row, t, n.beat.budget.grid, hz);
  row.emplace_back(t.resolved ? std::string(t.upper_bound ? "upper bound" : "") : "unresolved: " + t.why_not);
  return {std::isnan(t.psd(bin)) ? -1 : t.psd(bin), std::move(row)};
}

Source incoherent_source(TimeInputs const& in, CouplingTable const& table, Answer const& n, CouplingClass const& c,
                         std::vector<double> const& hz, double all) {
  CouplingClass const* const one = &c;
  NoiseTrace t;
  t.asd = relative_asd(in, n, {&one, 1});
  for (double const x : t.asd) t.sigma.push_back(x * relative_error(c));
  std::size_t const bin = std::min(t.asd.size() - 1, n.beat.budget.grid.bin_of(hz.front()));
  std::vector<Sheet::Cell> row{n.sensor.name,
                               received_name(table, c),
                               std::string("power"),
                               c.coupling.mean * n.watts,
                               c.coupling.std_error * n.watts,
                               not_a_number,
                               t.psd(bin) / all};
  add_levels(row, t, n.beat.budget.grid, hz);
  row.emplace_back(c.coupling.trusted ? std::string() : "unresolved: " + c.coupling.why_not);
  return {t.psd(bin), std::move(row)};
}

// The loudest sources of each sensor at the first frequency; of light without overlap the brightest.
Sheet source_sheet(TimeInputs const& in, CouplingTable const& table, Answers const& a, Kind const& kind,
                   std::size_t most) {
  Sheet s{"sources",
          fmt::format("Sources by sensor; share: of the power of the signal at {:g} Hz; coupling: mean, to the mode of "
                      "the sensor.\nbeat: light in the mode of the main light; power: light without overlap, as steady "
                      "as its source.",
                      a.hz.front()),
          {{"sensor", ""},
           {"source", ""},
           {"signal", ""},
           {"power", "W", 4},
           {"power_error", "W", 2},
           {"coupling", "", 4},
           {"share", "", 3}},
          {}};
  add_level_columns(s, kind.unit, a.hz);
  s.columns.push_back({"status", ""});
  for (Answer const& n : a.sensors) {
    FrequencyGrid const& grid = n.beat.budget.grid;
    double const all = total_of(n).psd(std::min(grid.bin_of(a.hz.front()), grid.size() - 1));
    std::vector<Source> beat, power;
    for (std::size_t i = 0; i < n.beat.routes.size(); ++i) beat.push_back(beat_source(table, n, i, a.hz, all));
    std::vector<CouplingClass const*> bright;
    if (!n.incoherent_asd.empty()) bright = n.incoherent;
    std::ranges::stable_sort(bright, [](auto x, auto y) { return x->coupling.mean > y->coupling.mean; });
    for (CouplingClass const* c : bright) power.push_back(incoherent_source(in, table, n, *c, a.hz, all));
    for (std::vector<Source>* list : {&beat, &power}) {
      std::ranges::stable_sort(*list, std::greater{}, &Source::psd);
      for (std::size_t k = 0; k < std::min(most, list->size()); ++k) s.rows.push_back(std::move((*list)[k].row));
    }
  }
  return s;
}

CurveSheet curves_of(Answers const& a, Kind const& kind) {
  CurveSheet sheet;
  sheet.title = fmt::format("{} by stray light", kind.signal);
  sheet.x = {"frequency", "Hz", {}};
  FrequencyGrid const& grid = a.sensors.front().beat.budget.grid;
  for (std::size_t i = 0; i < grid.size(); ++i) sheet.x.values.push_back(grid.centre(i));
  for (Answer const& n : a.sensors) {
    NoiseTrace const total = total_of(n);
    sheet.y.push_back({n.sensor.name, kind.unit, total.asd});
    sheet.y.push_back({n.sensor.name + "_error", kind.unit, total.sigma, "hidden"});
  }
  return sheet;
}

// Channels have the names of sensors; that of the power has the light without overlap too.
void write_channels(SensorOptions const& o, TimeInputs const& in, CouplingTable table, Answers const& a) {
  TimeDomainSettings s;
  s.paths = {
      in.routes, o.per_route, o.time.seed, 0,
      known_phases(table, in.model.motion, in.model.noise.static_phases, SensorResponse(PortId{0}, SensorKind::power))};
  s.start = in.start;
  s.duration = in.duration;
  s.rate = o.time.rate;
  s.band_low = in.model.noise.grid.edges.front();
  s.band_high = in.model.noise.grid.edges.back();
  s.delay = in.model.noise.delay ? Delay::by_hit : Delay::none;
  s.threads = o.threads;
  for (Answer const& n : a.sensors) table.ports[n.sensor.port.value] = n.sensor.name;
  SensorSeries series = sensor_series(table, in.model.motion, s);
  for (Answer const& n : a.sensors)
    for (TimeSeries& channel : series.channels)
      if (channel.name == n.sensor.name + " power" && !n.incoherent.empty())
        add_lines(channel, source_lines(n.incoherent, in.model.motion.light), n.watts / n.light);
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

// Rims are left out for every kind of sensor, on a quadrant all computed routes.
void warn_of_light_left_out(TimeInputs const& in, Answers const& a, SensorOptions const& o) {
  std::size_t all = 0, rims = 0;
  for (Answer const& n : a.sensors) {
    all += n.beat.left_out;
    rims += std::size_t(std::ranges::count_if(in.coupling().classes, [&](CouplingClass const& c) {
      return c.kind == ClassKind::rim && c.port == n.sensor.port;
    }));
  }
  if (all > rims)
    print_warning(fmt::format("{} of ghosts, halo or edges left out: their pattern across a quadrant is not known\n"
                              "  write --kind power for this light",
                              counted(all - rims, "route")),
                  o);
  if (rims > 0)
    print_warning(fmt::format("{} of rims left out: their light reaches a sensor in other modes too\n"
                              "  their strain is in 'straytrace noise'",
                              counted(rims, "route")),
                  o);
}

int sensors(SensorOptions const& o) {
  Kind const& kind = kind_of(o);
  refuse_two_formats(o.csv, o);
  if (!o.out.empty()) check_curve_ending(o.out, "-o");
  if (!o.asd.empty()) check_curve_ending(o.asd, "--asd");
  TimeInputs const in(request_of(o.time));
  if (!o.quiet) std::cerr << (o.json() ? in.model.warnings_json : in.model.warnings);
  Answers a{{}, frequencies_of(o, in.model.noise.grid)};
  double const main = in.file.about.beam_power;
  std::vector<double> power;
  for (TracedPort const& port : in.model.traced.ports)  // `power` of light between two beams is that of the first
    power.push_back(port.lit_by.empty() ? port.power : std::pow(main * port.reference, 2) / port.power);
  std::vector<Sensor> const sensors = sensors_of_ports(in.model.scene, in.coupling(), power, main);
  CouplingTable const table = cut_by(sensors, in.coupling());
  for (std::uint32_t p = 0; p < table.ports.size(); ++p) {
    bool const chosen =
        std::ranges::any_of(in.routes, [&](std::uint32_t r) { return table.classes[r].port.value == p; });
    if (chosen) a.sensors.push_back(answer_of(in, table, sensors[p], kind.kind));
  }
  warn_of_light_left_out(in, a, o);
  std::vector<Sheet> const sheets = {sensor_sheet(a, kind), source_sheet(in, table, a, kind, o.show)};
  std::cout << (o.json() ? json_text(json_of(sheets)) + "\n" : o.csv ? csv_of(sheets) : text_of(sheets));
  if (!o.asd.empty()) write_curves({o.asd}, curves_of(a, kind));
  if (!o.out.empty()) write_channels(o, in, table, a);
  return done;
}

}  // namespace

void add_sensors(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<SensorOptions>();
  SensorOptions& o = *options;
  auto* const command = app.add_subcommand(
      "sensors",
      "Compute the signals of photodiodes and quadrants on the beams of a run: spectra by source, time series.");
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
