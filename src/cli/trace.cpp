// SPDX-License-Identifier: BSD-3-Clause
// straytrace trace: scene -> coupling table, without any motion.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <memory>
#include <optional>

#include "base/text/json_text.hpp"
#include "base/text/pattern.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "report/html/page_json.hpp"
#include "report/scene_drawing.hpp"
#include "results/text/columns.hpp"
#include "session/backend.hpp"
#include "session/interrupt.hpp"
#include "session/light/cavity_waves.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"
#include "trace/importance/importance.hpp"
#include "trace/run/ranks.hpp"

namespace straytrace::cli {
namespace {

struct TraceCommandOptions : TraceOptions {
  std::string out;
  std::optional<std::uint64_t> history;  // --history: trace only this one
};

// A stop rule checks all histories so far, but a slice has only its own.
void refuse_stop_rule(TraceOptions const& options, Model const& model) {
  if (options.slices == 1 || !model.until.by_error()) return;
  throw InputError(fmt::format("--slice {}/{}: the stop rule '{}' needs the histories of all slices together",
                               options.slice, options.slices, model.until.error_rule),
                   "give the total number of histories, for example --histories 1e8");
}

// A run file is resumed in place, unless another file is named. A stop request while it still reads, or already writes,
// gives a run file as well.
int trace_only(TraceCommandOptions options, Transport* transport) {
  InterruptGuard const guard;
  RunInput const earlier(options.input);
  Model model = earlier.read_to_the_end(options.overrides);
  if (options.slices == 1) {
    options.slice = earlier.slice().number;
    options.slices = earlier.slice().of;
  }
  apply(options, model);
  refuse_stop_rule(options, model);
  if (transport && transport->rank() > 0) {
    work_for_rank_0(model, options.threads, *transport);
    return done;
  }
  print_warnings(model, options);
  TraceResult const traced = trace_model(model, options, options.out, {.transport = transport}).result;
  RunContent const content = earlier.completed(content_of(model, traced, nullptr));
  write_run(options.out, content);
  print_traced(content, model, options.out, options);
  if (traced.checkpointed()) std::cerr << how_to_go_on;
  return traced.checkpointed() ? checkpointed : done;
}

// All processes of the job run this; rank 0 prints and writes.
int trace_by_mpi(TraceCommandOptions const& options) {
  Transport& transport = open_mpi();
  bool const leads = transport.rank() == 0;
  try {
    return trace_only(options, &transport);
  } catch (std::exception const& e) {
    if (leads) {
      stop_workers(transport);
      throw;
    }
    report_failure(transport, e.what());
  }
  return done;
}

// One history, event by event, of a scene or of a run.
int print_history(TraceOptions const& options, std::uint64_t number) {
  RunInput const earlier(options.input);
  Model model = earlier.read(options.overrides);
  if (options.seed) model.seed = *options.seed;
  light_halo(model, false, options.threads, options);
  std::vector<HistoryEvent> const events =
      replay_history_events(steer(model.world, options.threads), model.seed, number);
  if (options.json()) {
    std::cout << json_text(told_json(events)) << '\n';
    return done;
  }
  Columns table{{"event", "order", "what", "where", "body", "x [m]", "y [m]", "z [m]", "power"},
                {false, false, true, true, true},
                {}};
  for (HistoryEvent const& e : events) {
    bool const placed = std::isfinite(e.point.x);
    auto const metres = [&](double x) { return placed ? fmt::format("{:.7g}", x) : ""; };
    table.rows.push_back({placed ? fmt::format("{}", e.event) : "", placed ? fmt::format("{}", e.order) : "", e.what,
                          e.where, e.body, metres(e.point.x), metres(e.point.y), metres(e.point.z),
                          fmt::format("{:.6g}", e.power)});
  }
  std::cout << fmt::format("history {} of seed {}; power relative to the main mode\n", number, model.seed)
            << aligned(table);
  return done;
}

}  // namespace

namespace {

// "7/200"
void read_slice(std::string const& text, TraceOptions& options) {
  static Pattern const form(R"(\s*([0-9]{1,7})\s*/\s*([0-9]{1,7})\s*)");
  if (PatternMatch const m = form.match(text)) {
    options.slice = std::stoull(m[1]);
    options.slices = std::stoull(m[2]);
    if (options.slice >= 1 && options.slice <= options.slices) return;
  }
  throw InputError(fmt::format("--slice '{}' is not a part of a run", text),
                   "write for example --slice 7/200, the seventh of 200 (at most 9999999)");
}

}  // namespace

void add_trace(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<TraceCommandOptions>();
  TraceCommandOptions& o = *options;
  auto* const command = app.add_subcommand("trace", "Trace light into a coupling table, without motion or noise.");
  add_scene_options(*command, o);
  add_trace_options(*command, o);
  auto* const out = command->add_option("-o,--out", o.out, "run file to write (HDF5); default: the one to resume");
  command
      ->add_option_function<std::string>(
          "--slice", [options](std::string const& text) { read_slice(text, *options); },
          "trace only this part of the histories, for example 7/200; straytrace merge combines all parts")
      ->type_name("N/OF");
  command->add_option("--history", o.history, "trace only this history and print its events; also of a run file")
      ->check(whole_between(0, 9e15, "1234"));
  command->footer(
      "Examples:\n"
      "  straytrace trace examples/virgo_arm.yaml -o virgo.h5 --histories 1e6\n"
      "  straytrace trace examples/virgo_arm.yaml -o virgo.h5 --until \"h_total < 2 %\" --seed 7\n"
      "  straytrace trace examples/virgo_arm.yaml -o part007.h5 --histories 1e9 --slice 7/200\n"
      "  straytrace trace part007.h5\n"
      "  mpirun straytrace trace examples/virgo_arm.yaml -o virgo.h5 --histories 1e9 --backend mpi\n"
      "  straytrace trace virgo.h5 --history 1234\n"
      "Given a run file, trace resumes up to the requested number of histories.");
  command->callback([options, &exit_code, out] {
    TraceCommandOptions& wanted = *options;
    if (wanted.history) {
      exit_code = print_history(wanted, *wanted.history);
      return;
    }
    bool const resumes = names_run(wanted.input);
    if (out->count() == 0 && !resumes) throw CLI::RequiredError("--out");
    if (out->count() == 0) wanted.out = wanted.input;
    if (!resumes) refuse_overwriting(wanted.out, wanted.input);
    exit_code = wanted.backend == "mpi" ? trace_by_mpi(wanted) : trace_only(wanted, nullptr);
  });
}

}  // namespace straytrace::cli
