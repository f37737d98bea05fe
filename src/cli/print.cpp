// SPDX-License-Identifier: BSD-3-Clause
// straytrace print: the model as interpreted.
#include <CLI/CLI.hpp>

#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "session/diagnostics.hpp"
#include "session/model.hpp"
#include "session/open_run.hpp"

namespace straytrace::cli {

int print_resolved(Scene const& scene, PrintOptions const& options) {
  if (options.json())
    std::cout << model_as_json(scene).dump(1) << '\n';
  else
    std::cout << printed_model(scene);
  return done;
}

namespace {

struct PrintCommandOptions : SceneOptions {
  bool resolved = false;
};

}  // namespace

void add_print(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<PrintCommandOptions>();
  PrintCommandOptions& o = *options;
  auto* const command = app.add_subcommand("print", "Print the model as interpreted, with every value in SI.");
  add_scene_options(*command, o, "scene, or file of motion");
  command->add_flag("--resolved", o.resolved,
                    "with every default and the line of origin of each value; this is also the default");
  command->footer(
      "Examples:\n"
      "  straytrace print --resolved examples/virgo_arm.yaml\n"
      "  straytrace print examples/virgo_arm.yaml -p rim=48cm --format json");
  command->callback([options, &exit_code] {
    Scene const scene = read_by_all(options->input, options->overrides);
    print_warnings(scene, *options);
    exit_code = print_resolved(scene, *options);
  });
}

}  // namespace straytrace::cli
