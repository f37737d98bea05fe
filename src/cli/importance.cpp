// SPDX-License-Identifier: BSD-3-Clause
// straytrace importance: surfaces that light must not reach.
#include "trace/importance/importance.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>

#include "base/errors.hpp"
#include "base/text/json_text.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "results/text/columns.hpp"
#include "session/light/lit_table.hpp"
#include "session/light/optical_network.hpp"
#include "session/open_run.hpp"

namespace straytrace::cli {
namespace {

struct ImportanceRow {
  std::string group;
  double from = 0, to = 0;  // m, along z
  double area = 0;          // m^2
  double front = 0, back = 0;
  double most() const { return std::max(front, back); }
};

std::vector<ImportanceRow> rows_of(ImportanceMap const& map, std::vector<std::string> const& groups) {
  std::vector<ImportanceRow> rows;
  for (ImportanceMap::Strip const& s : map.strips)
    rows.push_back(
        {groups.at(s.group), s.low, s.high, s.area, map.adjoint.at(2 * s.patch), map.adjoint.at(2 * s.patch + 1)});
  return rows;
}

// Stored in a run file, or computed from a scene.
struct ImportanceOptions : SceneOptions {
  std::size_t show = 20;
  bool csv = false;
};

std::vector<ImportanceRow> find_rows(ImportanceOptions const& options) {
  std::optional<RunFile> file;
  if (names_run(options.input)) {
    file = read_run(options.input);
    bool const kept = !file->about.importance.strips.empty();
    if (kept && options.overrides.empty()) return rows_of(file->about.importance, file->trace.coupling.groups);
    if (!kept && !options.quiet) std::cerr << "the run stores no importance map: computed from its scene\n";
  }
  Scene const scene = file ? scene_of(*file, options.overrides) : read_scene(options.input, options.overrides);
  World world = build_lit_world(scene);
  scene.throw_if_problems();
  if (!file) print_warnings(scene, options);
  world.limits.targets = true;
  steer(world);
  return rows_of(importance_map(world), world.groups());
}

void print(std::vector<ImportanceRow> rows, std::size_t show) {
  std::stable_sort(rows.begin(), rows.end(),
                   [](ImportanceRow const& a, ImportanceRow const& b) { return a.most() > b.most(); });
  Columns table{{"surface", "z from/m", "z to/m", "area/m^2", "front", "back"}, {true}, {}};
  std::size_t left = 0;
  for (ImportanceRow const& r : rows) {
    if (!(r.most() > 0)) continue;
    if (table.rows.size() >= show) {
      ++left;
      continue;
    }
    auto const adjoint = [](double a) { return a > 0 ? fmt::format("{:.3g}", a) : std::string("-"); };
    table.rows.push_back({r.group, fmt::format("{:.6g}", r.from), fmt::format("{:.6g}", r.to),
                          fmt::format("{:.4g}", r.area), adjoint(r.front), adjoint(r.back)});
  }
  if (table.rows.empty()) {
    std::cout << "No targets: no light of a second scatter is received.\n";
    return;
  }
  std::cout
      << "Adjoint of each side: contribution of one unit of power arriving there to the received light, in units of\n"
         "the total, summed over ports and receivers; a quadrature for steering, good to tens of per cent\n"
         "for straight paths. Light through mirrors and glass is included only by a short pilot run.\n"
      << aligned(table) << (left ? fmt::format("and {} more; --csv has all\n", left) : "");
}

int importance(ImportanceOptions const& options) {
  refuse_two_formats(options.csv, options);
  std::vector<ImportanceRow> const rows = find_rows(options);
  if (options.csv) {
    std::cout << "surface,z_from_m,z_to_m,area_m2,adjoint_front,adjoint_back\n";
    for (ImportanceRow const& r : rows)
      std::cout << fmt::format("\"{}\",{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", r.group, r.from, r.to, r.area,
                               r.front, r.back);
  } else if (options.json()) {
    nlohmann::json out = nlohmann::json::array();
    for (ImportanceRow const& r : rows)
      out.push_back({{"surface", r.group},
                     {"z_from_m", r.from},
                     {"z_to_m", r.to},
                     {"area_m2", r.area},
                     {"adjoint_front", r.front},
                     {"adjoint_back", r.back}});
    std::cout << json_text(out) << '\n';
  } else {
    print(rows, options.show);
  }
  return done;
}

}  // namespace

void add_importance(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<ImportanceOptions>();
  ImportanceOptions& o = *options;
  auto* const command = app.add_subcommand(
      "importance", "Show which surfaces light must not reach: the adjoint of each part of each surface.");
  add_scene_options(*command, o, "scene (YAML), or run file (HDF5) to show its stored map");
  command->add_option("--show", o.show, "number of rows; default 20")->check(whole_between(1, 1e6, "50"));
  command->add_flag("--csv", o.csv, "all rows, all digits, in the order of the scene");
  command->footer(
      "Examples:\n"
      "  straytrace importance examples/virgo_arm.yaml\n"
      "  straytrace importance examples/virgo_arm.yaml --csv > importance.csv\n"
      "  straytrace importance out/run.h5");
  command->callback([options, &exit_code] { exit_code = importance(*options); });
}

}  // namespace straytrace::cli
