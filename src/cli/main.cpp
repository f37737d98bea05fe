// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <new>
#include <string_view>

#include "base/errors.hpp"
#include "base/text/words.hpp"
#include "cli/options.hpp"
#include "results/results.hpp"
#include "scene/scene_document.hpp"
#include "session/backend.hpp"
#include "session/build_info.hpp"
#include "session/open_run.hpp"
#include "session/options.hpp"

namespace straytrace::cli {
namespace {

// As text, as the list for scripts, or as an event.
void print_error(InputError const& e, bool json) {
  if (events_on())
    print_problems(e);
  else
    std::cerr << (json ? problems_as_json(e) : printable(e.what())) << '\n';
}

// For each error one sentence and what to write instead; the exit code.
int refuse(CLI::App& app, CLI::ParseError const& e, bool json) {
  CLI::App const* deepest = &app;
  std::string named;
  for (auto below = app.get_subcommands(); !below.empty(); below = deepest->get_subcommands()) {
    deepest = below.front();
    named += deepest->get_name() + " ";
  }
  InputError const first = in_our_words(*deepest, app, e, named);
  bool const value_missing = first.reason().ends_with("needs a value");  // there the words end, or stop making sense
  print_error(with_further_errors(first, app, !value_missing), json);
  return input_error;
}

// Before the command line is parsed.
bool asks_for_json(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    std::string_view const word = argv[i];
    if (word == "--format=json" || (word == "--format" && i + 1 < argc && argv[i + 1] == std::string_view("json")))
      return true;
  }
  return false;
}

// "scene.yaml=/tmp/text": the text is read where the model names the scene.
void add_unsaved(std::string const& pair) {
  std::size_t const equal = pair.rfind('=');
  if (equal == 0 || equal >= pair.size() - 1)
    throw InputError(fmt::format("--unsaved '{}' does not name two files", pair), "write --unsaved SCENE=FILE");
  set_unsaved(pair.substr(0, equal), read_file(pair.substr(equal + 1)));
}

// An unknown name would select another instruction set than the user believes.
void check_instruction_set() {
  constexpr std::array<std::string_view, 3> known{"portable", "avx2", "avx512"};
  char const* const wanted = std::getenv("STRAYTRACE_ISA");
  if (wanted && std::ranges::find(known, std::string_view(wanted)) == known.end())
    throw InputError(
        fmt::format("the environment variable STRAYTRACE_ISA names the unknown instruction set '{}'", wanted),
        "set it to portable, avx2 or avx512, or unset it");
}

void warn_of_unread_texts(bool json) {
  PrintOptions options;
  options.format = json ? "json" : "text";
  for (std::string const& name : unread_unsaved())
    print_warning(fmt::format("--unsaved: nothing read '{}'\n  name a file that the command reads", name), options);
}

std::string version_text() {
  return std::string("straytrace ") + build_info::version + " (" + build_info::commit + ")\n" + devices_text();
}

// For programs that run this one.
void add_program_options(CLI::App& app) {
  app.add_flag_callback("--events", print_events, "progress and problems as lines of JSON on stderr");
  app.add_option_function<std::vector<std::string>>(
         "--unsaved",
         [](std::vector<std::string> const& pairs) {
           for (std::string const& pair : pairs) add_unsaved(pair);
         },
         "SCENE=FILE: read FILE in place of SCENE, for unsaved text of an editor")
      ->allow_extra_args(false);
}

int answer(int argc, char** argv) {
  CLI::App app{"Simulate the stray-light noise of interferometric gravitational-wave detectors.", "straytrace"};
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text);
  app.footer(
      "Examples:\n"
      "  straytrace check examples/virgo_arm.yaml\n"
      "  straytrace run examples/virgo_arm.yaml -o out/\n"
      "Every command explains itself: straytrace run --help\n"
      "Exit codes: 0 done; 2 input error, nothing was run or written; 3 numerical failure; 4 no candidate meets the\n"
      "limits (optimise); 85 stopped on request, with a valid file that can be continued.");
  add_program_options(app);
  bool const json = asks_for_json(argc, argv);
  int exit_code = done;
  add_commands(app, exit_code);
  lay_out_help(app);
  try {
    check_instruction_set();
    app.parse(argc, argv);
  } catch (CLI::ParseError const& e) {
    return e.get_exit_code() == 0 ? app.exit(e) : refuse(app, e, json);
  } catch (InputError const& e) {
    print_error(with_further_errors(e, app, true), json);
    return input_error;
  } catch (std::filesystem::filesystem_error const& e) {
    print_error(InputError(fmt::format("cannot use '{}': {}", e.path1().string(), e.code().message()),
                           "check the name, its folder and their permissions"),
                json);
    return input_error;
  } catch (std::bad_alloc const&) {
    print_error(
        InputError("out of memory while reading the model or file", "use a smaller one, or a machine with more memory"),
        json);
    return numerical_failure;
  } catch (NumericalError const& e) {
    print_error(InputError(e.what(), "if the numbers of the input are sound, report it with the scene and the command"),
                json);
    return numerical_failure;
  } catch (std::exception const& e) {
    print_error(InputError(e.what(), "if this is no fault of the disk, report it with the scene and the command"),
                json);
    return numerical_failure;
  }
  if (exit_code == done) warn_of_unread_texts(json);
  if (!std::cout.flush()) {
    print_error(
        InputError("cannot write the results to the standard output", "check the disk or the program that reads them"),
        false);
    return input_error;
  }
  return exit_code;
}

}  // namespace
}  // namespace straytrace::cli

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the file size limit fails with a message, as on a full disk
  int const exit_code = straytrace::cli::answer(argc, argv);
  straytrace::session::close_mpi(exit_code);
  return exit_code;
}
