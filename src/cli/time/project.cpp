// SPDX-License-Identifier: BSD-3-Clause
// straytrace project: measured or drawn motion -> h(t), its spectrum and spectrogram, fringe wrapping included.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>

#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/text/json_text.hpp"
#include "base/text/words.hpp"
#include "cli/commands.hpp"
#include "cli/data_options.hpp"
#include "cli/options.hpp"
#include "cli/time/time_options.hpp"
#include "noise/project/static_phase.hpp"
#include "noise/time_domain/realisations.hpp"
#include "results/results.hpp"
#include "session/backend.hpp"
#include "session/interrupt.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/files/series_file.hpp"
#include "spectra/files/unit_text.hpp"

namespace straytrace::cli {
namespace {

struct TimeFiles {
  std::string strain, asd, spectrogram, motion, stride;
};

struct ProjectOptions {
  TimeOptions time;
  std::size_t per_route = 0;  // 0: a number that limits the work
  std::string backend = "cpu";
  unsigned threads = 0;
  bool retarded = false;
  TimeFiles files;
  DataOptions data;                            // segments, --format, --quiet
  std::string witness, target, coupling_unit;  // of a coupling function instead of a run
  std::uint32_t realisations = 0;              // 0: one, or one for each position of a scanned body
};

// Realisations by position of the body that `static_phase` scans, one after the other.
struct PositionRuns {
  std::optional<ScannedPhase> body;
  std::vector<bool> routes;                    // that it gives its phase
  std::vector<Realisations> runs{};            // by position
  std::vector<TimeDomainSummary> summaries{};  // the same
  PositionRuns(TimeInputs const& in) : body(in.model.noise.scanned) {
    if (!body) return;
    routes = scanned_routes(in.coupling(), in.model.motion, in.model.noise, *in.model.detector);
    runs.resize(body->count);
  }
  std::size_t of(std::uint32_t realisation) const { return realisation % std::max<std::size_t>(1, runs.size()); }
  void set(PathChoice& paths) const {
    for (std::size_t r = 0; r < routes.size(); ++r)
      if (routes[r]) paths.phases[r] = body->phase(std::uint32_t(of(paths.realisation)));
  }
  double degrees(std::size_t k) const { return body->phase(std::uint32_t(k)) * 180 / pi; }
};

// Default number of fields that are summed, without copies: takes seconds for a minute of data at 8 kHz.
constexpr std::size_t usual_paths = 2048;

TimeDomainSettings settings_of(ProjectOptions const& o, TimeInputs const& in) {
  TimeDomainSettings s;
  std::size_t const each = std::max<std::size_t>(16, usual_paths / in.routes.size());
  s.paths = {in.routes, o.per_route ? o.per_route : each, o.time.seed, 0,
             known_phases(in.coupling(), in.model.motion, in.model.noise.static_phases, *in.model.detector)};
  s.start = in.start;
  s.duration = in.duration;
  s.rate = o.time.rate;
  s.band_low = in.model.noise.grid.edges.front();
  s.band_high = in.model.noise.grid.edges.back();
  if (o.retarded && in.model.noise.delay)
    throw InputError(
        "--retarded delays all motion by half of a path, and 'delay: yes' in 'noise' each hit by its own time",
        "remove --retarded, or 'delay' from 'noise'");
  s.delay = o.retarded ? Delay::half_path : in.model.noise.delay ? Delay::by_hit : Delay::none;
  s.threads = o.threads;
  s.direct = phase_summer(o.backend);
  return s;
}

// Options that do not apply to a coupling function.
void refuse_options_of_runs(ProjectOptions const& o) {
  TimeOptions const& time = o.time;
  TimeFiles const& files = o.files;
  std::pair<bool, char const*> const given[] = {{!files.strain.empty(), "-o"},
                                                {!files.spectrogram.empty(), "--spectrogram"},
                                                {!files.motion.empty(), "--save-motion"},
                                                {!time.motion.empty(), "--motion"},
                                                {!time.channel.empty(), "--channel"},
                                                {!time.body.empty(), "--body"},
                                                {!time.routes.empty(), "--route"},
                                                {!time.ports.empty(), "--port"},
                                                {!time.moved_by.empty(), "--moved-by"},
                                                {!time.duration_text.empty(), "--duration"},
                                                {time.rate > 0, "--rate"},
                                                {o.retarded, "--retarded"}};
  std::vector<std::string> names;
  for (auto const& [is_given, name] : given)
    if (is_given) names.emplace_back(name);
  std::vector<InputError> errors;
  for (std::string const& name : names)
    errors.emplace_back(name + ": for the motion through a run; a coupling function gives a spectrum only",
                        &name == &names.back() ? "write --asd FILE for the projection, and remove the others" : "");
  throw_all(errors);
}

CurveSheet coupling_sheet(ProjectedCoupling const& p, QuietWitness const* target, std::string const& unit) {
  CurveSheet sheet;
  sheet.title = fmt::format("{} projected onto {} by a measured coupling", p.witness, p.target);
  sheet.x = {"frequency", "Hz", {}};
  sheet.y = {{"projected", unit, {}}, {"sigma", unit, {}, "hidden"}, {"upper_limit", unit, {}, "upper-limit"}};
  if (target) sheet.y.push_back({"target", unit, target->asd});
  for (ProjectedPoint const& q : p.points) {
    bool const measured = q.flag == CouplingFlag::measured, limit = q.flag == CouplingFlag::upper_limit;
    sheet.x.values.push_back(q.hz);
    sheet.y[0].values.push_back(measured ? q.asd : not_a_number);
    sheet.y[1].values.push_back(measured ? q.sigma : not_a_number);
    sheet.y[2].values.push_back(limit ? q.asd : not_a_number);
  }
  return sheet;
}

std::string point_text(ProjectedPoint const& q, std::string const& unit) {
  if (q.flag == CouplingFlag::measured && std::isnan(q.sigma))
    return fmt::format("{:.3g} {}, error unknown", q.asd, unit);
  if (q.flag == CouplingFlag::measured) return fmt::format("{} {}", with_error(q.asd, q.sigma), unit);
  if (q.flag == CouplingFlag::upper_limit) return fmt::format("< {:.3g} {} (upper limit)", q.asd, unit);
  return fmt::format("unknown ({})", name_of(q.flag));
}

std::string coupling_text(ProjectedCoupling const& p, QuietWitness const* target, std::string const& unit) {
  std::size_t measured = 0, limits = 0;
  for (ProjectedPoint const& q : p.points) {
    measured += q.flag == CouplingFlag::measured;
    limits += q.flag == CouplingFlag::upper_limit;
  }
  std::string text = fmt::format("{}: {} measured, {}, {} unknown\n",
                                 p.points.size() == 1 ? "1 frequency" : fmt::format("{} frequencies", p.points.size()),
                                 measured, counted(limits, "upper limit"), p.points.size() - measured - limits);
  for (double const hz : {10.0, 30.0, 100.0}) {
    ProjectedPoint const* nearest = nullptr;
    for (ProjectedPoint const& q : p.points)
      if (!nearest || std::fabs(q.hz - hz) < std::fabs(nearest->hz - hz)) nearest = &q;
    if (nearest && std::fabs(nearest->hz / hz - 1) < 0.1)
      text += fmt::format("at {:.4g} Hz: {}\n", nearest->hz, point_text(*nearest, unit));
  }
  ProjectedPoint const* worst = nullptr;
  double ratio = 0;
  for (std::size_t i = 0; target && i < p.points.size(); ++i)
    if (p.points[i].flag == CouplingFlag::measured && target->asd[i] > 0 && p.points[i].asd / target->asd[i] > ratio) {
      ratio = p.points[i].asd / target->asd[i];
      worst = &p.points[i];
    }
  if (worst) text += fmt::format("largest share of the target: {:.3g} of its ASD at {:.4g} Hz\n", ratio, worst->hz);
  return text;
}

// A coupling function instead of a run.
int project_coupling_file(ProjectOptions const& o) {
  refuse_options_of_runs(o);
  std::string const& file = o.time.run;
  if (o.witness.empty())
    throw InputError(fmt::format("'{}' is a coupling function, but no quiet witness is given", file),
                     "write --witness FILE::CHANNEL");
  if (!o.files.asd.empty()) check_curve_ending(o.files.asd, "--asd");
  DataOptions data = o.data;
  data.unit = o.time.unit;
  data.gps = o.time.gps;
  data.segments = o.time.segments;
  TimeSeries const witness = series_of(data, o.witness);
  std::string const& unit_said = o.coupling_unit;
  CouplingFunction coupling =
      parse_coupling(read_text(file), file, unit_said, unit_said.empty() ? "" : unit_below(unit_said, witness));
  if (coupling.witness.empty()) coupling.witness = witness.name;
  if (coupling.target.empty()) coupling.target = "target";
  WelchSettings settings = welch_of(data, witness);
  WelchSpectrum averaged = welch(witness.samples, witness.rate, settings);
  std::string note = welch_note(settings, witness.rate, averaged);
  ProjectedCoupling p = project_coupling(coupling, level_of(averaged, witness.unit));
  std::string unit = o.target.empty() ? asd_unit(unit_above(coupling)) : "";
  std::optional<QuietWitness> target;
  if (!o.target.empty()) {
    data.unit.clear();
    TimeSeries const series = series_of(data, o.target);
    settings.segment = std::size_t(std::lround(double(settings.segment) / witness.rate * series.rate));
    averaged = welch(series.samples, series.rate, settings);
    note = welch_note(settings, series.rate, averaged);
    target = level_of(averaged, series.unit);
    target->asd.resize(p.points.size(), not_a_number);
    unit = asd_unit(series.unit);
    rescale(p, coupling, series);
  }
  CurveSheet sheet = coupling_sheet(p, target ? &*target : nullptr, unit);
  sheet.notes = {source_note(witness), note};
  std::cout << (data.json() ? curve_json(sheet) : coupling_text(p, target ? &*target : nullptr, unit));
  if (o.files.asd.empty()) return done;
  write_curves({o.files.asd}, sheet);
  if (!data.quiet) std::cerr << "wrote " << o.files.asd << '\n';
  return done;
}

std::string progress_line(double done, double left, double duration) {
  std::string const time = std::isfinite(left) ? fmt::format("  about {:.0f} s left", left) : "";
  return fmt::format("project  {:.0f} % of {:.4g} s of h(t){}", 100 * done, duration, time);
}

std::string welch_text(TimeDomainSummary const& r) {
  return fmt::format("Welch: {:g} s, {}, ENBW {:.4g} Hz", r.segment, counted(r.segments, "segment"), r.noise_bandwidth);
}

std::string level_text(BandLevel const& b, std::size_t realisations) {
  if (!std::isfinite(b.asd)) return fmt::format("h({:g} Hz): outside the band of the run or of the record", b.hz);
  std::string text = fmt::format("h({:g} Hz) = {} /sqrt(Hz)", b.hz, with_error(b.asd, b.sigma));
  if (std::isfinite(b.below))
    text += fmt::format(", {:.3g} to {:.3g} in 90 % of {} realisations", b.below, b.above, realisations);
  else if (realisations == 1)
    text += " in this realisation";
  return text + (std::isfinite(b.exact) ? fmt::format("; mean by spectra {:.4g}", b.exact) : "");
}

std::string positions_text(PositionRuns const& p) {
  std::string text;
  for (std::size_t k = 0; k < p.summaries.size(); ++k) {
    std::string levels;
    for (BandLevel const& b : p.summaries[k].levels)
      if (std::isfinite(b.asd))
        levels += fmt::format("{}{} at {:g} Hz", levels.empty() ? "" : ", ", with_error(b.asd, b.sigma), b.hz);
    text += fmt::format("\n'{}' at a static phase of {:g} deg, {}: h = {} /sqrt(Hz)", p.body->body, p.degrees(k),
                        counted(p.runs[k].size(), "realisation"), levels.empty() ? "unknown" : levels);
  }
  return text;
}

// Realisations draw one motion of each body for all copies of a port; the bands of `noise` have copies move apart.
std::string copies_text(TimeInputs const& in, TimeDomainSummary const& r) {
  auto const copied = [&](std::size_t route) {
    return in.model.detector->copies(in.coupling().classes[route].port) > 1;
  };
  if (r.realisations < 2 || std::ranges::none_of(in.routes, copied)) return "";
  return "equal arms move alike here: percentiles are wider than those of 'noise', whose arms move independently; "
         "'arms: 1' has those of one arm\n";
}

std::string project_text(TimeInputs const& in, TimeDomainSummary const& r) {
  std::string text =
      fmt::format("{:g} s at {:g} Hz from GPS {}, seed {}: {}, {}\n", r.times.duration(), r.times.rate,
                  gps_text(r.times.start), r.seed, counted(r.routes, "route"), counted(r.paths, "field"));
  text += fmt::format("phase: {:.4g} rad rms of {}, the route with the largest moving power\n", r.rms_phase,
                      r.rms_phase_route);
  text += fmt::format("fastest fringe {:.4g} Hz at GPS {:.2f}: {}\n", r.fastest.hz, r.fastest.time, r.fastest_route);
  text +=
      fmt::format("rate: above {:.5g} Hz needed (eq. 7.13: twice the fringe frequency plus a margin of {:.4g} Hz)\n",
                  r.rule.least(), r.rule.margin);
  text += fmt::format("neglected (eq. 2.6): second order about {:.2g} rad, ", r.second_order);
  if (r.ray_tilt > 0) text += fmt::format("tilt of the rays about {:.2g} rad, ", r.ray_tilt);
  if (r.delay_by_hit)
    text += fmt::format(
        "delays included but for bodies that light meets again within a path: up to {:.1g} of h at 100 Hz\n",
        r.delay_error);
  else if (r.retarded)
    text += fmt::format("deviations of the delays from half of a path: up to {:.1g} of h at 100 Hz\n", r.delay_error);
  else
    text += fmt::format("delays up to {:.2g} ms: up to {:.1g} of h at 100 Hz where bodies interfere\n", 1e3 * r.delay,
                        r.delay_error);
  text += fmt::format("h(t) covers {:g} to {:g} Hz; {}\n", r.band_low, r.band_high, welch_text(r));
  for (BandLevel const& b : r.levels) text += level_text(b, r.realisations) + "\n";
  text += copies_text(in, r);
  if (r.recorded) text += "mean by spectra: as if the recorded motion were stationary and Gaussian\n";
  text.pop_back();
  return text;
}

std::string project_json(TimeDomainSummary const& r, PositionRuns const& positions) {
  auto const number = [](double x) { return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(); };
  nlohmann::ordered_json j = {{"gps", r.times.start},
                              {"duration", r.times.duration()},
                              {"rate", r.times.rate},
                              {"least_rate", r.rule.least()},
                              {"seed", r.seed},
                              {"realisations", r.realisations},
                              {"routes", r.routes},
                              {"fields", r.paths},
                              {"rms_phase", r.rms_phase},
                              {"rms_phase_route", r.rms_phase_route},
                              {"largest_fringe_frequency", r.fastest.hz},
                              {"largest_fringe_gps", r.fastest.time},
                              {"largest_fringe_route", r.fastest_route},
                              {"second_order_phase", r.second_order},
                              {"ray_tilt_phase", number(r.ray_tilt > 0 ? r.ray_tilt : not_a_number)},
                              {"longest_delay", r.delay},
                              {"retarded", r.retarded},
                              {"delay", r.delay_by_hit},
                              {"delay_error_100Hz", r.delay_error},
                              {"band", {r.band_low, r.band_high}}};
  for (BandLevel const& b : r.levels)
    j["strain"].push_back({{"frequency", b.hz},
                           {"low", b.low},
                           {"high", b.high},
                           {"asd", number(b.asd)},
                           {"sigma", number(b.sigma)},
                           {"percentile_5", number(b.below)},
                           {"percentile_50", number(b.median)},
                           {"percentile_95", number(b.above)},
                           {"mean_by_spectra", number(b.exact)}});
  for (std::size_t k = 0; k < positions.summaries.size(); ++k) {
    nlohmann::ordered_json levels = nlohmann::ordered_json::array();
    for (BandLevel const& b : positions.summaries[k].levels)
      levels.push_back({{"frequency", b.hz}, {"asd", number(b.asd)}, {"sigma", number(b.sigma)}});
    j["positions"].push_back({{"body", positions.body->body},
                              {"static_phase_deg", positions.degrees(k)},
                              {"realisations", positions.runs[k].size()},
                              {"strain", std::move(levels)}});
  }
  return json_text(j, 2);
}

bool is_hdf5(std::string const& file) { return file.ends_with(".hdf5") || file.ends_with(".h5"); }

// Records of one clock: HDF5 with all, other formats as columns.
void write_series(std::string const& file, std::vector<TimeSeries> const& series, std::string const& title) {
  if (is_hdf5(file)) {
    write_file(file, series_hdf5(series));
    return;
  }
  CurveSheet sheet;
  sheet.title = title;
  sheet.x = {"gps", "s", {}};
  sheet.log_x = sheet.log_y = false;
  for (std::size_t i = 0; i < series.front().samples.size(); ++i) sheet.x.values.push_back(series.front().time(i));
  for (TimeSeries const& s : series) sheet.y.push_back({s.name, s.unit, s.samples});
  write_curves({file}, sheet);
}

// h, and the stray field at each port.
std::vector<TimeSeries> strain_channels(TimeInputs const& in, StrayLight const& light) {
  std::vector<TimeSeries> all = {strain_series(light)};
  for (PortField const& f : light.fields)
    for (bool const phase : {true, false}) {
      TimeSeries s{fmt::format("{} {}", in.coupling().ports[f.port.value], phase ? "Im s" : "Re s"),
                   "1",
                   light.times.start,
                   light.times.rate,
                   {}};
      for (std::complex<double> const x : f.field) s.samples.push_back(phase ? x.imag() : x.real());
      all.push_back(std::move(s));
    }
  return all;
}

std::vector<std::string> notes_of(TimeDomainSummary const& r) {
  return {fmt::format("{:g} s at {:g} Hz from GPS {}, seed {}, {}, {}, {}", r.times.duration(), r.times.rate,
                      gps_text(r.times.start), r.seed, counted(r.realisations, "realisation"),
                      counted(r.routes, "route"), counted(r.paths, "field")),
          welch_text(r)};
}

void write_spectrum(std::string const& file, TimeDomainSummary const& r, PositionRuns const& positions) {
  CurveSheet sheet;
  sheet.title = "strain of stray light from its time series";
  sheet.notes = notes_of(r);
  std::string const unit = "1/sqrt(Hz)";
  sheet.x = {"frequency", "Hz", {}};
  sheet.y = {{"h_mean", unit, {}}, {"sigma", unit, {}, "hidden"}, {"mean_by_spectra", unit, {}}};
  if (r.realisations >= 5)
    for (char const* name : {"percentile_5", "percentile_50", "percentile_95"})
      sheet.y.push_back({name, unit, {}, name[11] == '0' ? "line" : name[11] == '9' ? "band-high" : "band-low"});
  for (BandLevel const& b : r.spectrum) {
    sheet.x.values.push_back(b.hz);
    double const values[] = {b.asd, b.sigma, b.exact, b.below, b.median, b.above};
    for (std::size_t i = 0; i < sheet.y.size(); ++i) sheet.y[i].values.push_back(values[i]);
  }
  for (std::size_t k = 0; k < positions.summaries.size(); ++k) {
    sheet.y.push_back({fmt::format("static_phase_{:g}deg", positions.degrees(k)), unit, {}});
    for (BandLevel const& b : positions.summaries[k].spectrum) sheet.y.back().values.push_back(b.asd);
  }
  write_curves({file}, sheet);
}

void check_time_files(TimeFiles const& f) {
  for (auto const& [option, file] :
       {std::pair{"-o", f.strain}, {"--asd", f.asd}, {"--spectrogram", f.spectrogram}, {"--save-motion", f.motion}})
    if (!file.empty()) check_curve_ending(file, option);
}

std::vector<std::string> write_time_files(TimeFiles const& f, TimeInputs const& in, StrayLight const& light,
                                          TimeDomainSummary const& r, PositionRuns const& positions) {
  std::vector<std::string> written;
  auto const wanted = [&](std::string const& file) {
    if (!file.empty()) written.push_back(file);
    return !file.empty();
  };
  if (wanted(f.strain))
    write_series(f.strain, is_hdf5(f.strain) ? strain_channels(in, light) : std::vector{strain_series(light)},
                 "strain of stray light");
  if (wanted(f.motion)) write_series(f.motion, motion_channels(light.motion, in.model.motion), "motion of the bodies");
  if (wanted(f.asd)) write_spectrum(f.asd, r, positions);
  if (wanted(f.spectrogram)) {
    double const stride = f.stride.empty() ? std::min(0.5, r.times.duration() / 4)
                                           : option_quantity(f.stride, dim::time, "--stride", "0.5 s");
    write_map({f.spectrogram}, spectrogram_of(strain_series(light), stride, r.band_low, r.band_high));
  }
  return written;
}

std::uint32_t realisations_of(ProjectOptions const& o, PositionRuns const& positions) {
  auto const count = std::uint32_t(positions.runs.size());
  if (count > 0 && o.realisations % count != 0)
    throw InputError(fmt::format("--realisations {} do not divide among the {} positions of '{}'", o.realisations,
                                 count, positions.body->body),
                     fmt::format("give a multiple of {}", count));
  return o.realisations > 0 ? o.realisations : std::max(1u, count);
}

int project(ProjectOptions const& o) {
  if (o.time.run.ends_with(".csv") || !o.witness.empty()) return project_coupling_file(o);
  if (!o.target.empty() || !o.coupling_unit.empty())
    throw InputError("--target, --coupling-unit: for a coupling function",
                     "remove them, or give its CSV and --witness");
  check_time_files(o.files);
  TimeInputs const in(request_of(o.time));
  segment_of(o.data, "h", in.duration);
  if (!o.data.quiet) std::cerr << (o.data.json() ? in.model.warnings_json : in.model.warnings);
  TimeDomainSettings settings = settings_of(o, in);
  PositionRuns positions(in);
  std::uint32_t const realisations = realisations_of(o, positions);
  Realisations all;
  StrayLight first;
  ProgressLine progress(o.data.quiet);
  auto const start = std::chrono::steady_clock::now();
  TimeLeft left;
  settings.progress = [&](double share) {
    double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                 done = (settings.paths.realisation + share) / realisations;
    double const more = left.at(seconds, done);
    progress.at(seconds, [&] { return progress_line(done, more, in.duration); });
  };
  for (std::uint32_t r = 0; r < realisations; ++r) {
    settings.paths.realisation = r;
    positions.set(settings.paths);
    StrayLight light = stray_light(in.coupling(), in.model.motion, *in.model.detector, settings);
    TimeSeries const h = strain_series(light);
    WelchSpectrum const spectrum = welch(h.samples, h.rate, welch_of(o.data, h));
    all.add(spectrum);
    if (!positions.runs.empty()) positions.runs[positions.of(r)].add(spectrum);
    if (r == 0) {
      settings.rate = light.times.rate;
      first = std::move(light);
    }
  }
  TimeDomainSummary const result = summarise(in.coupling(), in.model.motion, in.exact, settings, first, all);
  for (Realisations const& run : positions.runs)
    if (run.size() > 0)
      positions.summaries.push_back(summarise(in.coupling(), in.model.motion, in.exact, settings, first, run));
  std::cout << (o.data.json() ? project_json(result, positions) : project_text(in, result) + positions_text(positions))
            << '\n';
  for (std::string const& name : write_time_files(o.files, in, first, result, positions))
    if (!o.data.quiet) std::cerr << "wrote " << name << '\n';
  return done;
}

}  // namespace

void add_project(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<ProjectOptions>();
  ProjectOptions& o = *options;
  auto* const command = app.add_subcommand(
      "project", "Project measured or drawn motion through a run in the time domain: h(t), spectrum, spectrogram.");
  command->add_option("run", o.time.run, "run file (HDF5), or coupling function (CSV) with --witness")->required();
  command->add_option("--witness", o.witness, "FILE::CHANNEL of the quiet witness, for a measured coupling");
  command->add_option("--target", o.target, "FILE::CHANNEL to compare that projection with");
  command->add_option("--coupling-unit", o.coupling_unit, "unit of the factors, where the CSV has none: 1/m");
  add_motion_options(*command, o.time);
  add_stretch_options(*command, o.time);
  add_route_options(*command, o.time);
  command
      ->add_option("--paths-per-route", o.per_route,
                   "number of fields drawn for each route; default: about 2048 in total, at least 16")
      ->check(whole_between(1, 1e6, "64"));
  command
      ->add_option("--realisations", o.realisations,
                   "number of independent draws of motion and static phases; default: 1, or one for each position of "
                   "'static_phase'")
      ->check(whole_between(1, 1e5, "20"));
  command->add_flag("--retarded", o.retarded, "delay the motion of each path by half of its length");
  command->add_option("--threads", o.threads, "default: all cores; does not change the result")
      ->check(whole_between(1, 1024, "4"));
  command->add_option("--backend", o.backend, "cpu, or cuda: fields are summed on a GPU; the same bits");
  mark_output(*command, *command->add_option("-o,--out", o.files.strain,
                                             "file of h(t), first realisation: .hdf5, .txt, .csv, .png, .html"));
  mark_output(*command, *command->add_option("--asd", o.files.asd,
                                             "file of the spectrum of h: .txt .csv .hdf5 .json .png .html"));
  mark_output(*command, *command->add_option("--spectrogram", o.files.spectrogram,
                                             "file of the spectrogram of h, first realisation: .png .html .txt .hdf5"));
  command->add_option("--stride", o.files.stride, "stride of the spectrogram; default: 0.5 s")
      ->check(is_quantity(dim::time, "--stride", "0.5 s"));
  mark_output(*command, *command->add_option("--save-motion", o.files.motion,
                                             "file of the motion of the bodies, first realisation: .hdf5 .txt .csv"));
  add_welch_options(*command, o.data);
  command->add_option("--format", o.data.format, "text or json")->check(CLI::IsMember({"text", "json"}));
  command->add_flag("--quiet", o.data.quiet, "results only");
  command->footer(
      "Examples:\n"
      "  straytrace project demo/run.h5 --motion examples/storm.yaml -o h.hdf5 --save-motion storm.hdf5\n"
      "  straytrace project demo/run.h5 --body tube --axis z --channel 'storm.hdf5::tube z' --asd h_asd.png");
  command->callback([options, &exit_code] { exit_code = project(*options); });
}

}  // namespace straytrace::cli
