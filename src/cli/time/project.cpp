// SPDX-License-Identifier: BSD-3-Clause
// straytrace project: measured or drawn motion -> h(t), its spectrum and spectrogram, fringe wrapping included.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <iostream>

#include "cli/commands.hpp"
#include "cli/data_options.hpp"
#include "cli/options.hpp"
#include "cli/time/time_results.hpp"
#include "session/backend.hpp"
#include "session/interrupt.hpp"

namespace straytrace::cli {
namespace {

struct ProjectOptions {
  TimeOptions time;
  TimeFiles files;
  DataOptions data;  // segments, --format, --quiet
  CouplingProjectionOptions coupling;
  std::uint32_t realisations = 1;
};

// Default number of fields that are summed, without copies: takes seconds for a minute of data at 8 kHz.
constexpr std::size_t usual_paths = 2048;

TimeDomainSettings settings_of(TimeOptions const& o, TimeInputs const& in) {
  TimeDomainSettings s;
  std::size_t const each = std::max<std::size_t>(16, usual_paths / in.routes.size());
  s.paths = {in.routes, o.per_route ? o.per_route : each, o.seed, 0};
  s.start = in.start;
  s.duration = in.duration;
  s.rate = o.rate;
  s.band_low = in.model.noise.grid.edges.front();
  s.band_high = in.model.noise.grid.edges.back();
  s.delay = o.retarded ? Delay::half_path : Delay::none;
  s.threads = o.threads;
  s.direct = phase_summer(o.backend);
  return s;
}

// Options that do not apply to a coupling function.
void refuse_options_of_runs(TimeOptions const& time, TimeFiles const& files) {
  std::pair<bool, char const*> const given[] = {{!files.strain.empty(), "-o"},
                                                {!files.spectrogram.empty(), "--spectrogram"},
                                                {!files.motion.empty(), "--save-motion"},
                                                {!time.motion.empty(), "--motion"},
                                                {!time.channel.empty(), "--channel"},
                                                {!time.body.empty(), "--body"},
                                                {!time.routes.empty(), "--route"},
                                                {!time.ports.empty(), "--port"},
                                                {!time.moved_by.empty(), "--moved-by"},
                                                {!time.duration.empty(), "--duration"},
                                                {time.rate > 0, "--rate"},
                                                {time.retarded, "--retarded"}};
  std::vector<std::string> names;
  for (auto const& [is_given, name] : given)
    if (is_given) names.emplace_back(name);
  std::vector<InputError> errors;
  for (std::string const& name : names)
    errors.emplace_back(name + ": for the motion through a run; a coupling function gives a spectrum only",
                        &name == &names.back() ? "write --asd FILE for the projection, and remove the others" : "");
  throw_all(errors);
}

// A coupling function instead of a run.
int project_coupling_file(ProjectOptions const& o) {
  refuse_options_of_runs(o.time, o.files);
  if (o.coupling.witness.empty())
    throw InputError(fmt::format("'{}' is a coupling function, but no quiet witness is given", o.time.run),
                     "write --witness FILE::CHANNEL");
  CouplingProjectionOptions c = o.coupling;
  c.coupling = o.time.run;
  c.asd = o.files.asd;
  c.data = o.data;
  c.data.unit = o.time.unit;
  c.data.gps = o.time.gps;
  return project_measured_coupling(c);
}

std::string progress_line(double done, double left, double duration) {
  std::string const time = std::isfinite(left) ? fmt::format("  about {:.0f} s left", left) : "";
  return fmt::format("project  {:.0f} % of {:.4g} s of h(t){}", 100 * done, duration, time);
}

int project(ProjectOptions const& o) {
  if (o.time.run.ends_with(".csv") || !o.coupling.witness.empty()) return project_coupling_file(o);
  if (!o.coupling.target.empty() || !o.coupling.coupling_unit.empty())
    throw InputError("--target, --coupling-unit: for a coupling function",
                     "remove them, or give its CSV and --witness");
  check_time_files(o.files);
  TimeInputs const in(o.time);
  segment_of(o.data, "h", in.duration);
  if (!o.data.quiet) std::cerr << (o.data.json() ? in.model.warnings_json : in.model.warnings);
  TimeDomainSettings settings = settings_of(o.time, in);
  Realisations all;
  StrayLight first;
  ProgressLine progress(o.data.quiet);
  auto const start = std::chrono::steady_clock::now();
  TimeLeft left;
  settings.progress = [&](double share) {
    double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                 done = (settings.paths.realisation + share) / o.realisations;
    double const more = left.at(seconds, done);
    progress.at(seconds, [&] { return progress_line(done, more, in.duration); });
  };
  for (std::uint32_t r = 0; r < o.realisations; ++r) {
    settings.paths.realisation = r;
    StrayLight light = stray_light(in.coupling(), in.model.motion, *in.model.detector, settings);
    TimeSeries const h = strain_series(light);
    all.add(welch(h.samples, h.rate, welch_of(o.data, h)));
    if (r == 0) {
      settings.rate = light.times.rate;
      first = std::move(light);
    }
  }
  ProjectResult const result = project_result(in, settings, first, all);
  std::cout << (o.data.json() ? project_json(result) : project_text(result)) << '\n';
  for (std::string const& name : write_time_files(o.files, in, first, result))
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
  command->add_option("--witness", o.coupling.witness, "FILE::CHANNEL of the quiet witness, for a measured coupling");
  command->add_option("--target", o.coupling.target, "FILE::CHANNEL to compare that projection with");
  command->add_option("--coupling-unit", o.coupling.coupling_unit, "unit of the factors, where the CSV has none: 1/m");
  add_motion_options(*command, o.time);
  add_stretch_options(*command, o.time);
  add_route_options(*command, o.time);
  command
      ->add_option("--paths-per-route", o.time.per_route,
                   "number of fields drawn for each route; default: about 2048 in total, at least 16")
      ->check(whole_between(1, 1e6, "64"));
  command->add_option("--realisations", o.realisations, "number of independent draws of motion and static phases")
      ->check(whole_between(1, 1e5, "20"));
  command->add_flag("--retarded", o.time.retarded, "delay the motion of each path by half of its length");
  command->add_option("--threads", o.time.threads, "default: all cores; does not change the result")
      ->check(whole_between(1, 1024, "4"));
  command->add_option("--backend", o.time.backend, "cpu, or cuda: fields are summed on a GPU; the same bits");
  command->add_option("-o,--out", o.files.strain, "file of h(t), first realisation: .hdf5, .txt, .csv, .png, .html");
  command->add_option("--asd", o.files.asd, "file of the spectrum of h: .txt .csv .hdf5 .json .png .html");
  command->add_option("--spectrogram", o.files.spectrogram,
                      "file of the spectrogram of h, first realisation: .png .html .txt .hdf5");
  command->add_option("--stride", o.files.stride, "stride of the spectrogram; default: 0.5 s")
      ->check(is_quantity(dim::time, "--stride", "0.5 s"));
  command->add_option("--save-motion", o.files.motion,
                      "file of the motion of the bodies, first realisation: .hdf5 .txt .csv");
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
