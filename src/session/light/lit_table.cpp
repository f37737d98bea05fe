// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/lit_table.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "results/text/columns.hpp"
#include "trace/importance/importance.hpp"
#include "world/ghosts/apertures.hpp"

namespace straytrace::session {
namespace {

std::string name_of(World const& world, Footprint const& f) { return world.name_of(f.surface); }
std::string port_of(World const& world, Footprint const& f) {
  return f.port.valid() ? world.ports()[f.port.value] : "";
}
std::string beside(LitRow const& row) {
  return row.clipped > row.resolution ? fmt::format("{:.2g}", row.clipped) : fmt::format("< {:.1g}", row.resolution);
}

}  // namespace

std::string lit_table(Model const& model) {
  World const& world = model.world;
  auto const followed = [](Feed const& feed) { return feed.propagated; };
  if (std::none_of(world.feeds().begin(), world.feeds().end(), followed)) return {};
  Columns table{{"lit by", "surface", "order", "radius [mm]", "power", "beside", "path [m]", "incidence", "port"},
                {true, true},
                {}};
  for (LitRow const& row : lit_rows(world)) {
    Footprint const& f = world.footprints()[row.footprint];
    Feed const& feed = world.feeds()[row.footprint];
    bool const round = row.major - row.minor < 5e-4 * row.major;
    table.rows.push_back({world.beams[f.beam].name, name_of(world, f), fmt::format("{}", feed.order),
                          round ? fmt::format("{:.4g}", 1e3 * row.major)
                                : fmt::format("{:.4g} x {:.4g}", 1e3 * row.major, 1e3 * row.minor),
                          fmt::format("{:.4g}", f.share), beside(row), fmt::format("{:.6g}", feed.path_length),
                          std::isnan(row.incidence)
                              ? "-"
                              : fmt::format("{:.4g} deg", row.incidence > 1e-9 ? row.incidence * 180 / pi : 0),
                          row.scatters ? port_of(world, f) : "no scatter"});
  }
  return "lit surfaces: 1/e^2 intensity radius, power over that of the main mode, share of it outside the surface\n" +
         aligned(table);
}

nlohmann::ordered_json lit_json(Model const& model) {
  World const& world = model.world;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (LitRow const& row : lit_rows(world)) {
    Footprint const& f = world.footprints()[row.footprint];
    Feed const& feed = world.feeds()[row.footprint];
    nlohmann::ordered_json j = {{"beam", world.beams[f.beam].name},
                                {"surface", name_of(world, f)},
                                {"order", feed.order},
                                {"radii_m", {row.major, row.minor}},
                                {"power", f.share},
                                {"path_length_m", feed.path_length},
                                {"incidence_rad", row.incidence},
                                {"scatters", row.scatters}};
    if (row.clipped > row.resolution)
      j["beside"] = row.clipped;
    else
      j["beside_below"] = row.resolution;
    if (f.port.valid()) j["port"] = world.ports()[f.port.value];
    list.push_back(std::move(j));
  }
  return list;
}

ImportanceMap importance_map(World const& world) {
  SteeringTables const& tables = world.steering();
  WorldView const view = world.view();
  ImportanceMap map;
  for (Strip const& s : tables.strips) {
    Box const box = bounds_of(view, s);
    std::uint32_t const group = world.surfaces()[s.surface.value].group.value;
    map.strips.push_back({group, s.patch, box.lower.z, box.upper.z, s.area});
  }
  for (PatchSide const& side : tables.sides) {
    map.adjoint.push_back(side.adjoint);
    map.law_share.push_back(side.alpha);
  }
  return map;
}

bool show_importance(World& world, ImportanceMap const& map) {
  SteeringTables tables = make_strips(world);
  if (tables.strips.size() != map.strips.size()) return false;
  for (std::size_t i = 0; i < map.strips.size(); ++i) tables.strips[i].patch = map.strips[i].patch;
  tables.patches.clear();  // nothing is drawn from them
  tables.members.clear();
  tables.sides.resize(map.adjoint.size());
  for (std::size_t i = 0; i < map.adjoint.size(); ++i) tables.sides[i].adjoint = map.adjoint[i];
  world.steer(std::move(tables));
  return true;
}

}  // namespace straytrace::session
