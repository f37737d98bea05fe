// SPDX-License-Identifier: BSD-3-Clause
// straytrace trace: scene -> coupling table, without any motion.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <iostream>

#include "app/common_options.hpp"
#include "app/session.hpp"
#include "app/tell.hpp"
#include "report/merit.hpp"
#include "report/receivers.hpp"

namespace straytrace {
namespace {

int trace_only(Options const& options) {
  Model model = read_model(options.input, options.overrides);
  apply(options, model);
  tell_warnings(model, options);
  TraceResult const traced = trace_model(model, options, options.out);
  RunContent const content = content_of(model, traced, nullptr);
  write_run(options.out, content);
  PathTable const paths = table_for(traced.coupling, nullptr, model);
  bool const received = !content.receivers.empty();
  if (options.json()) {
    std::cout << path_json(paths, content) << '\n';
  } else {
    if (model.detector) std::cout << path_text(paths, model.paths_shown) << '\n';
    if (received) std::cout << receiver_text(receiver_table(content), model.paths_shown) << '\n';
    std::cout << "Where the light went\n\n" << books_text(content) << '\n' << objects_text(content);
  }
  if (!options.quiet) std::cerr << merit_text(merits(content), merits_shown);
  if (!options.quiet && model.detector)
    std::cerr << fmt::format("coupling table in {}; project motion with: straytrace noise {}\n", options.out,
                             options.out);
  else if (!options.quiet)
    std::cerr << fmt::format("light on receivers in {}; more with: straytrace paths {} --census\n", options.out,
                             options.out);
  if (traced.checkpointed() && !options.quiet) std::cerr << how_to_go_on;
  return traced.checkpointed() ? checkpointed : done;
}

}  // namespace

void add_trace(CLI::App& app, Options& options, int& exit_code) {
  auto* const command = app.add_subcommand("trace", "trace light into a coupling table; no motion, no noise yet");
  add_scene_options(*command, options);
  add_trace_options(*command, options);
  command->add_option("-o,--out", options.out, "run file to write (HDF5)")->required();
  command->footer(
      "Examples:\n"
      "  straytrace trace examples/virgo_arm.yaml -o virgo.h5 --histories 1e6\n"
      "  straytrace trace examples/virgo_arm.yaml -o virgo.h5 --until \"h_total < 2 %\" --seed 7");
  command->callback([&] { exit_code = trace_only(options); });
}

}  // namespace straytrace
