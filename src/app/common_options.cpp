// SPDX-License-Identifier: BSD-3-Clause
#include "app/common_options.hpp"

#include <fmt/format.h>

#include "app/model.hpp"
#include "base/constants.hpp"

namespace straytrace {
namespace {

// Numbers as people write them, 1e6 as well.
CLI::Validator number_between(double low, double high, std::string const& example) {
  return {[=](std::string const& text) -> std::string {
            double value = 0;
            if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return {};
            return fmt::format("'{}' is not a number from {:g} to {:g}; write for example {}", text, low, high,
                               example);
          },
          ""};
}

}  // namespace

CLI::Validator whole_between(double low, double high, std::string const& example) {
  return {[=](std::string const& text) -> std::string {
            bool const digits = !text.empty() && text.find_first_not_of("0123456789") == text.npos;
            if (digits && text.size() < 17 && std::stod(text) >= low && std::stod(text) <= high) return {};
            return fmt::format("'{}' is not a whole number from {:.0f} to {:.0f}; write for example {}", text, low,
                               high, example);
          },
          ""};
}

void add_format_option(CLI::App& command, Options& options) {
  command.add_option("--format", options.format, "text or json")->check(CLI::IsMember({"text", "json"}));
}

void refuse_two_formats(Options const& options) {
  if (options.csv && options.json())
    throw InputError("error: --csv and --format json are two forms of one answer\n  choose one of them");
}

void throw_all(std::vector<InputError> const& errors) {
  if (errors.empty()) return;
  if (errors.size() == 1) throw errors.front();
  std::vector<Problem> problems;
  std::vector<std::string> files{""}, texts;
  for (InputError const& e : errors) {
    auto const first = std::uint32_t(files.size());
    files.insert(files.end(), e.files.begin(), e.files.end());
    for (Problem p : e.problems) {
      p.place.file += first;
      problems.push_back(p);
    }
    std::string const text = e.what();
    if (e.problems.empty()) problems.push_back({{}, text.starts_with("error: ") ? text.substr(7) : text, ""});
    texts.push_back(text.find("error: ") == text.npos ? "error: " + text : text);
  }
  throw InputError(problems, fmt::format("{}", fmt::join(texts, "\n")), files);
}

void add_scene_options(CLI::App& command, Options& options, char const* input) {
  command.add_option("scene", options.input, input)->required();
  command.add_option("-p,--param", options.overrides, "set a parameter, for example -p rim=48cm")
      ->allow_extra_args(false);
  command.add_flag("--quiet", options.quiet, "no progress, no warnings");
  add_format_option(command, options);
}

void add_history_options(CLI::App& command, Options& options) {
  command
      .add_option_function<double>(
          "--histories", [&](double n) { options.histories = std::uint64_t(n); },
          "at most so many histories, rounded up to whole blocks of 4096 (few ones: of 512, 64 or 8)")
      ->check(number_between(1, 1e12, "1e6"));
  command.add_option("--seed", options.seed, "of the random numbers; the same seed gives the same bits")
      ->check(whole_between(0, 9e15, "7"));
}

void add_trace_options(CLI::App& command, Options& options) {
  add_history_options(command, options);
  command
      .add_option("--until", options.until,
                  "stop rule: \"h_total < 5 %\", \"routes < 10 %\", \"receiver:PD < 5 %\", \"class:* < 10 %\", \"10 "
                  "min\", or a list; 'histories' of the scene stays the upper limit")
      ->check([](std::string const& rule) { return std::string(rule.empty() ? "'' is not a stop rule" : ""); });
  command.add_option("--threads", options.threads, "default: all cores; does not change the result")
      ->check(whole_between(1, 1024, "4"));
  command.add_option(
      "--backend", options.backend,
      "cpu; cuda: histories run on a GPU; of trace also mpi: all processes that mpirun starts; the same bits");
  command.add_option_function<std::string>(
      "--max-time", [&](std::string const& text) { options.max_seconds = parse_duration(text); },
      "stop after this time, for example 50min, with a result that can be continued");
  command.add_option_function<std::string>(
      "--checkpoint",
      [&](std::string const& text) { options.checkpoint_seconds = text == "off" ? infinity : parse_duration(text); },
      "write the run file while it is traced, so that a kill loses no more than this time; default 20min; or off");
  add_force_option(command, options);
}

void add_force_option(CLI::App& command, Options& options) {
  command.add_flag("--force", options.force, "overwrite the results of another model");
}

}  // namespace straytrace
