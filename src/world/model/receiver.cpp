// SPDX-License-Identifier: BSD-3-Clause
#include "world/model/receiver.hpp"

#include <algorithm>
#include <queue>
#include <type_traits>

#include "world/model/view.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {

namespace {
constexpr std::uint32_t most_depth = 24;  // a side is halved about twelve times
}

double area_of(Chart chart, MapCell const& c) {
  double const du = c.u_high - c.u_low, dv = c.v_high - c.v_low;
  return chart == Chart::polar ? 0.5 * (c.u_low + c.u_high) * du * dv : du * dv;
}

CellTree::CellTree(Chart chart, MapCell const& whole) : chart_(chart), nodes_(1), extents_{{whole}}, cells_{whole} {}

bool CellTree::halve(std::uint32_t number) {
  auto const [c, depth] = extents_[number];
  if (depth >= most_depth) return false;
  MapCell const& whole = extents_.front().cell;
  double du = c.u_high - c.u_low, dv = c.v_high - c.v_low;
  if (chart_ == Chart::unrolled) {
    du /= whole.u_high - whole.u_low;
    dv /= whole.v_high - whole.v_low;
  }
  if (chart_ == Chart::polar) dv *= 0.5 * (c.u_low + c.u_high);
  bool const along_u = du >= dv;
  double const middle = !along_u                 ? 0.5 * (c.v_low + c.v_high)
                        : chart_ == Chart::polar ? std::sqrt(0.5 * (c.u_low * c.u_low + c.u_high * c.u_high))
                                                 : 0.5 * (c.u_low + c.u_high);
  MapCell low = c, high = c;
  (along_u ? low.u_high : low.v_high) = middle;
  (along_u ? high.u_low : high.v_low) = middle;
  std::uint32_t const cell = nodes_[number].cell;
  nodes_[number] = {middle, std::uint32_t(nodes_.size()), cell, along_u};
  nodes_.push_back({0, 0, cell, 0});
  nodes_.push_back({0, 0, std::uint32_t(cells_.size()), 0});
  extents_.push_back({low, depth + 1});
  extents_.push_back({high, depth + 1});
  cells_[cell] = low;
  cells_.push_back(high);
  return true;
}

namespace {

struct Filled {
  std::uint32_t node;
  std::vector<WeightedPlace> places;
  double count = 0;

  Filled(std::uint32_t number, std::vector<WeightedPlace> here) : node(number), places(std::move(here)) {
    double sum = 0, squares = 0;
    for (WeightedPlace const& p : places) {
      sum += p.weight;
      squares += p.weight * p.weight;
    }
    count = squares > 0 ? sum * sum / squares : 0;
  }
  bool operator<(Filled const& o) const { return count != o.count ? count < o.count : node > o.node; }
};

}  // namespace

void CellTree::refine(std::vector<WeightedPlace> const& places, double most_in_cell, std::size_t most_cells) {
  std::priority_queue<Filled> queue;
  queue.emplace(0, places);
  while (!queue.empty() && cells_.size() < most_cells) {
    Filled const full = queue.top();
    queue.pop();
    if (!(full.count > most_in_cell)) return;
    if (!halve(full.node)) continue;
    CellNode const n = nodes_[full.node];
    std::vector<WeightedPlace> low, high;
    for (WeightedPlace const& p : full.places) ((n.along_u ? p.place.u : p.place.v) < n.at ? low : high).push_back(p);
    queue.emplace(n.halves, std::move(low));
    queue.emplace(n.halves + 1, std::move(high));
  }
}

namespace {

template <class S>
constexpr bool is_round = std::is_base_of_v<Cone, S> || std::is_base_of_v<Sphere, S> || std::is_same_v<S, Disk> ||
                          std::is_same_v<S, Cap> || std::is_same_v<S, Torus>;

struct Reach {
  Extent extent{infinity, -infinity, infinity, 0};
  bool round = true, barrel = true;  // a barrel seen along its axis is a line
  void add(Reach const& r) {
    extent = {std::min(extent.low, r.extent.low), std::max(extent.high, r.extent.high),
              std::min(extent.r_min, r.extent.r_min), std::max(extent.r_max, r.extent.r_max)};
    round = round && r.round;
    barrel = barrel && r.barrel;
  }
};
Reach reach_of(WorldView const& view, SurfaceId id) {
  return view.shapes.visit(view.surfaces[id.value].shape, [](auto const& s) {
    Extent const e = s.extent();
    return Reach{e, is_round<std::decay_t<decltype(s)>>, e.high > e.low && e.r_max - e.r_min < 1e-6 * e.r_max};
  });
}

}  // namespace

SurfaceChart chart_of(WorldView const& view, std::span<SurfaceId const> surfaces) {
  Reach all;
  for (SurfaceId const id : surfaces) all.add(reach_of(view, id));
  double const r = all.extent.r_max;
  if (all.barrel || all.extent.high - all.extent.low > 2 * r)
    return {Chart::unrolled, {all.extent.low, all.extent.high, -pi * r, pi * r}};
  if (all.round) return {Chart::polar, {all.extent.r_min, r, -pi, pi}};
  return {Chart::plane, {-r, r, -r, r}};
}

namespace {

// Whether a line across the map at this place meets the surface; `far`: m, more than the surface extends.
template <class Meets>
bool is_filled(Chart chart, MapPlace p, double far, Meets const& meets) {
  if (chart != Chart::unrolled) {
    SinCos const a = chart == Chart::polar ? sincos_turn(p.v / (2 * pi)) : SinCos{0, 1};
    Vec3 const at = chart == Chart::polar ? Vec3{p.u * a.cos, p.u * a.sin, -far} : Vec3{p.u, p.v, -far};
    return meets(at, Vec3{0, 0, 1}, 2 * far) < infinity;
  }
  double angle = 0;
  for (int i = 0; i < 2; ++i) {  // the arc counts at the radius of the surface there
    SinCos const a = sincos_turn(angle / (2 * pi));
    double const radius = meets(Vec3{0, 0, p.u}, Vec3{a.cos, a.sin, 0}, far);
    if (!(radius < infinity)) return false;
    angle = p.v / radius;
  }
  return std::fabs(angle) <= pi;
}

}  // namespace

double filled_share(WorldView const& view, SurfaceId id, Chart chart, MapCell const& c) {
  return filled_share(view, id, chart, c, view.shapes.visit(view.surfaces[id.value].shape, [](auto const& s) {
    return facing_along(s.reference(), s.axis);
  }));
}

double filled_share(WorldView const& view, SurfaceId id, Chart chart, MapCell const& c, Pose const& frame) {
  Reach const reach = reach_of(view, id);
  Vec3 const reference = view.shapes.visit(view.surfaces[id.value].shape, [](auto const& s) { return s.reference(); });
  double const far = 2 * (std::fabs(reach.extent.low) + std::fabs(reach.extent.high) + reach.extent.r_max +
                          length(frame.origin - reference)) +
                     1e-3;
  auto const meets = [&](Vec3 from, Vec3 dir, double end) {
    return view.cross(id.value, {frame.point(from), frame.direction(dir), end}, {}).distance;
  };
  auto const filled = [&](int lines) {  // of lines x lines places, spread evenly over the area of the cell
    int count = 0;
    for (int i = 0; i < lines; ++i)
      for (int k = 0; k < lines; ++k) {
        double const x = (i + 0.5) / lines, y = (k + 0.5) / lines;
        double const u = chart == Chart::polar
                             ? std::sqrt(c.u_low * c.u_low + x * (c.u_high * c.u_high - c.u_low * c.u_low))
                             : c.u_low + x * (c.u_high - c.u_low);
        count += is_filled(chart, {u, c.v_low + y * (c.v_high - c.v_low)}, far, meets);
      }
    return count;
  };
  constexpr int coarse = 8, fine = 64;
  int const first = filled(coarse);
  if (first == 0) return 0;
  return first == coarse * coarse ? 1 : double(filled(fine)) / (fine * fine);
}

static MapCell pixel(Receiver const& r, std::size_t i) {
  double const width = 2 * r.half_width / r.columns, height = 2 * r.half_height / r.rows;
  double const x = double(i % r.columns) * width - r.half_width, y = double(i / r.columns) * height - r.half_height;
  return {x, x + width, y, y + height};
}

std::vector<double> map_areas(WorldView const& view, SurfaceId surface, Receiver const& r) {
  std::vector<double> areas(r.map_size());
  for (std::size_t i = 0; i < areas.size(); ++i) {
    double const share = filled_share(view, surface, r.by_light ? r.chart : Chart::plane,
                                      r.by_light ? r.cells[i] : pixel(r, i), r.frame);
    areas[i] = r.area(i) * (share > 0 ? share : 1);
  }
  return areas;
}

std::vector<double> group_areas(WorldView const& view, std::size_t groups) {
  std::vector<double> areas(groups, 0);
  for (std::size_t id = 0; id < view.surfaces.size; ++id)
    areas[view.surfaces[id].group.value] +=
        view.shapes.visit(view.surfaces[id].shape, [](auto const& shape) { return double(shape.area()); });
  return areas;
}

}  // namespace straytrace::world
