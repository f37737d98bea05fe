// SPDX-License-Identifier: BSD-3-Clause
// straytrace sensitivity: run file -> elasticities of h, shares of the input band, what to measure next.
#include "session/decide/sensitivity.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "results/curves/curve_file.hpp"
#include "results/text/picture.hpp"
#include "session/open_run.hpp"

namespace straytrace::cli {
namespace {

struct SensitivityOptions : TraceOptions {
  std::string at, csv, plot, step, traced, only;
};

double step_of(std::string const& text) {
  auto const number = leading_number(text);
  std::string const unit = number ? number->rest : "";
  double const step = number ? number->value * (unit == "%" || unit == " %" ? 0.01 : 1) : 0;
  if (!(step >= 1e-4 && step <= 0.5) || !(unit.empty() || unit == "%" || unit == " %"))
    throw InputError(fmt::format("--step: '{}' is not a step", text), "write 3%, from 0.01% to 50%");
  return step;
}

std::vector<std::string> names_in(std::string const& list) {
  std::vector<std::string> names;
  for (std::string const& name : CLI::detail::split(list, ','))
    if (std::string const plain = CLI::detail::trim_copy(name); !plain.empty()) names.push_back(plain);
  return names;
}

std::vector<InputClass> classes_in(std::string const& list) {
  std::vector<InputClass> classes;
  for (std::string const& name : names_in(list)) {
    auto const hit = std::ranges::find(input_class_names, name);
    std::vector<std::string> const known(input_class_names.begin(), input_class_names.end());
    if (hit == input_class_names.end())
      throw InputError(
          fmt::format("--only: there is no class '{}'", name),
          did_you_mean(name, known, "write strength, shape, motion, response or traced, or several with commas"));
    classes.push_back(InputClass(hit - input_class_names.begin()));
  }
  return classes;
}

// Options of traces without a trace, and traces that --only leaves out.
void refuse_unused(SensitivityOptions const& options, SensitivityOrder const& order) {
  std::vector<InputError> errors;
  if (order.traced.empty()) {
    std::vector<std::string> idle;
    if (!options.step.empty()) idle.emplace_back("--step");
    if (options.histories) idle.emplace_back("--histories");
    if (options.seed) idle.emplace_back("--seed");
    if (!idle.empty())
      errors.emplace_back(fmt::format("{}: nothing is traced", fmt::join(idle, ", ")),
                          "name what to trace: --trace rim");
    if (!order.only.empty() && std::ranges::all_of(order.only, [](InputClass c) { return c == InputClass::traced; }))
      errors.emplace_back("--only: nothing is traced", "name what to trace: --trace rim");
  } else if (!order.wants(InputClass::traced)) {
    errors.emplace_back("--only leaves out what --trace names", "add traced to --only, or remove --trace");
  }
  throw_all(errors);
}

void draw(Sensitivity const& s, std::string const& file) {
  std::string message;
  std::string const ending = std::filesystem::path(file).extension().string();
  std::string const picture = picture_of(sensitivity_json(s), "sensitivity", message, ending);
  if (picture.empty())
    std::cerr << fmt::format("warning: {} was not drawn: {}\n", file, message);
  else
    write_file(file, picture);
}

SensitivityOrder order_of(SensitivityOptions const& options, std::vector<InputError>& errors) {
  SensitivityOrder order{TableSettings{}.frequencies, {}, names_in(options.traced), {}, options};
  order.options.quiet = true;
  if (!options.step.empty()) order.step = step_of(options.step);
  order.only = classes_in(options.only);
  if (!options.at.empty()) order.frequencies = parse_frequencies(options.at, "--at");
  collect(errors, [&] { refuse_unused(options, order); });
  return order;
}

int sensitivity(SensitivityOptions const& options) {
  std::vector<InputError> errors;
  SensitivityOrder const order = order_of(options, errors);
  OpenRun const run = [&] {
    try {
      return OpenRun(options.input);
    } catch (InputError const& e) {
      errors.push_back(e);
      throw joined(errors);
    }
  }();
  add_errors_of_traced(run, order, errors);
  throw_all(errors);
  print_warnings(run.model, options);
  Sensitivity const s = session::sensitivity(run, order, [&](std::string const& name) {
    if (!options.quiet) std::cerr << fmt::format("sensitivity  {}\n", name);
  });
  for (std::string const& warning : s.warnings)
    if (!options.quiet && !options.json()) std::cerr << "warning: " << warning << '\n';
  std::cout << (options.json() ? sensitivity_json(s) : sensitivity_text(s));
  if (!options.csv.empty()) write_file(options.csv, sensitivity_csv(s));
  if (!options.plot.empty()) draw(s, options.plot);
  if (s.stopped)
    std::cerr << "stopped: the inputs that were not traced to the end are missing; the same command starts again\n";
  return s.stopped ? checkpointed : done;
}

}  // namespace

void add_sensitivity(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<SensitivityOptions>();
  SensitivityOptions& o = *options;
  auto* const command = app.add_subcommand(
      "sensitivity", "Rank the inputs of a run by their effect on h, and name what to measure next.");
  command->add_option("run", o.input, "run file (HDF5)")->required();
  command->add_option("--at", o.at, "frequencies to print, for example 10Hz,100Hz; default 10, 30 and 100 Hz")
      ->check(readable([](std::string const& text) { parse_frequencies(text, "--at"); }));
  command->add_option("--only", o.only, "classes of inputs: strength, shape, motion, response, traced")
      ->check(readable(classes_in));
  command->add_option("--trace", o.traced,
                      "parameters, or values of the scene by their place, to trace at both ends of a step, for example "
                      "rim,scene.baffle.shape.cone.half_angle");
  command
      ->add_option("--step", o.step,
                   "step of --trace, of the logarithm, for example 3%; default: chosen, four traces or more")
      ->check(readable(step_of));
  add_history_options(*command, o);
  command->add_option("--threads", o.threads, "number of threads; default: all cores; does not change the result");
  mark_output(*command, *command->add_option("--csv", o.csv, "file for the table of all frequencies"));
  auto* const plot = command->add_option("--plot", o.plot, "file for the picture: .png, .pdf or .svg");
  mark_output(*command, *plot);
  plot->check(readable([](std::string const& file) { check_ending(file, {".png", ".pdf", ".svg"}, "--plot"); }));
  command->add_flag("--quiet", o.quiet, "results only");
  add_format_option(*command, o);
  command->footer(
      "Examples:\n"
      "  straytrace sensitivity out/run.h5\n"
      "  straytrace sensitivity out/run.h5 --trace rim --plot tornado.png\n"
      "  straytrace sensitivity out/run.h5 --only traced --trace rim --step 1%");
  command->callback([options, &exit_code] { exit_code = sensitivity(*options); });
}

}  // namespace straytrace::cli
