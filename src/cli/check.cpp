// SPDX-License-Identifier: BSD-3-Clause
// straytrace check: all checks that need no tracing. straytrace print: the model as interpreted.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <iostream>
#include <memory>

#include "base/errors.hpp"
#include "base/text/json_text.hpp"
#include "base/text/words.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "scene/scene_document.hpp"
#include "session/light/cavity_waves.hpp"
#include "session/light/lit_table.hpp"
#include "session/light/optical_network.hpp"
#include "session/model.hpp"
#include "session/open_run.hpp"

namespace straytrace::cli {
namespace {

constexpr int newest_format = 1;

struct CheckOptions : SceneOptions {
  bool resolved = false, migrate = false, strict = false;
};

int check_motion(Scene const& scene, CheckOptions const& options) {
  for (auto const& [name, node] : scene.table("bodies").items())
    if (node.kind() == Node::Kind::table) node.has("pivot");
  std::vector<std::string> const names = bodies_and_modes(scene.table("bodies"));
  read_motion_file(scene);
  std::string const warnings = scene.warnings();
  if (!options.quiet || options.strict) std::cerr << (options.json() ? warnings_as_json(scene) : warnings);
  if (options.strict && !warnings.empty()) return input_error;
  if (options.resolved) return print_resolved(scene, options);
  if (options.json())
    std::cout << json_text(nlohmann::ordered_json{{"ok", true}, {"bodies", names.size()}}) << '\n';
  else
    std::cout << fmt::format("{}: motion of {}, for: straytrace noise RUN --motion {}\nno errors\n", options.input,
                             names.size() == 1 ? "1 body" : fmt::format("{} bodies", names.size()), options.input);
  return done;
}

int check_network(Scene const& scene, CheckOptions const& options) {
  NetworkModel const model = read_lone_network(scene);
  std::string const warnings = scene.warnings();
  if (!options.quiet || options.strict) std::cerr << (options.json() ? warnings_as_json(scene) : warnings);
  if (options.strict && !warnings.empty()) return input_error;
  if (options.resolved) return print_resolved(scene, options);
  std::size_t const components = model.network.components().size(), readouts = model.readouts.size();
  if (options.json())
    std::cout << json_text(nlohmann::ordered_json{{"ok", true}, {"components", components}, {"readouts", readouts}})
              << '\n';
  else
    std::cout << fmt::format("{}: network of {} with {}, for: straytrace ifo {}\nno errors\n", options.input,
                             counted(components, "component"), counted(readouts, "read-out"), options.input);
  return done;
}

// Format 1 is the first; read_scene() has rejected any other.
int migrate(CheckOptions const& options) {
  read_scene(options.input, options.overrides).throw_if_problems();
  std::cout << fmt::format("{}: format {} is the newest: nothing to rewrite\n", options.input, newest_format);
  return done;
}

int check(CheckOptions const& options) {
  if (Scene const scene = read_scene(options.input, options.overrides); only_motion(scene))
    return check_motion(scene, options);
  else if (only_network(scene))
    return check_network(scene, options);
  Model const model = read_model(options.input, options.overrides);
  if (!options.quiet || options.strict) std::cerr << (options.json() ? model.warnings_json : model.warnings);
  if (options.strict && !model.warnings.empty()) return input_error;
  if (options.resolved) return print_resolved(model.scene, options);
  if (options.json()) {
    World const& world = model.world;
    nlohmann::ordered_json const found{{"ok", true},
                                       {"surfaces", world.surfaces().size()},
                                       {"groups", world.groups().size()},
                                       {"bodies", world.bodies().size()},
                                       {"ports", world.ports().size()},
                                       {"receivers", world.receivers().size()},
                                       {"lit", lit_json(model)},
                                       {"wave", wave_json(model)},
                                       {"model_hash", model.hash()}};
    std::cout << json_text(found) << '\n';
    return done;
  }
  std::size_t const count = model.world.receivers().size();
  std::string const receivers = count == 0 ? "" : ", " + counted(count, "receiver");
  std::size_t const bodies = model.world.bodies().size();
  std::cout << fmt::format("{}: {} in {}, {}, {}{}\n", options.input, counted(model.world.surfaces().size(), "surface"),
                           counted(model.world.groups().size(), "group"),
                           bodies == 1 ? "1 body" : fmt::format("{} bodies", bodies),
                           counted(model.world.ports().size(), "port"), receivers);
  for (std::string const& note : model.world.notes) std::cout << note << '\n';
  std::cout << lit_table(model) << wave_line(model);
  if (model.detector) std::cout << model.detector->description() << '\n';
  std::cout << "no errors\n";
  return done;
}

}  // namespace

void add_check(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<CheckOptions>();
  CheckOptions& o = *options;
  auto* const command = app.add_subcommand("check", "Find the errors in a scene without tracing.");
  add_scene_options(*command, o);
  command->add_flag("--resolved", o.resolved,
                    "print the model with every default, in SI: the same as straytrace print");
  command->add_flag("--migrate", o.migrate, "rewrite a scene of an older format (none exists yet)");
  command->add_flag("--strict", o.strict, "warnings count as errors");
  command->footer(
      "Examples:\n"
      "  straytrace check examples/virgo_arm.yaml\n"
      "  straytrace check examples/virgo_arm.yaml -p rim=48cm --format json");
  command->callback([options, &exit_code] { exit_code = options->migrate ? migrate(*options) : check(*options); });
}

// straytrace print: the model as interpreted.

int print_resolved(Scene const& scene, PrintOptions const& options) {
  if (options.json())
    std::cout << json_text(model_as_json(scene), 1) << '\n';
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
