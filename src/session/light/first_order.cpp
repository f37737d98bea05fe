// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/first_order.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iostream>

#include "base/errors.hpp"
#include "base/text/json_text.hpp"
#include "results/results.hpp"
#include "results/text/columns.hpp"
#include "session/open_run.hpp"
#include "trace/camera/first_order.hpp"
#include "world/ghosts/obstacle.hpp"

namespace straytrace::session {
namespace {

std::string cell(Estimate const& e) {
  if (e.scored == 0) return "-";
  if (!resolved(e)) return "unresolved";
  return e.std_error > 0 ? with_brackets(e.mean, e.std_error) : fmt::format("{:.4g}", e.mean);
}

std::string name_of(Model const& model, Ending ending) {
  if (!ending.port) return "receiver " + model.world.receiver_names()[ending.index];
  Footprint const& f = model.world.footprints()[ending.index];
  return fmt::format("port {} at {}", model.world.ports()[f.port.value], model.world.name_of(f.surface));
}
std::string group_name(Model const& model, FirstOrderRow const& row) { return model.world.groups()[row.group.value]; }

bool is_suspect(FirstOrderRow const& row) { return row.product.mean > 0; }

void print_lit(Model const& model, std::vector<FirstOrderRow> rows, std::size_t show) {
  std::stable_sort(rows.begin(), rows.end(),
                   [](FirstOrderRow const& a, FirstOrderRow const& b) { return a.power.mean > b.power.mean; });
  Columns table{{"illuminated", "power"}, {true}, {}};
  std::size_t left = 0;
  for (FirstOrderRow const& row : rows)
    if (row.power.scored > 0) {
      if (table.rows.size() < show)
        table.rows.push_back({group_name(model, row), cell(row.power)});
      else
        ++left;
    }
  std::cout
      << "Illuminated by the first scatter of the beams, or by free beams, directly or through mirrors and lenses.\n"
      << "Power relative to the main mode.\n"
      << aligned(table) << (left ? fmt::format("and {} more; --csv has all\n", left) : "") << '\n';
}

void print_seen(Model const& model, FirstOrderList const& list, std::size_t show) {
  std::vector<FirstOrderRow> rows = list.rows;
  std::stable_sort(rows.begin(), rows.end(), [](FirstOrderRow const& a, FirstOrderRow const& b) {
    return is_suspect(a) != is_suspect(b) ? is_suspect(a)
           : is_suspect(a)                ? a.product.mean > b.product.mean
                                          : a.throughput.mean > b.throughput.mean;
  });
  Columns table{{"#", "critical", "throughput", "power", "single scatter"}, {false, true}, {}};
  std::size_t left = 0, rank = 0;
  for (FirstOrderRow const& row : rows) {
    if (row.throughput.scored == 0) continue;
    bool const both = is_suspect(row);
    if (both) ++rank;
    if (table.rows.size() >= show) {
      ++left;
      continue;
    }
    bool const sure = resolved(row.power) && resolved(row.throughput);
    table.rows.push_back({both ? fmt::format("{}", rank) : "", group_name(model, row), cell(row.throughput),
                          cell(row.power),
                          !both  ? "-"
                          : sure ? with_brackets(row.product.mean, row.product.std_error)
                                 : "unresolved"});
  }
  std::cout << fmt::format("Seen from {}: total throughput {:.4g} m^2 sr", name_of(model, list.ending), list.total);
  if (list.outside.scored > 0) std::cout << fmt::format(", of which {} escapes", cell(list.outside));
  if (table.rows.empty())
    std::cout << "\nno walk met a surface: narrow or distant ones may be missed; use more walks (--histories)\n\n";
  else
    std::cout << '\n' << aligned(table) << (left ? fmt::format("and {} more; --csv has all\n", left) : "") << '\n';
}

void print_csv(Model const& model, std::vector<FirstOrderList> const& lists) {
  std::cout << "ending,surface,power,power_error,throughput_m2_sr,throughput_error,single_scatter,single_scatter_error,"
               "resolved\n";
  for (FirstOrderList const& list : lists)
    for (FirstOrderRow const& r : list.rows)
      std::cout << fmt::format("\"{}\",\"{}\",{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{}\n",
                               name_of(model, list.ending), group_name(model, r), r.power.mean, r.power.std_error,
                               r.throughput.mean, r.throughput.std_error, r.product.mean, r.product.std_error,
                               resolved(r.power) && resolved(r.throughput) ? "yes" : "no");
}

void print_json(Model const& model, std::vector<FirstOrderList> const& lists) {
  nlohmann::json out = nlohmann::json::array();
  auto const with_error = [](Estimate const& e) {
    return nlohmann::json{{"value", e.mean}, {"error", e.std_error}, {"resolved", resolved(e)}};
  };
  for (FirstOrderList const& list : lists) {
    nlohmann::json rows = nlohmann::json::array();
    for (FirstOrderRow const& r : list.rows) {
      nlohmann::json const product{{"value", r.product.mean},
                                   {"error", r.product.std_error},
                                   {"resolved", resolved(r.power) && resolved(r.throughput)}};
      rows.push_back({{"surface", group_name(model, r)},
                      {"power", with_error(r.power)},
                      {"throughput", with_error(r.throughput)},
                      {"single_scatter", product}});
    }
    out.push_back({{"ending", name_of(model, list.ending)},
                   {"throughput", list.total},
                   {"outside", with_error(list.outside)},
                   {"surfaces", rows}});
  }
  std::cout << json_text(out) << '\n';
}

}  // namespace

int print_first_order(FirstOrderOptions const& options) {
  RunInput const input(options.input);
  Model const model = input.read(options.overrides);
  FirstOrderSettings settings;
  settings.seed = model.seed;
  settings.histories = options.histories.value_or(settings.histories);
  std::vector<FirstOrderList> lists = first_order(model.world, settings);
  if (!options.by.empty()) {
    std::erase_if(lists, [&](FirstOrderList const& list) { return list.ending.port != (options.by == "port"); });
    if (lists.empty()) throw InputError(fmt::format("the scene has no {}s", options.by), "remove --by");
  }
  if (options.csv) {
    print_csv(model, lists);
  } else if (options.json()) {
    print_json(model, lists);
  } else {
    std::size_t const show = options.show ? options.show : model.paths_shown;
    if (!lists.empty()) print_lit(model, lists.front().rows, show);
    for (FirstOrderList const& list : lists) print_seen(model, list, show);
    std::cout << "single scatter: into this ending, relative to the main mode, as if surfaces were Lambertian\n";
  }
  return done;
}

namespace {

Footprint const* standing_on(World const& world, GroupId group) {
  for (Footprint const& f : world.footprints())
    if (f.standing && f.surface.valid() && world.surfaces()[f.surface.value].group == group) return &f;
  return nullptr;
}

PathPoint on_surface(World const& world, SurfaceId id, Vec3 point, Event event) {
  Surface const& s = world.surfaces()[id.value];
  return {point, event, s.group, s.body, id};
}

std::vector<DrawnPath> by_rims(World const& world, CouplingClass const& c, std::size_t most) {
  std::vector<DrawnPath> all;
  if (c.steps.size() != 3) return all;
  Footprint const *const from = standing_on(world, c.steps.front().group), *const to =
                                                                               standing_on(world, c.steps.back().group);
  std::vector<InnerRim> rims;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id)
    if (world.surfaces()[id].group == c.steps[1].group)
      if (auto const rim = rim_of(world, {id})) rims.push_back(*rim);
  if (!from || !to || rims.empty()) return all;
  for (std::size_t i = 0; i < most; ++i) {
    InnerRim const& rim = rims[i * rims.size() / most];
    DrawnPath path;
    path.route = c.hash;
    path.computed = true;
    path.weight = c.coupling.mean / double(most);
    Vec3 const edge = rim_point(rim, 2 * pi * 0.381966 * double(i));  // golden angle: evenly around
    path.points = {on_surface(world, from->surface, from->centre, Event::emit),
                   on_surface(world, rim.surface, edge, c.steps[1].event),
                   on_surface(world, to->surface, to->centre, Event::couple)};
    path.path_length = length(edge - from->centre) + length(to->centre - edge);
    all.push_back(std::move(path));
  }
  return all;
}

// Whether a ghost comes into line with the main beam along the first steps of the route.
bool goes_so(GhostRow const& row, CouplingClass const& c) {
  Recoupling const& r = row.ghost.standing.recoupled;
  if (row.ghost.order == 0 || !r.any || !r.against || r.steps > row.steps.size() || r.steps > c.steps.size())
    return false;
  return std::equal(row.steps.begin(), row.steps.begin() + std::ptrdiff_t(r.steps), c.steps.begin());
}

std::vector<DrawnPath> by_ghosts(CouplingClass const& c, std::vector<GhostReport> const& reports, std::size_t most) {
  std::vector<DrawnPath> all;
  for (GhostReport const& report : reports)
    for (GhostRow const& row : report.rows) {
      if (all.size() == most || !goes_so(row, c)) continue;
      DrawnPath path;
      path.route = c.hash;
      path.computed = true;
      path.weight = row.ghost.standing.recoupled.share();
      path.path_length = row.ghost.path_length;
      for (std::size_t i = 0; i < row.points.size(); ++i) {  // from the launch, where no surface is passed
        std::size_t const step = i + row.steps.size() - row.points.size();
        bool const known = i + row.steps.size() >= row.points.size();
        path.points.push_back({row.points[i],
                               known ? row.steps[step].event : Event::start,
                               known ? row.steps[step].group : c.steps.front().group,
                               {},
                               {}});
      }
      path.points.push_back({row.ghost.point, Event::couple, row.ghost.where, {}, {}});
      all.push_back(std::move(path));
    }
  return all;
}

}  // namespace

std::vector<DrawnPath> computed_paths(World const& world, CouplingClass const& c,
                                      std::vector<GhostReport> const& ghosts, std::size_t most) {
  if (c.kind == ClassKind::scattered) return {};
  return c.kind == ClassKind::ghost ? by_ghosts(c, ghosts, most) : by_rims(world, c, most);
}

}  // namespace straytrace::session
