// SPDX-License-Identifier: BSD-3-Clause
// straytrace run: the whole program in one function. Start reading here.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <iostream>

#include "app/common_options.hpp"
#include "app/earlier.hpp"
#include "app/report_page.hpp"
#include "app/session.hpp"
#include "app/tell.hpp"
#include "report/band.hpp"
#include "report/merit.hpp"
#include "report/receivers.hpp"

namespace straytrace {
namespace {

int run(Options const& options) {
  Earlier const earlier(options.input);           // a run file is made again from its own content
  Model model = earlier.read(options.overrides);  // input file -> world, motion, detector
  apply(options, model);
  tell_warnings(model, options);

  make_folder(options.out);
  FolderLock const lock(options.out);
  TraceResult const traced = trace_model(model, options, options.out + "/run.h5");  // world -> coupling table
  std::optional<NoiseBudget> budget;                                                // from here on nothing is expensive
  if (model.detector) budget = model.project_with_bands(traced.coupling);
  if (budget) tell_warnings(*budget, options);
  PathTable const paths = table_for(traced.coupling, budget ? &*budget : nullptr, model);
  RunContent const content = earlier.completed(content_of(model, traced, budget ? &*budget : nullptr));
  std::string const undrawn = write_results(options.out, content, paths, model);
  Picture const picture{"png", undrawn.empty() ? read_file(options.out + "/report.png") : ""};
  write_file(options.out + "/report.html", report_page(content, paths, model, {}, picture));

  if (options.json()) {
    std::cout << summary_json(content, paths) << '\n';
  } else {
    if (budget)
      std::cout << path_text(paths, model.paths_shown) << '\n'
                << band_summary(*budget, paths.frequencies) << '\n'
                << verdict_sentence(*budget, budget->grid.edges.front(), budget->grid.edges.back()) << "\n\n"
                << headline(*budget, paths) << '\n';
    if (!content.receivers.empty())
      std::cout << (budget ? "\n" : "") << receiver_text(receiver_table(content), model.paths_shown);
    if (!options.quiet)
      std::cerr << merit_text(merits(content), merits_shown)
                << fmt::format("results in {}: report.html report.png report.txt{} paths.csv{} run.h5\n", options.out,
                               budget ? " h_asd.txt" : "", content.receivers.empty() ? "" : " receivers.csv");
  }
  if (traced.checkpointed() && !options.quiet) std::cerr << how_to_go_on;
  if (!undrawn.empty()) std::cerr << "warning: report.png was not drawn: " << undrawn << '\n';
  return traced.checkpointed() ? checkpointed : done;
}

}  // namespace

void add_run(CLI::App& app, Options& options, int& exit_code) {
  auto* const command = app.add_subcommand("run", "check, trace, noise and report in one go");
  add_scene_options(*command, options, "scene file (YAML), or run file (HDF5) to make again");
  add_trace_options(*command, options);
  command->add_option("-o,--out", options.out, "folder for the results")->required();
  command->footer(
      "Examples:\n"
      "  straytrace run examples/virgo_arm.yaml -o out/\n"
      "  straytrace run examples/virgo_arm.yaml -o fine/ --until \"h_total < 1 %\" -p rim=48cm\n"
      "  straytrace run out/run.h5 -o again/\n"
      "A run file is made again from its own content, with the same numbers.\n"
      "Interrupted with Ctrl-C it leaves a valid result and exits with 85; the same command goes on from there.");
  command->callback([&] {
    while (options.out.size() > 1 && options.out.ends_with('/')) options.out.pop_back();
    exit_code = run(options);
  });
}

}  // namespace straytrace
