// SPDX-License-Identifier: BSD-3-Clause
// straytrace report: a run as one HTML file. straytrace view: a scene, or a run, in three dimensions.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <iostream>

#include "app/common_options.hpp"
#include "app/earlier.hpp"
#include "app/report_page.hpp"
#include "app/session.hpp"
#include "trace/estimate/importance.hpp"

namespace straytrace {
namespace {

bool is_scene(std::string const& name) { return name.ends_with(".yaml") || name.ends_with(".yml"); }

// A run with its model, steered as it was traced, so that its histories can be followed again.
struct Opened {
  RunFile file;
  Model model;
  RunContent content;
  PathTable table;
  explicit Opened(std::string const& name)
      : file(read_run(name)), model(read_model(file.about.main_file, file.about.overrides, &file.about.files)) {
    replace_as_before(model, file.about);
    steer(model.world);
    content = file.content();
    table = table_for(file.trace.coupling, content.noise, model);
  }
};

std::string beside(std::string const& input, std::string const& name) {
  return (std::filesystem::path(input).parent_path() / name).string();
}

int report(Options const& options, ReportWanted const& wanted) {
  if (is_scene(options.input))
    throw InputError(
        fmt::format("error: '{}' is a scene, and a report is about a run\n  trace it first: straytrace run {} -o out/",
                    options.input, options.input));
  Opened const run(options.input);
  std::string message;
  std::string const svg = wanted.has("budget") ? budget_svg(options.input, message) : "";
  if (!message.empty() && !options.quiet)
    std::cerr << "warning: without scripts the report has no picture: " << message << '\n';
  std::string const out = options.out.empty() ? beside(options.input, "report.html") : options.out;
  write_file(out, report_page(run.content, run.table, run.model, wanted, svg));
  if (!options.quiet) std::cerr << fmt::format("report: {}\n", out);
  return done;
}

int view(Options const& options, ViewWanted const& wanted) {
  std::string const out = options.out.empty() ? "view.html" : options.out;
  if (is_scene(options.input)) {
    Model model = read_model(options.input, options.overrides);
    if (!options.quiet) std::cerr << model.warnings;
    steer(model.world);
    write_file(out, view_page(model, nullptr, nullptr, wanted));
  } else {
    Opened const run(options.input);
    write_file(out, view_page(run.model, &run.content, &run.table, wanted));
  }
  if (!options.quiet) std::cerr << fmt::format("view: {}\n", out);
  return done;
}

}  // namespace

void add_report(CLI::App& app, Options& options, int& exit_code) {
  auto* const command =
      app.add_subcommand("report", "one HTML file about a run, for a logbook: opens anywhere, offline");
  static ReportWanted wanted;
  command->add_option("run", options.input, "run file (HDF5)")->required();
  command->add_option("-o,--out", options.out, "file to write; default: report.html beside the run");
  command->add_option("--paths", wanted.rows, "rows of the path table whose paths are drawn; 50 unless given")
      ->check(whole_between(0, 1e5, "20"));
  command->add_option("--show", wanted.paths, "paths drawn of each of them; 12 unless given")
      ->check(whole_between(1, 512, "30"));
  command
      ->add_option("--pictures", wanted.pictures,
                   "of budget, scene, maps, ghosts, materials, convergence; default: all")
      ->delimiter(',')
      ->check(CLI::IsMember(report_pictures()));
  command->add_option("--title", wanted.title, "instead of that of the scene");
  command->add_flag("--quiet", options.quiet, "no messages");
  command->footer(
      "Examples:\n"
      "  straytrace report out/run.h5\n"
      "  straytrace report out/run.h5 -o arm.html --title \"Arm, first look\" --pictures budget,scene");
  command->callback([&] { exit_code = report(options, wanted); });
}

void add_view(CLI::App& app, Options& options, int& exit_code) {
  auto* const command =
      app.add_subcommand("view", "a scene in three dimensions with beams, ghosts and sample rays; of a run also paths");
  static ViewWanted wanted;
  command->add_option("scene", options.input, "scene file (YAML), or run file (HDF5)")->required();
  command->add_option("-p,--param", options.overrides, "set a parameter, for example -p rim=48cm")
      ->allow_extra_args(false);
  command->add_option("-o,--out", options.out, "file to write; default: view.html");
  command->add_option("--rays", wanted.rays, "sample histories; 200 unless given")->check(whole_between(0, 1e5, "500"));
  command->add_option("--show", wanted.rows, "of a run: rows of the path table whose paths are drawn; 12 unless given")
      ->check(whole_between(0, 1e4, "30"));
  command->add_option("--title", wanted.title, "instead of that of the scene");
  command->add_flag("--quiet", options.quiet, "no messages");
  command->footer(
      "Examples:\n"
      "  straytrace view examples/bench.yaml -o bench.html\n"
      "  straytrace view out/run.h5 --show 12 -o paths.html");
  command->callback([&] { exit_code = view(options, wanted); });
}

}  // namespace straytrace
