// SPDX-License-Identifier: BSD-3-Clause
// straytrace paths: the ranked table of routes of a run.
#include <CLI/CLI.hpp>

#include <iostream>

#include "app/common_options.hpp"
#include "app/session.hpp"

namespace straytrace {
namespace {

int paths(Options const& options) {
  RunFile const file = read_run(options.input);
  Model const model = read_model(file.about.main_file, file.about.overrides, &file.about.files);
  NoiseBudget const* const budget = file.noise ? &*file.noise : nullptr;
  PathTable const table = table_for(file.trace.coupling, budget, model);
  RunContent const content = file.content();
  if (options.csv)
    std::cout << path_csv(table, content);
  else if (options.json())
    std::cout << path_json(table, content) << '\n';
  else
    std::cout << path_text(table, options.show ? options.show : model.paths_shown) << '\n';
  return done;
}

}  // namespace

void add_paths(CLI::App& app, Options& options, int& exit_code) {
  auto* const command = app.add_subcommand("paths", "ranked table of the routes by which light rejoins the mode");
  command->add_option("run", options.input, "run file (HDF5)")->required();
  command->add_option("--show", options.show, "rows");
  command->add_flag("--csv", options.csv, "all rows, all columns, all digits");
  add_format_option(*command, options);
  command->footer(
      "Examples:\n"
      "  straytrace paths out/run.h5 --show 20\n"
      "  straytrace paths out/run.h5 --csv > paths.csv");
  command->callback([&] { exit_code = paths(options); });
}

}  // namespace straytrace
