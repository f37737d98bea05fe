// SPDX-License-Identifier: BSD-3-Clause
#include "app/command_words.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <regex>

#include "base/form.hpp"
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

std::string choices_of(std::string const& option, std::string const& word, std::string const& list) {
  std::vector<std::string> known;
  for (std::size_t at = 0; at <= list.size();) {
    std::size_t const comma = std::min(list.find(',', at), list.size());
    known.push_back(list.substr(at, comma - at));
    at = comma + 1;
  }
  std::string const near = nearest_word(word, known);
  return fmt::format("{} cannot be '{}'\n  {}write one of: {}", option, word,
                     near.empty() ? "" : fmt::format("did you mean '{}'? ", near), fmt::join(known, ", "));
}

// The sentences of the library that people meet, in our grammar; empty for others.
std::string rewritten(std::string const& text, std::string const& named) {
  static std::regex const twice(R"((.+): At Most (\d+) required but received (\d+))"),
      value(R"((.+): \d+ required .*missing)"), choice(R"((.+): (.*) not in \{(.*)\})"), missing(R"((.+) is required)"),
      number(R"(Could not convert: (.+) = (.*))");
  std::smatch m;
  if (has_form(text, m, twice)) return fmt::format("{} is given {} times\n  give it once", m[1].str(), m[3].str());
  if (has_form(text, m, value)) return fmt::format("{} needs a value\n  write it behind it", m[1].str());
  if (has_form(text, m, choice)) return choices_of(m[1], m[2], m[3]);
  if (has_form(text, m, number))
    return fmt::format("{} cannot be '{}'\n  write a number without a unit", m[1].str(), m[2].str());
  if (text == "A subcommand is required") return "a command is missing\n  write one behind the name";
  if (has_form(text, m, missing))
    return m[1].str().starts_with('-') ? fmt::format("{} is missing\n  add it with its value", m[1].str())
                                       : fmt::format("'{0}' is missing\n  write straytrace {1}{0}", m[1].str(), named);
  return "";
}

}  // namespace

std::string in_our_words(CLI::App const& command, CLI::App const& app, CLI::ParseError const& e,
                         std::string const& named) {
  std::string const help = fmt::format("see straytrace {}--help", named);
  bool const takes_commands = !command.get_subcommands(nullptr).empty();
  std::string const name =
      takes_commands || dynamic_cast<CLI::ExtrasError const*>(&e) ? unknown_word(command, app) : "";
  if (name.empty()) {
    std::string const ours = rewritten(e.what(), named);
    return ours.empty() ? fmt::format("{}\n  {}", e.what(), help) : fmt::format("{}; {}", ours, help);
  }
  std::string const near = nearest_word(name, words_of(command));
  std::string const what = name.starts_with('-') ? "an option" : takes_commands ? "a command" : "expected";
  return fmt::format("'{}' is not {} here\n  {}{}", name, what,
                     near.empty() ? "" : fmt::format("did you mean '{}'? ", near), help);
}

}  // namespace straytrace
