// SPDX-License-Identifier: BSD-3-Clause
// straytrace scan: a model over lists and ranges of its parameters, and requirements from a line. straytrace optimise:
// the best of them.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <iostream>
#include <memory>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "results/text/picture.hpp"
#include "session/interrupt.hpp"
#include "session/open_run.hpp"
#include "session/optimise/optimise.hpp"
#include "session/scan/invert.hpp"
#include "session/scan/scan_points.hpp"
#include "session/session.hpp"

namespace straytrace::cli {
namespace {

struct ScanCommandOptions : ScanOptions {
  std::vector<std::string> axes;
  std::string csv, margin, points;
  unsigned jobs = 1;
  Requirement requirement;
  InvertOrder invert;
};

// "1/10" or a number.
double fraction(std::string const& text) {
  std::size_t const slash = text.find('/');
  auto const above = leading_number(text.substr(0, slash)),
             below = leading_number(slash == text.npos ? "1" : text.substr(slash + 1));
  bool const good = above && below && above->rest.empty() && below->rest.empty();
  if (good && above->value > 0 && below->value > 0 && std::isfinite(above->value / below->value))
    return above->value / below->value;
  throw InputError(fmt::format("'{}' is not a margin", text), "write for example --margin 1/10 or --margin 0.1");
}

void save(ScanTable const& table, ScanCommandOptions const& options, bool last) {
  if (!options.csv.empty()) write_file(options.csv, scan_csv(table));
  if (options.out.empty()) return;
  std::string const json = options.out + "/scan.json";
  write_files({{options.out + "/scan.csv", scan_csv(table)},
               {json, scan_json(table)},
               {options.out + "/scan.txt", scan_text(table)}});
  std::string message;
  if (last && !draw_from_json("scan", json, options.out + "/scan.png", message))
    std::cerr << "warning: scan.png was not drawn: " << message << '\n';
}

// Of the axes without an error, so that the parameters of these are checked in the scene too.
ScanList points_of(ScanCommandOptions const& order, std::vector<InputError>& errors) {
  ScanList list;
  if (!order.points.empty() && !order.axes.empty())
    errors.emplace_back("--points and parameter values both define the scan", "keep one of them");
  if (!order.points.empty()) {
    collect(errors, [&] { list = read_points(order.points); });
    return list;
  }
  if (order.axes.empty())
    errors.emplace_back("nothing to scan",
                        "name a parameter and its values: aperture=50cm..80cm:7, a file with --points, or use "
                        "--invert");
  list.axes = parse_axes(order.axes, false, errors);
  list.points = combinations(list.axes);
  return list;
}

int scan(ScanCommandOptions const& options, std::vector<InputError> errors) {
  collect(errors, [&] {
    if (!options.out.empty()) refuse_overwriting(options.out + "/scan.csv", options.points);
  });
  ScanList const list = points_of(options, errors);
  auto const& all = list.points;
  ScanTable table{std::filesystem::path(options.input).filename().string(), "", list.axes, {}, all.size()};
  if (options.jobs > 1 && options.out.empty())
    errors.emplace_back("--jobs needs a folder for the traces", "name one with -o");
  Scanner scanner(options, options.requirement, options.out);
  collect(errors, [&] { scanner.check(list); });
  throw_all(errors);
  std::optional<OutputFolder> folder;
  std::optional<FolderLock> lock;
  if (!options.out.empty()) {
    folder.emplace(options.out + "/runs");
    lock.emplace(options.out);
  }
  InterruptGuard const guard;
  if (options.jobs > 1) scanner.made(trace_together(all, options, options.requirement, options.jobs, guard.stop()));
  for (auto const& settings : all) {
    if (guard.stop()) break;
    if (!options.quiet)
      std::cerr << fmt::format("scan  {} of {}: {}\n", table.points.size() + 1, all.size(), fmt::join(settings, ", "));
    table.points.push_back(scanner.at(settings));
    table.line = scanner.line();
    save(table, options, guard.stop() || !table.points.back().complete || table.points.size() == all.size());
    if (!table.points.back().complete) break;
  }
  std::cout << (options.json() ? scan_json(table) : scan_text(table));
  bool const whole = table.points.size() == all.size() && table.points.back().complete;
  if (!whole) std::cerr << (options.out.empty() ? no_way_to_go_on : how_to_go_on);
  return whole ? done : checkpointed;
}

// What an inversion does not write or read.
void refuse_beside_invert(ScanCommandOptions const& options, std::vector<InputError>& errors) {
  std::vector<std::string> without;
  if (!options.csv.empty()) without.emplace_back("--csv");
  if (!options.points.empty()) without.emplace_back("--points");
  if (options.jobs > 1) without.emplace_back("--jobs");
  if (!without.empty())
    errors.emplace_back(fmt::format("--invert does not go with {}", fmt::join(without, ", ")),
                        "remove it; --format json prints all numbers");
  if (!options.out.empty() && names_run(options.input))
    errors.emplace_back("-o: --invert of a run file traces nothing, so there is nothing to keep",
                        "remove it; --format json prints all numbers");
}

// All that traces needs the scene.
void refuse_run(std::string const& file, std::string const& action) {
  if (names_run(file))
    throw InputError(fmt::format("'{}' is a run, but {} traces a scene", file, action),
                     "name the scene file in place of the run");
}

int start(ScanCommandOptions options) {
  std::vector<InputError> errors;
  collect(errors, [&] {
    if (!options.margin.empty()) options.requirement.margin = fraction(options.margin);
  });
  if (options.invert.what.empty()) {
    refuse_run(options.input, "a scan");
    return scan(options, std::move(errors));
  }
  refuse_beside_invert(options, errors);
  std::vector<ScanAxis> const axes = parse_axes(options.axes, true, errors);
  return invert(options, options.requirement, options.invert, axes, std::move(errors));
}

void add_invert_options(CLI::App& command, ScanCommandOptions& o) {
  command.add_option(
      "--invert", o.invert.what,
      "brdf(MATERIAL), motion(BODY) or param(NAME) with NAME=lo..hi: the largest value that keeps the total "
      "under the line");
  command.add_option("--margin", o.margin, "factor on the design curve, for example 1/10; default: that of the model");
  command.add_option("--against", o.requirement.against,
                     "design curve by name or file; default: the first of the model's 'compare'");
  command.add_flag("--per-frequency", o.invert.per_frequency,
                   "also derive the requirement at each frequency separately");
  command.add_option("--tolerance", o.invert.tolerance, "width of the result over the range, for param; default 0.01")
      ->check(number_between(1e-6, 0.5, "0.01"));
}

}  // namespace

void add_scan(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<ScanCommandOptions>();
  ScanCommandOptions& o = *options;
  auto* const command =
      app.add_subcommand("scan", "Run a model over its parameters, or derive a requirement from a design curve.");
  add_scene_options(*command, o, "scene file (YAML); with --invert also a run file (HDF5)");
  command->add_option("axes", o.axes, "NAME=lo..hi:n, NAME=lo..hi:n:log or NAME=a,b,c; all combinations");
  add_trace_options(*command, o);
  command->add_option("-o,--out", o.out,
                      "folder for scan.csv, scan.json, scan.txt, scan.png and the runs; finished points are not traced "
                      "again");
  mark_output(*command, *command->add_option("--csv", o.csv, "file for the table, all digits"));
  command
      ->add_option("--points", o.points,
                   "CSV of points instead of values: a header such as 'rim [cm], baffles', a row for each point")
      ->group("Model");
  command
      ->add_option("--jobs", o.jobs,
                   "number of points traced at the same time, with -o; the results have the same bits")
      ->check(whole_between(1, 1024, "4"));
  add_invert_options(*command, o);
  command->footer(
      "Examples:\n"
      "  straytrace scan examples/et_hf_arm.yaml rim=40cm,42cm --histories 200000\n"
      "  straytrace scan examples/et_hf_arm.yaml --invert \"brdf(baffle)\" --margin 1/10 --histories 200000\n"
      "If --invert brdf(MATERIAL) finds an upper bound, the quoted error may be too large by up to a factor 2.\n"
      "After Ctrl-C it keeps the finished points and exits with 85; with -o the same command resumes.");
  command->callback([options, &exit_code] {
    drop_slashes(options->out);
    exit_code = start(*options);
  });
}

// straytrace optimise: least cost or least noise over parameters of a scene, under limits.

void add_optimise(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<OptimiseOptions>();
  OptimiseOptions& o = *options;
  auto* const command = app.add_subcommand(
      "optimise", "Find the least cost or the least noise over parameters of a scene, under limits.");
  add_scene_options(*command, o);
  add_trace_options(*command, o);
  command
      ->add_option("-o,--out", o.out,
                   "folder for best.yaml, best/run.h5, optimise.html, optimise.txt, optimise.json, optimise.png, "
                   "candidates.csv and the runs")
      ->required();
  command
      ->add_option("--minimise", o.words.minimise,
                   "expression of parameters with count(ENTRY), area(ENTRY) in m^2 and price(PARAMETER), or h_total; "
                   "default: of the table 'optimise'")
      ->group("Model");
  command
      ->add_option("--vary", o.words.vary,
                   "NAME=lo..hi, NAME=lo..hi:integer or NAME=a,b,c, of a parameter or a place such as "
                   "scene.tube.material, instead of the table; may be repeated")
      ->allow_extra_args(false)
      ->group("Model");
  command
      ->add_option("--subject", o.words.subject,
                   "limit, instead of the table: \"h_total < 0.1 x et-d-points with 95 %\", \"power(baffles) < 1 W\", "
                   "\"rim > 34 cm\"; may be repeated")
      ->allow_extra_args(false)
      ->group("Model");
  command
      ->add_flag("--pareto", o.pareto, "also search with limits 0.35 to 2.8 times as high: the front of cost and noise")
      ->group("Analysis");
  command->add_option("--tolerance", o.tolerance, "width of the region, over the ranges, at which a search ends")
      ->check(number_between(1e-6, 0.5, "0.01"));
  command->add_option("--most", o.most, "candidates of one search at most; default 60")
      ->check(whole_between(1, 10000, "60"))
      ->group("Analysis");
  command
      ->add_option("--most-histories", o.most_histories,
                   "histories of a candidate at most, from --histories on by factors of 4, where the error would hide "
                   "the next step; default: --histories")
      ->check(whole_between(1, 1000000000, "1000000"))
      ->group("Analysis");
  command->footer(
      "Examples:\n"
      "  straytrace optimise examples/et_hf_arm.yaml --minimise \"count(baffles*)\" --vary rim=34cm..36cm --subject "
      "\"h_total < 0.5 x line with 95 %\" --histories 65536 -o best/\n"
      "  straytrace optimise examples/et_hf_arm.yaml --minimise h_total --vary baffle_angle=30deg..50deg --histories "
      "65536 -o quiet/\n"
      "Exit code 4: no candidate meets the limits; the closest is printed.\n"
      "After Ctrl-C it keeps the finished traces and exits with 85; the same command resumes.");
  command->callback([options, &exit_code] {
    drop_slashes(options->out);
    refuse_run(options->input, "optimise");
    exit_code = optimise(*options);
  });
}

}  // namespace straytrace::cli
