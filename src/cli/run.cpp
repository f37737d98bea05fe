// SPDX-License-Identifier: BSD-3-Clause
// straytrace run: the whole program in one function. Start reading here.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "results/curves/band.hpp"
#include "results/receivers/receivers.hpp"
#include "results/route_table/route_sums.hpp"
#include "session/interrupt.hpp"
#include "session/light/cavity_waves.hpp"
#include "session/live/live_run.hpp"
#include "session/open_run.hpp"
#include "session/report_page.hpp"
#include "session/session.hpp"

namespace straytrace::cli {
namespace {

struct Written {
  std::string undrawn, page;  // failures of pictures; the report as HTML
};

// All files of a result.
Written write_with_page(std::string const& folder, RunContent const& content, PathTable const& paths,
                        Model const& model, SteeredWorld const& world) {
  Written written;
  written.undrawn = write_results(folder, content, paths, model);
  Picture const picture{"png", written.undrawn.empty() ? read_file(folder + "/report.png") : ""};
  ReportWanted wanted;
  wanted.pictures = read_pictures(model.scene.table("report"));
  written.page = report_page(
      content, paths, model, [&]() -> SteeredWorld const& { return world; }, wanted, picture);
  write_file(folder + "/report.html", written.page);
  return written;
}

std::string paragraph(std::string const& text) { return text.empty() ? "" : text + "\n\n"; }

struct RunOptions : TraceOptions {
  std::string out;
  bool no_seam = false;
  LiveOptions live;

  bool alone() const { return out.ends_with(".h5"); }  // only the run file
  std::string run_file() const { return alone() ? out : out + "/run.h5"; }
};

void print_run(RunOptions const& options, RunContent const& content, PathTable const& paths, Model const& model,
               bool drawn) {
  if (options.json()) {
    std::cout << summary_json(content, paths) << '\n';
    return;
  }
  if (NoiseBudget const* const budget = content.noise)
    std::cout << path_text(paths, model.paths_shown) << '\n'
              << band_summary(*budget, paths.frequencies) << '\n'
              << verdict_sentence(*budget, budget->grid.edges.front(), budget->grid.edges.back()) << "\n\n"
              << paragraph(seam_sentence(content)) << headline(*budget, paths) << '\n';
  if (!content.receivers.empty())
    std::cout << (content.noise ? "\n" : "") << receiver_text(receiver_table(content), model.paths_shown);
  if (!options.quiet)
    std::cerr << merit_text(merits(content), merits_shown)
              << (options.alone() ? fmt::format("run file: {}\n", options.out)
                                  : results_line(options.out, content, "report.html", drawn));
}

// A stop request while it still reads, or already writes, gives a run file as well.
int trace_and_write(RunInput const& earlier, Model& model, RunOptions const& options, InterruptGuard const& guard,
                    LiveRun* live) {
  auto const [world, traced] = trace_model(model, options, options.run_file(),
                                           live ? live->control() : TraceControl{});  // world -> coupling table
  if (live && live->extended()) {                                                     // traced on from this file
    write_run(options.run_file(), earlier.completed(content_of(model, traced, nullptr)));
    return checkpointed;
  }
  if (live) live->show_writing();
  if (!model.seam && !options.no_seam && !traced.checkpointed() && has_seam(model))
    model.seam = check_seam(earlier.read(options.overrides), traced, options);
  std::optional<NoiseBudget> budget;  // the rest is fast
  if (model.detector) budget = model.project_with_bands(traced.coupling);
  if (budget) print_warnings(*budget, options);
  PathTable const paths = table_for(traced.coupling, budget ? &*budget : nullptr, model);
  RunContent const content = earlier.completed(content_of(model, traced, budget ? &*budget : nullptr));
  Written written;
  if (options.alone())
    write_run(options.out, content);
  else
    written = write_with_page(options.out, content, paths, model, world);
  print_run(options, content, paths, model, written.undrawn.empty());
  bool const stopped = traced.checkpointed() || (guard.stop() && has_seam(model) && !content.seam && !options.no_seam);
  if (stopped) std::cerr << how_to_go_on;
  if (!written.undrawn.empty()) std::cerr << "warning: report.png was not drawn: " << written.undrawn << '\n';
  if (live) live->show_report(std::move(written.page), traced, stopped);
  return stopped ? checkpointed : done;
}

// What the page of the run extends, as the same command with other --histories or --until does, until it is closed.
int follow(LiveRun& live, RunInput const& earlier, Model& model, RunOptions options, InterruptGuard const& guard) {
  int code = trace_and_write(earlier, model, options, guard, &live);
  options.force = false;
  while (std::optional<LiveTarget> const next = live.wait(guard)) {
    InterruptGuard::revoke_request();
    options.histories = next->histories;
    options.until = next->until;
    apply(options, model);
    code = trace_and_write(earlier, model, options, guard, &live);
  }
  return code;
}

int run(RunOptions const& options) {
  InterruptGuard const guard;
  if (options.live.live && options.alone())
    throw InputError("--live shows a report, which a run file alone does not have", "name a folder: -o out/");
  RunInput const earlier(options.input);  // a run file is repeated from its own content
  if (!earlier.slice().whole())
    throw InputError(
        fmt::format("'{}' is slice {}/{} of a run", options.input, earlier.slice().number, earlier.slice().of),
        fmt::format("merge all slices with straytrace merge; straytrace noise {0} and straytrace report {0} "
                    "show only this one",
                    options.input));
  Model model = earlier.read(options.overrides);  // input file -> world, motion, detector
  apply(options, model);
  print_warnings(model, options);

  std::optional<OutputFolder> folder;
  if (!options.alone()) folder.emplace(options.out);
  std::optional<FolderLock> const lock =
      options.alone() ? std::nullopt : std::optional<FolderLock>(std::in_place, options.out);
  if (options.live.live) {
    LiveRun live(model, options.live.port);
    LiveAddress const shown(live.address(), options.live.open);
    return follow(live, earlier, model, options, guard);
  }
  return trace_and_write(earlier, model, options, guard, nullptr);
}

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<RunOptions>();
  RunOptions& o = *options;
  auto* const command = app.add_subcommand("run", "Check, trace, project the noise and write the report in one go.");
  add_scene_options(*command, o, "scene file (YAML), or run file (HDF5) to repeat");
  add_trace_options(*command, o);
  command->add_option("-o,--out", o.out, "folder for the results; a name that ends with .h5: the run file alone")
      ->required();
  command->add_flag("--no-seam", o.no_seam,
                    "leave out the comparison with another crossover angle (scenes with the table 'wave')");
  add_live_options(*command, o.live,
                   "follow the run in a browser: serves a page on this machine that can stop and extend it");
  command->footer(
      "Examples:\n"
      "  straytrace run examples/virgo_arm.yaml -o out/\n"
      "  straytrace run examples/virgo_arm.yaml -o out/ --live\n"
      "  straytrace run examples/virgo_arm.yaml -o fine/ --until \"h_total < 1 %\" -p rim=48cm\n"
      "  straytrace run out/run.h5 -o again/\n"
      "Given a run file, run repeats it from its own content, with the same numbers.\n"
      "After Ctrl-C it leaves a valid result and exits with 85; the same command resumes from there.");
  command->callback([options, &exit_code] {
    drop_slashes(options->out);
    exit_code = run(*options);
  });
}

}  // namespace straytrace::cli
