// SPDX-License-Identifier: BSD-3-Clause
// The commands. Each function adds one with its options, examples and help; the chosen command runs when the command
// line has been parsed and sets `exit_code`. The order in help and the task of each: tasks() in cli/options.cpp.
#pragma once

#include "base/namespaces.hpp"

namespace CLI {
class App;
}

namespace straytrace::scene {
class Scene;
}  // namespace straytrace::scene

namespace straytrace::session {
struct PrintOptions;
}  // namespace straytrace::session

namespace straytrace::cli {

// Model
void add_check(CLI::App&, int& exit_code);
void add_print(CLI::App&, int& exit_code);
void add_inspect(CLI::App&, int& exit_code);
void add_render(CLI::App&, int& exit_code);
void add_view(CLI::App&, int& exit_code);
// Light
void add_run(CLI::App&, int& exit_code);
void add_trace(CLI::App&, int& exit_code);
void add_importance(CLI::App&, int& exit_code);
void add_apertures(CLI::App&, int& exit_code);
void add_wave(CLI::App&, int& exit_code);
void add_ifo(CLI::App&, int& exit_code);
void add_ghosts(CLI::App&, int& exit_code);
// Noise
void add_noise(CLI::App&, int& exit_code);
void add_budget(CLI::App&, int& exit_code);
void add_scan(CLI::App&, int& exit_code);
void add_sensitivity(CLI::App&, int& exit_code);
void add_optimise(CLI::App&, int& exit_code);
void add_project(CLI::App&, int& exit_code);
void add_fringes(CLI::App&, int& exit_code);
void add_sensors(CLI::App&, int& exit_code);
// Data
void add_signal(CLI::App&, int& exit_code);
void add_couple(CLI::App&, int& exit_code);
void add_fit(CLI::App&, int& exit_code);
// Results
void add_paths(CLI::App&, int& exit_code);
void add_maps(CLI::App&, int& exit_code);
void add_report(CLI::App&, int& exit_code);
void add_diff(CLI::App&, int& exit_code);
// Cluster
void add_submit(CLI::App&, int& exit_code);
void add_merge(CLI::App&, int& exit_code);
// Look-up
void add_library(CLI::App&, int& exit_code);
void add_explain(CLI::App&, int& exit_code);
void add_schema(CLI::App&, int& exit_code);

// The model as `print` shows it, on stdout.
int print_resolved(Scene const&, PrintOptions const&);

}  // namespace straytrace::cli
