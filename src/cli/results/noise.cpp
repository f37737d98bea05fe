// SPDX-License-Identifier: BSD-3-Clause
// straytrace noise: run file -> h(f), with its own motion or another, without tracing.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "results/curves/band.hpp"
#include "session/decide/what_if.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"

namespace straytrace::cli {
namespace {

struct NoiseOptions : PrintOptions {
  std::string input, out, motion, response;
  std::vector<std::string> set;  // "steel.brdf=5e-3/sr"
  std::size_t show = 0;          // rows; 0: as in the scene
  bool force = false;
};

std::string name_of(std::string const& path) { return std::filesystem::path(path).filename().string(); }

// Into the folder of the run itself, whose own motion or responses are then replaced.
void warn_of_own_folder(NoiseOptions const& options) {
  std::error_code none;
  bool const own = std::filesystem::equivalent(std::filesystem::path(options.out) / "run.h5", options.input, none);
  if (own && !(options.motion.empty() && options.response.empty()))
    std::cerr << fmt::format(
        "warning: '{}' is the folder of the run itself: its results and run file are now those of {}\n  choose another "
        "one with -o to keep both\n",
        options.out, name_of(options.motion.empty() ? options.response : options.motion));
}

// A run file holds the light as it was traced.
void refuse_files_of_what_if(NoiseOptions const& options) {
  if (options.set.empty() || options.out.empty()) return;
  throw InputError("--set does not go with -o: a run file holds the light as it was traced",
                   "print the result, with --format json for all curves; to keep a run, change the scene and trace it");
}

// With the files of --motion and --response; `files` gets their texts. Throws one InputError for all options.
std::unique_ptr<OpenRun> opened(NoiseOptions const& options, FileTexts& files) {
  std::vector<InputError> errors;
  std::unique_ptr<OpenRun> run;
  collect(errors, [&] { run = std::make_unique<OpenRun>(options.input, options.motion, &files); });
  if (!run) run = std::make_unique<OpenRun>(options.input);  // throws where this file is the reason
  collect(errors, [&] {
    if (options.response.empty()) return;
    replace_motion(run->model, options.response, nullptr, &files, true);
    run->projected_with += (run->projected_with.empty() ? "" : "\n") + name_of(options.response);
  });
  if (!errors.empty() && !options.set.empty()) collect(errors, [&] { what_if(*run, options.set); });
  throw_all(errors);
  return run;
}

// The noise as it would be with other inputs.
int noise_if(NoiseOptions const& options, OpenRun& run) {
  WhatIf const changed = what_if(run, options.set);
  CouplingTable const& light = changed.light;
  print_warnings(changed.model, options);
  NoiseBudget const budget = changed.model.project_with_bands(light);
  print_warnings(budget, options);
  PathTable const paths = table_for(light, &budget, changed.model);
  TraceResult trace = run.file.trace;
  trace.coupling = light;
  RunContent content = run.file.content();
  content.trace = &trace;
  content.noise = &budget;
  content.interferometer = changed.model.detector->description();
  for (std::string const& statement : changed.statements) content.warnings.push_back("what if " + statement);
  if (!changed.warning.empty()) {
    content.warnings.push_back(changed.warning);
    print_warning(changed.warning, options);
  }
  if (options.json()) {
    std::cout << summary_json(content, paths) << '\n';
    return done;
  }
  for (std::string const& statement : changed.statements) std::cout << "what if " << statement << '\n';
  std::cout << '\n'
            << path_text(paths, options.show ? options.show : changed.model.paths_shown) << '\n'
            << band_summary(budget, paths.frequencies) << '\n'
            << headline(budget, paths) << '\n';
  return done;
}

// Throws InputError where the output would replace the run of another scene or seed without --force.
void keep_other_runs(NoiseOptions const& options, bool alone, RunFile const& file) {
  if (alone)
    earlier_run(options.out, file.about.model_hash, file.trace.coupling.seed, options.force);
  else if (!options.out.empty() && std::filesystem::is_directory(options.out))
    earlier_run(options.out + "/run.h5", file.about.model_hash, file.trace.coupling.seed, options.force);
}

int noise(NoiseOptions const& options) {
  auto const start = std::chrono::steady_clock::now();
  refuse_files_of_what_if(options);
  FileTexts files;
  std::unique_ptr<OpenRun> const run = opened(options, files);
  if (!options.set.empty()) return noise_if(options, *run);
  RunFile const& file = run->file;
  ProjectionModel const& model = run->model;
  bool const alone = options.out.ends_with(".h5");  // only the run file
  keep_other_runs(options, alone, file);
  std::optional<OutputFolder> folder;
  if (!alone && !options.out.empty()) folder.emplace(options.out);
  print_warnings(model, options);
  NoiseBudget const budget = model.project_with_bands(file.trace.coupling);
  print_warnings(budget, options);
  double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  PathTable const paths = table_for(file.trace.coupling, &budget, model);
  RunContent content = file.content();
  content.noise = &budget;
  content.interferometer = model.detector->description();
  content.files = files;
  if (!options.motion.empty() && !model.warnings.empty()) content.warnings.push_back(model.warnings);
  content.motion_file = run->projected_with;
  if (options.json()) {
    std::cout << summary_json(content, paths) << '\n';
  } else {
    std::cout << path_text(paths, options.show ? options.show : model.paths_shown) << '\n'
              << band_summary(budget, paths.frequencies) << '\n'
              << headline(budget, paths) << '\n';
    if (!options.quiet) std::cerr << fmt::format("projected in {:.2f} s without tracing\n", seconds);
  }
  if (options.out.empty()) return done;
  bool const tells = !options.json() && !options.quiet;
  if (alone) {
    write_run(options.out, content);
    if (tells) std::cerr << fmt::format("run file: {}\n", options.out);
    return done;
  }
  warn_of_own_folder(options);
  std::string const undrawn = write_results(options.out, content, paths, model);
  if (tells) std::cerr << results_line(options.out, content, "", undrawn.empty());
  if (!undrawn.empty()) std::cerr << "warning: report.png was not drawn: " << undrawn << '\n';
  return done;
}

}  // namespace

void add_noise(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<NoiseOptions>();
  NoiseOptions& o = *options;
  auto* const command = app.add_subcommand("noise", "Project motion through a traced run: h(f) in about a second.");
  command->add_option("run", o.input, "run file (HDF5)")->required();
  command->add_option("--motion", o.motion,
                      "YAML file with 'straytrace: 1' and 'bodies' (also 'noise', 'interferometer') to use instead");
  command->add_option("--response", o.response,
                      "YAML file with 'straytrace: 1' and 'interferometer: {responses: ...}', new responses of ports");
  command->add_option("--set", o.set,
                      "other inputs, where the run has the exact answer: steel=x2, steel=black, steel.brdf=5e-3/sr, "
                      "tube.motion=x2, interferometer.mirror_mass=100kg");
  command->add_option("-o,--out", o.out,
                      "folder for curves, tables and picture; a name that ends with .h5: the run file alone");
  add_force_option(*command, o.force);
  command->add_option("--show", o.show, "rows of the path table")->check(whole_between(1, 1e6, "20"));
  command->add_flag("--quiet", o.quiet, "results only, no warnings");
  add_format_option(*command, o);
  command->footer(
      "Examples:\n"
      "  straytrace noise out/run.h5\n"
      "  straytrace noise out/run.h5 --motion examples/storm.yaml -o storm/\n"
      "  straytrace noise out/run.h5 --set baffle=x0.5 --set tube.motion=x2");
  command->callback([options, &exit_code] {
    drop_slashes(options->out);
    exit_code = noise(*options);
  });
}

}  // namespace straytrace::cli
