// SPDX-License-Identifier: BSD-3-Clause
// straytrace importance: where light must not go.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iostream>

#include "app/common_options.hpp"
#include "base/message.hpp"
#include "report/columns.hpp"
#include "trace/estimate/importance.hpp"
#include "trace/history/path.hpp"

namespace straytrace {
namespace {

struct Row {
  std::string group;
  double from = 0, to = 0;  // m, along z
  double area = 0;          // m^2
  double front = 0, back = 0;
  double most() const { return std::max(front, back); }
};

std::vector<Row> rows_of(World const& world, SteeringTables const& tables) {
  WorldView const view = world.view();
  std::vector<Row> rows;
  for (std::size_t i = 0; i < tables.strips.size(); ++i) {
    Strip const& s = tables.strips[i];
    Surface const& surface = world.surfaces()[s.surface.value];
    Row row{world.groups()[surface.group.value], infinity, -infinity, s.area, tables.sides[2 * i].adjoint,
            tables.sides[2 * i + 1].adjoint};
    view.shapes.visit(surface.shape, [&](auto const& shape) {
      using Shape = std::decay_t<decltype(shape)>;
      if constexpr (has_strips<Shape>) {
        for (double const u : {s.u_low, s.u_high})
          for (double const v : {0.0, 0.25, 0.5, 0.75}) {
            double const z = shape.sample(u, v).z;
            row.from = std::min(row.from, z);
            row.to = std::max(row.to, z);
          }
      } else {
        Box const box = shape.bounds();
        row.from = box.lower.z;
        row.to = box.upper.z;
      }
    });
    rows.push_back(row);
  }
  return rows;
}

void print(std::vector<Row> rows, std::size_t show) {
  std::stable_sort(rows.begin(), rows.end(), [](Row const& a, Row const& b) { return a.most() > b.most(); });
  Columns table{{"surface", "z from/m", "z to/m", "area/m^2", "front", "back"}, {true}, {}};
  std::size_t left = 0;
  for (Row const& r : rows) {
    if (!(r.most() > 0)) continue;
    if (table.rows.size() >= show) {
      ++left;
      continue;
    }
    auto const adjoint = [](double a) { return a > 0 ? fmt::format("{:.3g}", a) : std::string("-"); };
    table.rows.push_back({r.group, fmt::format("{:.6g}", r.from), fmt::format("{:.6g}", r.to),
                          fmt::format("{:.4g}", r.area), adjoint(r.front), adjoint(r.back)});
  }
  std::cout
      << "Adjoint of each side: what one unit of power arriving there still adds to what is received, in units of\n"
         "the whole of it, summed over ports and receivers; a quadrature for steering, good to tens of per cent.\n"
      << aligned(table) << (left ? fmt::format("and {} more; --csv has all\n", left) : "");
}

int importance(Options const& options) {
  Scene const scene = read_scene(options.input, options.overrides);
  World world = build_world(scene);
  scene.throw_if_problems();
  if (!options.quiet) std::cerr << scene.warnings();
  world.limits.targets = true;
  steer(world);
  SteeringTables const& tables = world.steering();
  if (tables.strips.empty())
    throw InputError(
        "error: the scene has too many surfaces for adjoint tables\n  take parts away with a smaller scene");
  std::vector<Row> const rows = rows_of(world, tables);
  if (options.csv) {
    std::cout << "surface,z_from_m,z_to_m,area_m2,adjoint_front,adjoint_back\n";
    for (Row const& r : rows)
      std::cout << fmt::format("\"{}\",{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", r.group, r.from, r.to, r.area,
                               r.front, r.back);
  } else if (options.json()) {
    nlohmann::json out = nlohmann::json::array();
    for (Row const& r : rows)
      out.push_back({{"surface", r.group},
                     {"z_from_m", r.from},
                     {"z_to_m", r.to},
                     {"area_m2", r.area},
                     {"adjoint_front", r.front},
                     {"adjoint_back", r.back}});
    std::cout << out.dump() << '\n';
  } else {
    print(rows, options.show ? options.show : 20);
  }
  return done;
}

}  // namespace

void add_importance(CLI::App& app, Options& options, int& exit_code) {
  auto* const command =
      app.add_subcommand("importance", "where light must not go: adjoint of each part of each surface");
  add_scene_options(*command, options);
  command->add_option("--show", options.show, "rows; 20 unless given");
  command->add_flag("--csv", options.csv, "all rows, all digits, in the order of the scene");
  command->footer(
      "Examples:\n"
      "  straytrace importance examples/virgo_arm.yaml\n"
      "  straytrace importance examples/virgo_arm.yaml --csv > importance.csv");
  command->callback([&] { exit_code = importance(options); });
}

}  // namespace straytrace
