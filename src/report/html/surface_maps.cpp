// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "report/html/page_json.hpp"
#include "trace/step/step.hpp"

namespace straytrace::report {
namespace {

// Errors stay below 30 % with a dozen paths per cell: cells with more than twice as many are halved.
constexpr double most_paths_in_cell = 24;
constexpr std::size_t most_cells = 512;
// Histories that make the cells of light are others than those that fill them, a quarter as many: six to twelve
// arrivals of theirs become 24 to 48. Arrivals count independent of their power: otherwise one with most of it would
// leave a single cell.
constexpr std::uint64_t pilot_part = 4;
constexpr double most_pilots_in_cell = 12;
constexpr std::size_t most_pilots = 1 << 17;

MapPlace place_on(WorldView const& view, SurfaceId id, Vec3 p, Chart chart) {
  return view.shapes.visit(view.surfaces[id.value].shape, [&](auto const& s) {
    Vec3 const o = Frame::around(s.axis).to_local(p - s.reference());
    return place_in(chart, o);
  });
}

std::vector<SurfaceId> surfaces_of(World const& world, GroupId group) {
  std::vector<SurfaceId> all;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id)
    if (world.surfaces()[id].group == group) all.push_back({id});
  return all;
}

SurfaceMap empty_map(World const& world, GroupId group, std::vector<SurfaceId> const& surfaces) {
  WorldView const view = world.view();
  SurfaceMap map;
  map.name = world.groups()[group.value];
  map.group = group;
  map.surfaces = surfaces.size();
  for (SurfaceId const id : surfaces) {
    map.places.push_back(view.shapes.visit(view.surfaces[id.value].shape, [](auto const& s) { return s.reference(); }));
  }
  Frame const f = view.shapes.visit(view.surfaces[surfaces.front().value].shape,
                                    [](auto const& s) { return Frame::around(s.axis); });
  map.x_axis = f.e1;
  map.y_axis = f.e2;
  map.noise_by_place.resize(surfaces.size());
  map.noise_by_place_error.resize(surfaces.size());
  auto const [chart, whole] = chart_of(view, surfaces);
  map.chart = chart;
  map.whole = whole;
  return map;
}

// Surfaces of equal shape count once, with their number.
std::vector<std::pair<SurfaceId, double>> distinct(WorldView const& view, std::vector<SurfaceId> const& surfaces) {
  std::map<std::array<double, 6>, std::pair<SurfaceId, double>> all;
  for (SurfaceId const id : surfaces) {
    PoolRef const shape = view.surfaces[id.value].shape;
    auto const size = view.shapes.visit(shape, [&](auto const& s) {
      auto const [low, high, r_min, r_max] = s.extent();
      return std::array<double, 6>{double(shape.kind), low, high, r_min, r_max, s.area()};
    });
    ++all.try_emplace(size, id, 0).first->second.second;
  }
  std::vector<std::pair<SurfaceId, double>> list;
  for (auto const& [size, entry] : all) list.push_back(entry);
  return list;
}

// Areas of the cells; leaves out cells beyond the rims of all surfaces.
void trim(World const& world, std::vector<SurfaceId> const& surfaces, Chart chart, CellValues& map) {
  WorldView const view = world.view();
  auto const shapes = distinct(view, surfaces);
  CellValues kept;
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    double share = 0;
    for (auto const& [id, number] : shapes)
      share += filled_share(view, id, chart, map.cells[i]) * number / double(surfaces.size());
    if (share == 0 && map.count[i] == 0) continue;
    kept.cells.push_back(map.cells[i]);
    kept.value.push_back(map.value[i]);
    kept.error.push_back(map.error[i]);
    kept.count.push_back(map.count[i]);
    kept.area.push_back(area_of(chart, map.cells[i]) * (share > 0 ? share : 1));
  }
  map = std::move(kept);
}

bool counts(NoisyPath const& n, PathPoint const& p) { return p.surface.valid() && p.body == n.body; }

void start(CellValues& values, CellTree const& tree) {
  values.cells = tree.cells();
  values.value.assign(values.cells.size(), 0);
  values.error.assign(values.cells.size(), 0);
  values.count.assign(values.cells.size(), 0);
}

SurfaceMap noise_map(World const& world, GroupId group, std::vector<NoisyPath> const& paths) {
  WorldView const view = world.view();
  std::vector<SurfaceId> const surfaces = surfaces_of(world, group);
  SurfaceMap map = empty_map(world, group, surfaces);
  std::vector<WeightedPlace> all;
  for (NoisyPath const& n : paths) {
    auto const times = std::count_if(n.path.points.begin(), n.path.points.end(), [&](auto& p) { return counts(n, p); });
    for (PathPoint const& p : n.path.points) {
      if (!counts(n, p) || p.group != group) continue;
      double const part = n.noise / double(times);
      all.push_back({place_on(view, p.surface, p.point, map.chart), part});
      auto const at = std::size_t(std::lower_bound(surfaces.begin(), surfaces.end(), p.surface) - surfaces.begin());
      map.noise_sum += part;
      map.noise_by_place[at] += part;
      map.noise_by_place_error[at] += part * part;
    }
  }
  CellTree tree(map.chart, map.whole);
  tree.refine(all, most_paths_in_cell, most_cells);
  start(map.noise, tree);
  for (WeightedPlace const& p : all) {
    std::size_t const i = tree.at(p.place);
    map.noise.value[i] += p.weight;
    map.noise.error[i] += p.weight * p.weight;
    ++map.noise.count[i];
  }
  for (auto* errors : {&map.noise.error, &map.noise_by_place_error})
    for (double& e : *errors) e = std::sqrt(e);
  trim(world, surfaces, map.chart, map.noise);
  return map;
}

}  // namespace

std::vector<SurfaceMap> noise_maps(World const& world, std::vector<NoisyPath> const& paths, std::size_t most) {
  std::map<std::uint32_t, double> by_group;
  for (NoisyPath const& n : paths) {
    std::set<std::uint32_t> met;
    for (PathPoint const& p : n.path.points)
      if (counts(n, p)) met.insert(p.group.value);
    for (std::uint32_t const group : met) by_group[group] += n.noise;
  }
  std::vector<std::pair<double, std::uint32_t>> order;
  for (auto const& [group, noise] : by_group) order.emplace_back(-noise, group);
  std::sort(order.begin(), order.end());
  order.resize(std::min(order.size(), most));
  std::vector<SurfaceMap> maps;
  for (auto const& [noise, group] : order) maps.push_back(noise_map(world, {group}, paths));
  return maps;
}

namespace {

// Receives every arrival on the groups with a map: each(map, place, power).
template <class Each>
class ArrivalSink {
 public:
  ArrivalSink(World const& world, WorldView const& view, std::vector<SurfaceMap> const& maps, Each each)
      : view_(view), maps_(maps), each_(each) {
    of_group_.resize(world.groups().size(), none);
    for (std::size_t i = 0; i < maps.size(); ++i) of_group_[maps[i].group.value] = i;
  }
  template <class... T>
  void emitted(T const&...) {}
  void visit(PathState const& path, Vertex const& v) {
    std::size_t const i = of_group_[view_.surfaces[v.surface.value].group.value];
    if (i != none) each_(i, place_on(view_, v.surface, v.point, maps_[i].chart), path.power);
  }
  template <class... T>
  void score(T const&...) {}
  void book(BalanceTerm, double) {}

 private:
  static constexpr std::size_t none = ~std::size_t{0};
  WorldView const& view_;
  std::vector<SurfaceMap> const& maps_;
  Each each_;
  std::vector<std::size_t> of_group_;
};

std::vector<CellTree> trees_of_light(World const& world, WorldView const& view, std::uint64_t seed, std::uint64_t first,
                                     std::uint64_t histories, std::vector<SurfaceMap> const& maps) {
  std::vector<std::vector<WeightedPlace>> places(maps.size());
  ArrivalSink sink(world, view, maps, [&](std::size_t i, MapPlace p, double) {
    if (places[i].size() < most_pilots) places[i].push_back({p});
  });
  for (std::uint64_t h = first; h < first + histories; ++h) trace_history(view, seed, h, sink);
  std::vector<CellTree> trees;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    trees.emplace_back(maps[i].chart, maps[i].whole);
    trees.back().refine(places[i], most_pilots_in_cell, most_cells);
  }
  return trees;
}

}  // namespace

void add_light(SteeredWorld const& world, std::uint64_t seed, std::uint64_t histories, std::vector<SurfaceMap>& maps) {
  WorldView const view = world.view();
  std::vector<CellTree> const trees = trees_of_light(world, view, seed, histories, histories / pilot_part, maps);
  for (std::size_t i = 0; i < maps.size(); ++i) start(maps[i].light, trees[i]);
  std::map<std::pair<std::size_t, std::size_t>, double> here;  // power of one history by map and cell
  ArrivalSink sink(world, view, maps, [&](std::size_t i, MapPlace p, double power) {
    std::size_t const cell = trees[i].at(p);
    here[{i, cell}] += power;
    ++maps[i].light.count[cell];
  });
  for (std::uint64_t h = 0; h < histories; ++h) {
    trace_history(view, seed, h, sink);
    for (auto const& [cell, power] : here) {
      maps[cell.first].light.value[cell.second] += power;
      maps[cell.first].light.error[cell.second] += power * power;
    }
    here.clear();
  }
  auto const n = double(histories);
  for (SurfaceMap& map : maps) {
    map.histories = histories;
    trim(world, surfaces_of(world, map.group), map.chart, map.light);
    for (std::size_t i = 0; i < map.light.cells.size(); ++i) {
      double const area = map.light.area[i] * double(map.surfaces);
      double const mean = map.light.value[i] / n, mean2 = map.light.error[i] / n;
      map.light.value[i] = mean / area;
      map.light.error[i] = std::sqrt(std::max(mean2 - mean * mean, 0.0) / (n - 1)) / area;
    }
  }
}

}  // namespace straytrace::report
