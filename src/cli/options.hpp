// SPDX-License-Identifier: BSD-3-Clause
// Options common to several commands, and the help of the program.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

#include "base/errors.hpp"
#include "base/namespaces.hpp"
#include "session/options.hpp"

namespace straytrace::cli {

// Declares options common to several commands.

void add_scene_options(CLI::App&, SceneOptions&,
                       char const* input = "scene file (YAML)");  // SCENE, -p, --quiet, --format
void add_history_options(CLI::App&, TraceOptions&);               // --histories, --seed
void add_trace_options(CLI::App&, TraceOptions&);  // these, --until, --threads, --max-time, --checkpoint, --force
void add_force_option(CLI::App&, bool& force);
void add_live_options(CLI::App&, LiveOptions&, std::string const& help);  // --live, --live-port, --open
void add_overrides(CLI::App&, std::vector<std::string>& overrides, std::string const& help);  // -p, --param
void add_param_option(CLI::App&, SceneOptions&);                                              // the same of a scene
void add_format_option(CLI::App&, PrintOptions&);
void refuse_two_formats(bool csv, PrintOptions const&);  // InputError for --csv with --format json

constexpr double lowest_frequency = 1e-6, highest_frequency = 1e6;  // Hz, of points and curves
// "10 Hz, 1 kHz" in Hz; `option` for the message. Throws InputError.
std::vector<double> parse_frequencies(std::string const& list, char const* option);

// Marks an option for a file that the command writes. A file that cannot be written, or that another option or argument
// of the command names as its input, is an error before any work.
void mark_output(CLI::App& command, CLI::Option& option);
void refuse_overwriting(std::string const& output, std::string const& input);  // InputError where both are one file

void drop_slashes(std::string& folder);  // at its end

// Refuses, before any work and together with the errors of other options, a text that `read` throws InputError for.
template <class Read>
CLI::Validator readable(Read read) {
  return {[read](std::string const& text) -> std::string {
            read(text);
            return {};
          },
          ""};
}

// "'x' is not a number from 0.1 to 1000; write for example 20". In place of CLI::Range, which accepts nan.
CLI::Validator number_between(double low, double high, std::string const& example);
// "'x' is not a whole number from 1 to 1e6; write for example 20"
CLI::Validator whole_between(double low, double high, std::string const& example);

// The problem of a command line and the remedy. `named`: the commands so far, each followed by a space.
InputError in_our_words(CLI::App const& command, CLI::App const& app, CLI::ParseError const&, std::string const& named);
// The error that ended the parsing, and those of the other options: wrong values, unknown and missing options.
// `complete`: all words were parsed.
InputError with_further_errors(InputError const& first, CLI::App& app, bool complete);

// The layout of --help: purpose, examples, usage, options in groups, notes.

// Adds every command, under its task.
void add_commands(CLI::App&, int& exit_code);

// Gives the program and each of its commands the layout, and each option its group: the one named where the option is
// declared, otherwise that of its name. Call it when all commands have been added.
void lay_out_help(CLI::App&);

// The groups of options, in the order in which help prints them.
std::vector<std::string> const& option_groups();

}  // namespace straytrace::cli
