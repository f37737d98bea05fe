// SPDX-License-Identifier: BSD-3-Clause
// straytrace trace: scene -> coupling table, without any motion.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cmath>
#include <iostream>

#include "app/common_options.hpp"
#include "app/earlier.hpp"
#include "app/session.hpp"
#include "app/tell.hpp"
#include "page/page_json.hpp"
#include "page/ray_paths.hpp"
#include "report/columns.hpp"
#include "report/merit.hpp"
#include "report/receivers.hpp"
#include "trace/estimate/importance.hpp"

namespace straytrace {
namespace {

int trace_only(Options const& options) {
  Model model = read_model(options.input, options.overrides);
  apply(options, model);
  tell_warnings(model, options);
  TraceResult const traced = trace_model(model, options, options.out);
  RunContent const content = content_of(model, traced, nullptr);
  write_run(options.out, content);
  PathTable const paths = table_for(traced.coupling, nullptr, model);
  bool const received = !content.receivers.empty();
  if (options.json()) {
    std::cout << path_json(paths, content) << '\n';
  } else {
    if (model.detector) std::cout << path_text(paths, model.paths_shown) << '\n';
    if (received) std::cout << receiver_text(receiver_table(content), model.paths_shown) << '\n';
    std::cout << "Where the light went\n\n" << books_text(content) << '\n' << objects_text(content);
  }
  if (!options.quiet) std::cerr << merit_text(merits(content), merits_shown);
  if (!options.quiet && model.detector)
    std::cerr << fmt::format("coupling table in {}; project motion with: straytrace noise {}\n", options.out,
                             options.out);
  else if (!options.quiet)
    std::cerr << fmt::format("light on receivers in {}; more with: straytrace paths {} --census\n", options.out,
                             options.out);
  if (traced.checkpointed() && !options.quiet) std::cerr << how_to_go_on;
  return traced.checkpointed() ? checkpointed : done;
}

// One history, event by event: of a scene as it would be traced, or of a run as it was.
int tell_history(Options const& options, std::uint64_t number) {
  Earlier const earlier(options.input);
  Model model = earlier.read(options.overrides);
  if (options.seed) model.seed = *options.seed;
  steer(model.world);
  std::vector<ToldEvent> const events = told_history(model.world, model.seed, number);
  if (options.json()) {
    std::cout << told_json(events).dump() << '\n';
    return done;
  }
  Columns table{{"event", "order", "what", "where", "body", "x [m]", "y [m]", "z [m]", "power"},
                {false, false, true, true, true},
                {}};
  for (ToldEvent const& e : events) {
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

void add_trace(CLI::App& app, Options& options, int& exit_code) {
  auto* const command = app.add_subcommand("trace", "trace light into a coupling table; no motion, no noise yet");
  add_scene_options(*command, options);
  add_trace_options(*command, options);
  auto* const out = command->add_option("-o,--out", options.out, "run file to write (HDF5)");
  static std::optional<std::uint64_t> history;
  command->add_option("--history", history, "follow this history alone and print its events; also of a run file")
      ->check(whole_between(0, 9e15, "1234"));
  command->footer(
      "Examples:\n"
      "  straytrace trace examples/virgo_arm.yaml -o virgo.h5 --histories 1e6\n"
      "  straytrace trace examples/virgo_arm.yaml -o virgo.h5 --until \"h_total < 2 %\" --seed 7\n"
      "  straytrace trace virgo.h5 --history 1234");
  command->callback([&, out] {
    if (!history && out->count() == 0) throw CLI::RequiredError("--out");
    exit_code = history ? tell_history(options, *history) : trace_only(options);
  });
}

}  // namespace straytrace
