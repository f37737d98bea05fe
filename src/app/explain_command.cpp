// SPDX-License-Identifier: BSD-3-Clause
// straytrace explain: a key, a table, a unit, a message, or the chain of factors of one path. straytrace schema.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iostream>

#include "app/common_options.hpp"
#include "app/explain.hpp"
#include "app/language.hpp"
#include "base/message.hpp"
#include "base/quantity.hpp"

namespace straytrace {
namespace {

struct ExplainOptions {
  std::vector<std::string> words;
  std::size_t path = 1;
  double hz = 30;
};

// 'unit m/sqrt(Hz)' may stand in quotes as one word.
std::vector<std::string> words_of(ExplainOptions const& asked) {
  for (std::string const first : {"unit ", "h "})
    if (asked.words.size() == 1 && asked.words.front().starts_with(first))
      return {first.substr(0, first.size() - 1), asked.words.front().substr(first.size())};
  return asked.words;
}

std::string suggestion_for(std::string const& what) {
  std::string const near = nearest_key(what);
  return (near.empty() ? "" : fmt::format("did you mean '{}'? ", near)) + parts_like(what) +
         "write TABLE.KEY (cone.half_angle), a table (beam), a key (half_angle), PART.NUMBER (lens.diameter), "
         "'unit m/sqrt(Hz)', or the text of a message";
}

Explanation answer_to(ExplainOptions const& asked) {
  std::vector<std::string> const words = words_of(asked);
  if (words.front() == "unit" && words.size() == 2) return explain_unit(words[1]);
  if (words.front() == "h" && words.size() == 2) return explain_strain(words[1], asked.path, asked.hz);
  if (words.front() == "h" || words.front() == "unit")
    throw InputError(words.front() == "h"
                         ? "error: 'explain h' needs a run file\n  write straytrace explain h RUN.h5 --path 1"
                         : "error: 'explain unit' needs a unit\n  write straytrace explain unit 'm/sqrt(Hz)'");
  std::string const what = fmt::format("{}", fmt::join(words, " "));
  if (auto found = explain_key(what)) return *found;
  if (auto found = explain_library(what)) return *found;
  if (auto found = explain_column(what)) return *found;
  if (auto found = explain_message(what)) return *found;
  if (parse_unit(what)) return explain_unit(what);
  throw InputError(
      fmt::format("error: nothing in the language or the library is called '{}'\n  {}", what, suggestion_for(what)));
}

}  // namespace

void add_explain(CLI::App& app, Options& options, int& exit_code) {
  static ExplainOptions asked;
  auto* const command =
      app.add_subcommand("explain", "a key of the language, a part, a column, a unit, a message, or a path's factors");
  command
      ->add_option("what", asked.words,
                   "TABLE.KEY, TABLE, KEY, a thing of the library, a column of the path table, 'unit U', the text of a "
                   "message, or 'h RUN'")
      ->required();
  command->add_option("--path", asked.path, "of 'explain h': rank in the path table; 1 unless given")
      ->check(whole_between(1, 1e6, "3"));
  command->add_option("--at", asked.hz, "of 'explain h': frequency in Hz; 30 unless given")
      ->check(CLI::Range(1e-9, 1e9));
  add_format_option(*command, options);
  command->footer(
      "Examples:\n"
      "  straytrace explain cone.half_angle\n"
      "  straytrace explain virgo_baffle.inner_radius\n"
      "  straytrace explain unit 'm/sqrt(Hz)'\n"
      "  straytrace explain \"does not say which amplitude it is\"\n"
      "  straytrace explain h out/run.h5 --path 2 --at 10");
  command->callback([&] {
    Explanation const answer = answer_to(asked);
    std::cout << (options.json() ? answer.json.dump(1) + "\n" : answer.text);
    exit_code = done;
  });
}

void add_schema(CLI::App& app, Options&, int& exit_code) {
  auto* const command = app.add_subcommand("schema", "the JSON Schema of scenes and files of motion, for editors");
  command->footer(
      "Examples:\n"
      "  straytrace schema > straytrace-1.schema.json\n"
      "  straytrace schema | python3 -m json.tool > /dev/null");
  command->callback([&] {
    std::cout << language_schema();
    exit_code = done;
  });
}

}  // namespace straytrace
