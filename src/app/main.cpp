// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <iostream>

#include "app/build_info.hpp"
#include "app/options.hpp"
#include "base/message.hpp"
#include "base/table.hpp"

namespace straytrace {
namespace {

std::vector<std::string> words_of(CLI::App const& app) {
  std::vector<std::string> words;
  for (CLI::Option const* option : app.get_options())
    for (std::string const& name : option->get_lnames()) words.push_back("--" + name);
  for (CLI::App const* command : app.get_subcommands(nullptr)) words.push_back(command->get_name());
  return words;
}

// What the command line held that nobody asked for; empty when only the command is missing.
std::string unknown_word(CLI::App const& command, CLI::App const& app) {
  for (CLI::App const* a : {&command, &app})
    for (std::string const& word : a->remaining())
      if (word.starts_with('-')) return word.substr(0, word.find('='));
  auto const rest = app.remaining(true);
  return rest.empty() ? "" : rest.front();
}

// One sentence and what to write instead; the exit code.
int refuse(CLI::App const& app, CLI::ParseError const& e) {
  auto const chosen = app.get_subcommands();
  CLI::App const& command = chosen.empty() ? app : *chosen.front();
  std::string const help = fmt::format("see straytrace {}--help", chosen.empty() ? "" : command.get_name() + " ");
  std::string const name =
      chosen.empty() || dynamic_cast<CLI::ExtrasError const*>(&e) ? unknown_word(command, app) : "";
  if (name.empty()) {
    std::cerr << fmt::format("error: {}\n  {}\n", e.what(), help);
  } else {
    std::string const near = nearest_word(name, words_of(command));
    std::string const what = name.starts_with('-') ? "an option" : chosen.empty() ? "a command" : "expected";
    std::cerr << fmt::format("error: '{}' is not {} here\n  {}{}\n", name, what,
                             near.empty() ? "" : fmt::format("did you mean '{}'? ", near), help);
  }
  return input_error;
}

// Messages without a place in a file come as bare sentences.
std::string sentence(InputError const& e) {
  std::string const text = e.what();
  return text.find("error: ") == text.npos ? "error: " + text : text;
}

}  // namespace
}  // namespace straytrace

int main(int argc, char** argv) {
  using namespace straytrace;
  CLI::App app{"straytrace: stray-light noise of interferometric gravitational-wave detectors", "straytrace"};
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("straytrace ") + build_info::version + " (" + build_info::commit + ")");
  app.footer("Every command explains itself: straytrace run --help");
  Options options;
  int exit_code = done;
  for (auto* add : {add_run, add_check, add_trace, add_noise, add_paths, add_maps, add_inspect, add_render,
                    add_importance, add_apertures, add_ghosts})
    add(app, options, exit_code);
  try {
    app.parse(argc, argv);
  } catch (CLI::ParseError const& e) {
    return e.get_exit_code() == 0 ? app.exit(e) : refuse(app, e);
  } catch (InputError const& e) {
    std::cerr << (options.json() ? problems_as_json(e) : sentence(e)) << '\n';
    return input_error;
  } catch (std::filesystem::filesystem_error const& e) {
    std::cerr << fmt::format("error: cannot use '{}': {}\n", e.path1().string(), e.code().message());
    return input_error;
  } catch (std::exception const& e) {
    std::cerr << "error: " << e.what() << '\n';
    return numerical_failure;
  }
  if (!std::cout.flush()) {
    std::cerr << "error: the results could not be written to the standard output\n";
    return input_error;
  }
  return exit_code;
}
