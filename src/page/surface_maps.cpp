// SPDX-License-Identifier: BSD-3-Clause
#include "page/surface_maps.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "trace/history/step.hpp"

namespace straytrace {
namespace {

// Coordinates of a point of a surface in the map of its name.
struct Place {
  double x = 0, y = 0;
};

Place place_on(WorldView const& view, SurfaceId id, Vec3 p, bool unrolled) {
  return view.shapes.visit(view.surfaces[id.value].shape, [&](auto const& s) {
    Frame const f = Frame::around(s.axis);
    Vec3 const o = f.to_local(p - s.reference());
    if (!unrolled) return Place{o.x, o.y};
    return Place{o.z, std::atan2(o.y, o.x) * std::hypot(o.x, o.y)};
  });
}

struct Reach {
  double low, high, r_min, r_max;
  bool barrel() const { return high > low && r_max - r_min < 1e-6 * r_max; }  // seen along its axis it is a line
};
Reach reach_of(WorldView const& view, SurfaceId id) {
  return view.shapes.visit(view.surfaces[id.value].shape, [](auto const& s) {
    double low = 0, high = 0, r_min = 0, r_max = 0;
    s.extent(low, high, r_min, r_max);
    return Reach{low, high, r_min, r_max};
  });
}

std::vector<SurfaceId> surfaces_of(World const& world, GroupId group) {
  std::vector<SurfaceId> all;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id)
    if (world.surfaces()[id].group == group) all.push_back({id});
  return all;
}

constexpr double paths_per_cell = 6;
constexpr std::size_t most_cells = 36, least_cells = 6;  // along a side

SurfaceMap empty_map(World const& world, GroupId group, std::size_t paths) {
  WorldView const view = world.view();
  std::vector<SurfaceId> const surfaces = surfaces_of(world, group);
  SurfaceMap map;
  map.name = world.groups()[group.value];
  map.surfaces = surfaces.size();
  double low = infinity, high = -infinity, r_max = 0;
  bool barrels = true;
  for (SurfaceId const id : surfaces) {
    Reach const r = reach_of(view, id);
    low = std::min(low, r.low);
    high = std::max(high, r.high);
    r_max = std::max(r_max, r.r_max);
    barrels = barrels && r.barrel();
    map.places.push_back(view.shapes.visit(view.surfaces[id.value].shape, [](auto const& s) { return s.reference(); }));
  }
  map.noise_by_place.resize(surfaces.size());
  map.unrolled = barrels || high - low > 2 * r_max;
  auto const side = std::size_t(std::sqrt(double(paths) / paths_per_cell));
  map.columns = map.rows = std::clamp(side, least_cells, most_cells);
  map.x_low = map.unrolled ? low : -r_max;
  map.x_high = map.unrolled ? high : r_max;
  map.y_high = map.unrolled ? pi * r_max : r_max;
  map.y_low = -map.y_high;
  std::size_t const cells = map.columns * map.rows;
  map.noise.resize(cells);
  map.noise_error.resize(cells);
  map.paths.resize(cells);
  return map;
}

std::size_t cell_of(SurfaceMap const& map, Place p) {
  auto const index = [](double x, double low, double high, std::size_t n) {
    double const at = (x - low) / (high - low) * double(n);
    return std::size_t(std::clamp(at, 0.0, double(n) - 1));
  };
  return index(p.y, map.y_low, map.y_high, map.rows) * map.columns + index(p.x, map.x_low, map.x_high, map.columns);
}

bool counts(NoisyPath const& n, PathPoint const& p) { return p.surface.valid() && p.body == n.body; }

}  // namespace

// Adds one path to the map of a group that it meets.
static void add_path(WorldView const& view, std::vector<SurfaceId> const& surfaces, std::uint32_t group,
                     NoisyPath const& n, SurfaceMap& map) {
  auto const times = std::count_if(n.path.points.begin(), n.path.points.end(), [&](auto& p) { return counts(n, p); });
  for (PathPoint const& p : n.path.points) {
    if (!counts(n, p) || p.group.value != group) continue;
    double const part = n.noise / double(times);
    std::size_t const cell = cell_of(map, place_on(view, p.surface, p.point, map.unrolled));
    map.noise_sum += part;
    map.noise[cell] += part;
    map.noise_error[cell] += part * part;
    ++map.paths[cell];
    auto const at = std::lower_bound(surfaces.begin(), surfaces.end(), p.surface);
    map.noise_by_place[std::size_t(at - surfaces.begin())] += part;
  }
}

std::vector<SurfaceMap> noise_maps(World const& world, std::vector<NoisyPath> const& paths, std::size_t most) {
  std::map<std::uint32_t, std::pair<double, std::size_t>> by_group;  // noise, paths
  for (NoisyPath const& n : paths) {
    std::set<std::uint32_t> met;
    for (PathPoint const& p : n.path.points)
      if (counts(n, p)) met.insert(p.group.value);
    for (std::uint32_t const group : met) {
      by_group[group].first += n.noise;
      ++by_group[group].second;
    }
  }
  std::vector<std::pair<double, std::uint32_t>> order;
  for (auto const& [group, sum] : by_group) order.emplace_back(-sum.first, group);
  std::sort(order.begin(), order.end());
  order.resize(std::min(order.size(), most));
  std::vector<SurfaceMap> maps;
  for (auto const& [noise, group] : order) {
    SurfaceMap map = empty_map(world, {group}, by_group[group].second);
    std::vector<SurfaceId> const surfaces = surfaces_of(world, {group});
    for (NoisyPath const& n : paths) add_path(world.view(), surfaces, group, n, map);
    for (double& e : map.noise_error) e = std::sqrt(e);
    maps.push_back(std::move(map));
  }
  return maps;
}

namespace {

// Power that arrives on the groups with a map, cell by cell; squares of the totals of each history.
class LightSink {
 public:
  LightSink(World const& world, WorldView const& view, std::vector<SurfaceMap>& maps) : view_(view), maps_(maps) {
    of_group_.resize(world.groups().size(), none);
    for (std::size_t i = 0; i < maps.size(); ++i) {
      for (std::size_t g = 0; g < world.groups().size(); ++g)
        if (world.groups()[g] == maps[i].name) of_group_[g] = i;
      maps[i].light.assign(maps[i].columns * maps[i].rows, 0);
      maps[i].light_error.assign(maps[i].columns * maps[i].rows, 0);
    }
  }
  template <class... T>
  void emitted(T const&...) {}
  void visit(PathState const& path, Vertex const& v) {
    std::size_t const i = of_group_[view_.surfaces[v.surface.value].group.value];
    if (i != none) here_[{i, cell_of(maps_[i], place_on(view_, v.surface, v.point, maps_[i].unrolled))}] += path.power;
  }
  template <class... T>
  void score(T const&...) {}
  void book(Fate, double) {}
  void close_history() {
    for (auto const& [cell, power] : here_) {
      maps_[cell.first].light[cell.second] += power;
      maps_[cell.first].light_error[cell.second] += power * power;
    }
    here_.clear();
  }

 private:
  static constexpr std::size_t none = ~std::size_t{0};
  WorldView const& view_;
  std::vector<SurfaceMap>& maps_;
  std::vector<std::size_t> of_group_;
  std::map<std::pair<std::size_t, std::size_t>, double> here_;
};

}  // namespace

void add_light(World const& world, std::uint64_t seed, std::uint64_t histories, std::vector<SurfaceMap>& maps) {
  WorldView const view = world.view();
  LightSink sink(world, view, maps);
  for (std::uint64_t h = 0; h < histories; ++h) {
    trace_history(view, seed, h, sink);
    sink.close_history();
  }
  auto const n = double(histories);
  for (SurfaceMap& map : maps) {
    map.histories = histories;
    double const area = map.cell_area() * double(map.surfaces);
    for (std::size_t i = 0; i < map.light.size(); ++i) {
      double const mean = map.light[i] / n, mean2 = map.light_error[i] / n;
      map.light[i] = mean / area;
      map.light_error[i] = std::sqrt(std::max(mean2 - mean * mean, 0.0) / (n - 1)) / area;
    }
  }
}

}  // namespace straytrace
