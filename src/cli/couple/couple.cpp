// SPDX-License-Identifier: BSD-3-Clause
// straytrace couple: from injections to coupling functions.
#include <CLI/CLI.hpp>

#include "cli/commands.hpp"
#include "cli/couple/couple_data.hpp"

namespace straytrace::cli {

void add_couple(CLI::App& app, int& exit_code) {
  auto* const command = app.add_subcommand(
      "couple", "Measure coupling functions from injections, taps and shakers, or predict them from a run.");
  command->require_subcommand(1);
  for (auto* add : {add_couple_noise, add_couple_taps, add_couple_lines, add_couple_ramp, add_couple_sweep,
                    add_couple_impulse, add_couple_events, add_couple_predict})
    add(*command, exit_code);
  command->footer(
      "Examples:\n"
      "  straytrace couple noise --witness examples/data/shaken.csv::ACC --target examples/data/shaken.csv::H "
      "--injection 24..48 --quiet 0..24 --segment \"1 s\"\n"
      "  straytrace couple predict demo/run.h5 --body tube --axis z");
}

}  // namespace straytrace::cli
