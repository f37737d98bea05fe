// SPDX-License-Identifier: BSD-3-Clause
// straytrace budget: fundamental noises of a detector, with stray light of runs and other curves.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "base/text/json_text.hpp"
#include "base/units/quantity.hpp"
#include "cli/commands.hpp"
#include "cli/data_options.hpp"
#include "cli/options.hpp"
#include "results/budget/budget_view.hpp"
#include "results/results.hpp"
#include "results/text/picture.hpp"
#include "session/build_info.hpp"
#include "session/compare/model_diff.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"

namespace straytrace::cli {
namespace {

struct BudgetOptions : PrintOptions {
  std::string out;
  BudgetRequest request;
  std::string at = "10 Hz, 100 Hz, 1 kHz", band, margin, export_as;
};

double parse_margin(std::string const& text) {
  if (text.empty()) return 0.1;
  std::size_t const slash = text.find('/');
  auto const top = leading_number(text.substr(0, slash)),
             bottom = leading_number(slash == text.npos ? "1" : text.substr(slash + 1));
  bool const good = top && bottom && top->rest.empty() && bottom->rest.empty();
  if (double const ratio = good ? top->value / bottom->value : 0; ratio > 0 && ratio < 1e6) return ratio;
  throw InputError(fmt::format("--margin: '{}' is not a positive ratio", text), "write --margin 1/10");
}

// Runs whose strain was computed with another interferometer than the detector of the budget.
void warn_of_other_detectors(BudgetView& view) {
  if (!view.ifo) return;
  for (RunAbout const& about : view.runs) {
    OpenRun const run(about.path);
    if (!run.model.detector) continue;
    if (auto const other = other_detector(*view.ifo, view.detector, about.file, *run.model.detector))
      view.warnings.push_back(other->what + "\n  " + other->suggestion);
  }
}

BudgetView view_of(BudgetOptions const& options) {
  BudgetRequest request = options.request;
  request.margin = parse_margin(options.margin);
  request.at = parse_frequencies(options.at, "--at");
  if (!options.band.empty()) {
    FrequencyBand const band = option_band(options.band, "--band", curve_band);
    request.band = {band.low, band.high};
  }
  BudgetView view = gather_budget(request);
  view.version = build_info::version;
  view.commit = build_info::commit;
  warn_of_other_detectors(view);
  return view;
}

// On stderr: as text, or as the list of problems for scripts.
void warn(std::vector<std::string> const& warnings, PrintOptions const& options) {
  if (options.json() && !warnings.empty()) {
    std::vector<Problem> all;
    for (std::string const& warning : warnings) all.push_back({{}, warning, "", Severity::warning});
    std::cerr << problems_as_json(InputError(all, ""));
    return;
  }
  for (std::string const& warning : warnings) std::cerr << "warning: " << warning << '\n';
}

// Failures of pictures.
std::string write_budget(BudgetView const& view, OutputFolder const& folder, bool pygwinc) {
  std::string const json = folder.path("budget.json");
  std::vector<std::pair<std::string, std::string>> files = {{folder.path("budget.txt"), budget_columns(view)},
                                                            {json, json_text(budget_json(view), 1)}};
  if (pygwinc) files.emplace_back(folder.path("budget.hdf5"), budget_pygwinc(view));
  write_files(files);
  std::string message;
  return draw_from_json("budget", json, folder.path("budget.png"), message) ? "" : message;
}

int budget(BudgetOptions const& options) {
  bool const pygwinc = !options.export_as.empty();
  if (pygwinc && options.out.empty()) throw InputError("--export needs a folder for its file", "add -o DIR");
  std::optional<OutputFolder> folder;
  if (!options.out.empty())
    folder.emplace(options.out, std::vector<std::string>{"budget.txt", "budget.json", "budget.png", "budget.hdf5"});
  BudgetView const view = view_of(options);
  std::string const undrawn = folder ? write_budget(view, *folder, pygwinc) : "";
  if (options.json())
    std::cout << json_text(budget_json(view), 1) << '\n';
  else
    std::cout << budget_text(view);
  std::vector<std::string> warnings = options.quiet ? std::vector<std::string>() : view.warnings;
  if (!undrawn.empty()) warnings.push_back(undrawn);
  warn(warnings, options);
  return done;
}

}  // namespace

void add_budget(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<BudgetOptions>();
  BudgetOptions& o = *options;
  auto* const command = app.add_subcommand(
      "budget", "Print the noise budget of a detector: fundamental noises, stray light and design curves.");
  BudgetRequest& r = o.request;
  command
      ->add_option("input", r.inputs,
                   "detector (preset or pygwinc ifo.yaml), run files, pygwinc budgets (HDF5), in any order")
      ->required();
  command->add_option("--at", o.at, "frequencies of the table")->default_str(o.at);
  command->add_option("--band", o.band, "of curves and picture (default: of the run, or \"5 Hz..5 kHz\")");
  command->add_option("--points", r.points, "of the curves (default: the bins of the run, or 300)")
      ->check(whole_between(2, 100000, "300"));
  command
      ->add_option("--compare", r.compare,
                   "design curves or files (two columns, runs, pygwinc budgets): several with commas, or one for "
                   "each --compare")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--margin", o.margin,
                      "ratio to the first design curve that counts as small enough (default 1/10)");
  add_overrides(*command, r.overrides, "change a parameter of the detector, in SI: -p Laser.Power=25");
  command->add_option("--export", o.export_as, "pygwinc: also write budget.hdf5, which pygwinc reads")
      ->check(CLI::IsMember({"pygwinc"}));
  command->add_option("-o,--out", o.out, "folder for budget.txt, budget.json, budget.png");
  command->add_flag("--quiet", o.quiet, "results only");
  add_format_option(*command, o);
  command->footer(
      "Examples:\n"
      "  straytrace budget aligo --at \"10 Hz, 100 Hz\"\n"
      "  straytrace budget adv demo/run.h5 --export pygwinc -o budget/");
  command->callback([options, &exit_code] { exit_code = budget(*options); });
}

}  // namespace straytrace::cli
