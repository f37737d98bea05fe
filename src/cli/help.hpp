// SPDX-License-Identifier: BSD-3-Clause
// The layout of --help: purpose, examples, usage, options in groups, notes.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

#include "base/namespaces.hpp"

namespace straytrace::cli {

// Adds every command, under its task.
void add_commands(CLI::App&, int& exit_code);

// Gives the program and each of its commands the layout, and each option its group: the one named where the option is
// declared, otherwise that of its name. Call it when all commands have been added.
void lay_out_help(CLI::App&);

// The groups of options, in the order in which help prints them.
std::vector<std::string> const& option_groups();

}  // namespace straytrace::cli
