// SPDX-License-Identifier: BSD-3-Clause
// Receivers count light in watts, in maps of cells: photodiodes, quadrants, cameras, measuring planes. Any surface can
// be one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"
#include "base/memory/ids.hpp"

namespace straytrace::world {

// Receivers count light in watts: photodiodes, quadrants, cameras, measuring planes. Any surface can be one.

// Maps of a surface with adaptive cells, as small as the number of arrivals allows: a spot of 0.1 mm shows on a sensor
// of 2 cm.

struct WorldView;

// Meaning of u and v. plane: x, y across an axis [m]; polar: distance from the axis [m], angle about it [rad];
// unrolled: along the axis, arc about it [m].
enum class Chart : std::uint8_t { plane, polar, unrolled };

struct MapPlace {
  double u = 0, v = 0;
};
// Coordinates of a point in the frame of the map, whose third axis is that of the surface. The angle is from -pi to pi.
STRAY_HD MapPlace place_in(Chart chart, Vec3 p) {
  if (chart == Chart::plane) return {p.x, p.y};
  double const turn = turn_of(p.x, p.y), angle = 2 * pi * (turn < 0.5 ? turn : turn - 1);
  double const radius = std::sqrt(p.x * p.x + p.y * p.y);
  return chart == Chart::polar ? MapPlace{radius, angle} : MapPlace{p.z, angle * radius};
}
struct WeightedPlace {
  MapPlace place;
  double weight = 1;  // > 0
};
struct MapCell {
  double u_low = 0, u_high = 0, v_low = 0, v_high = 0;
};
double area_of(Chart, MapCell const&);  // m^2, in the map; tilted surfaces are larger

// A node of a binary tree: splits its cell at `at`, or holds the number of a cell.
struct CellNode {
  double at = 0;
  std::uint32_t halves = 0;  // number of the first half, the second follows; 0: none
  std::uint32_t cell = 0;
  std::uint32_t along_u = 0;  // 1: u is halved, 0: v
};
// Number of the cell; places outside the whole belong to the nearest cell.
STRAY_HD std::uint32_t cell_at(View<CellNode const> nodes, MapPlace p) {
  std::uint32_t n = 0;
  while (nodes[n].halves) n = nodes[n].halves + ((nodes[n].along_u ? p.u : p.v) < nodes[n].at ? 0 : 1);
  return nodes[n].cell;
}

// A rectangle of u and v, halved repeatedly along its longer side: in polar charts into equal areas; in unrolled ones,
// whose sides may be km and m, along the side that is longer relative to the whole.
class CellTree {
 public:
  CellTree(Chart, MapCell const& whole);
  // Halves the fullest cell, ties to the older one, until no cell holds more than `most_in_cell` places or there are
  // `most_cells`. Weighted places count as their effective number, (sum w)^2 / sum w^2. Cells are a function of the
  // list alone.
  void refine(std::vector<WeightedPlace> const&, double most_in_cell, std::size_t most_cells);
  std::size_t at(MapPlace p) const { return cell_at({nodes_.data(), nodes_.size()}, p); }
  std::vector<MapCell> const& cells() const { return cells_; }
  std::vector<CellNode> const& nodes() const { return nodes_; }

 private:
  struct Extent {
    MapCell cell;
    std::uint32_t depth = 0;
  };
  bool halve(std::uint32_t node);  // false: the cell has the smallest size
  Chart chart_;
  std::vector<CellNode> nodes_;
  std::vector<Extent> extents_;  // by node
  std::vector<MapCell> cells_;
};

// The chart of surfaces laid over one another: polar for round ones, unrolled for cylinders and surfaces longer than
// wide, otherwise x and y across the axis.
struct SurfaceChart {
  Chart chart = Chart::plane;
  MapCell whole;  // about reference() and `axis` of the shapes; contains all of them
};
SurfaceChart chart_of(WorldView const&, std::span<SurfaceId const>);

// Share of a cell that the surface fills: less than 1 where a rim crosses the cell (to 0.5 %), 0 beyond the rim. The
// frame of the map stands at reference() of the shape, with `axis` as its third axis.
double filled_share(WorldView const&, SurfaceId, Chart, MapCell const&);

struct Receiver {
  SurfaceId surface;
  bool front = true, back = false;  // sides of the surface that count
  bool clear = false;               // a measuring plane: light passes, and it hides nothing
  bool behind_glass = false;        // sees through lenses and mirrors, or is stated to do so
  double sub_paths = 0;             // mean number per history that start here (trace/step/sub_path.hpp)
  // Mirrors and glass that sub-paths aim at, each with the share of sub-paths that does; the others start by the cosine
  // law.
  struct Aim {
    SurfaceId surface;
    bool shows_beam = false;  // surfaces that light of beams meets first
    double share = 0;
  };
  static constexpr std::uint32_t most_aims = 8;
  static constexpr double most_aimed = 0.75;  // of all
  std::uint32_t aims = 0;
  Aim aim[most_aims];
  double cosine_share = 1;
  Pose frame;  // e3: its normal; origin and e1, e2: centre and axes of the maps
  // Map over the surface: columns x rows pixels over 2 half_width x 2 half_height, m, along e1 and e2. 0: none.
  std::uint32_t columns = 0, rows = 0;
  double half_width = 0, half_height = 0;
  // A map without stated pixels: cells of a chart about `frame`, as small as the light of a pilot run allows
  // (trace/tally/map_cells.hpp); no cells before that run. With a half_width, light outside `whole` does not count.
  bool by_light = false;
  Chart chart = Chart::plane;
  MapCell whole;
  View<CellNode const> nodes;
  View<MapCell const> cells;
  // Map over directions of arrival: direction cosines along e1 and e2 within +-half_angle_sine, square pixels. 0: none.
  std::uint32_t angle_bins = 0;
  double half_angle_sine = 1;
  // Quadrants: signs of x and y in a frame of their own; light within half the gap of an axis is in none.
  bool quadrants = false;
  Pose quadrant_frame;
  double gap = 0;                                     // m, full width
  static constexpr std::uint32_t quadrant_cells = 5;  // lower left, lower right, upper left, upper right, gap
  static constexpr std::uint32_t outside = 0xffffffffu;

  // Aims at all of these equally, at most `most_aims`.
  void aim_at(std::vector<Aim> const& at) {
    aims = std::uint32_t(at.size());
    std::ranges::copy(at, aim);
    std::vector<double> const equal(at.size(), most_aimed / double(std::max<std::size_t>(at.size(), 1)));
    set_aim_shares(equal);
  }
  void set_aim_shares(std::span<double const> shares) {
    cosine_share = 1;
    for (std::uint32_t i = 0; i < aims; ++i) cosine_share -= aim[i].share = shares[i];
  }
  STRAY_HD bool counts(bool lit_front) const { return lit_front ? front : back; }
  STRAY_HD int sides() const { return (front ? 1 : 0) + (back ? 1 : 0); }
  STRAY_HD std::uint32_t pixel(Vec3 p) const {
    Vec3 const q = frame.local_point(p);
    if (by_light) return map_cell(place_in(chart, q));
    return cell(q.x / half_width, q.y / half_height, columns, rows);
  }
  // For maps by light: without a half_width the map covers the whole surface, including rims rounded outwards.
  STRAY_HD bool inside(MapPlace p) const {
    return half_width == 0 || (p.u >= whole.u_low && p.u < whole.u_high && p.v >= whole.v_low && p.v < whole.v_high);
  }
  STRAY_HD std::uint32_t map_cell(MapPlace p) const {
    return nodes.size > 0 && inside(p) ? cell_at(nodes, p) : outside;
  }
  STRAY_HD std::uint32_t map_size() const { return by_light ? std::uint32_t(cells.size) : columns * rows; }
  // Of the map, m^2.
  double area(std::size_t i) const {
    return by_light ? area_of(chart, cells[i]) : 4 * half_width * half_height / (double(columns) * rows);
  }
  STRAY_HD std::uint32_t angle_pixel(Vec3 travel) const {
    Vec3 const d = frame.local_direction(travel);
    return cell(d.x / half_angle_sine, d.y / half_angle_sine, angle_bins, angle_bins);
  }
  STRAY_HD std::uint32_t quadrant(Vec3 p) const {
    Vec3 const q = quadrant_frame.local_point(p);
    if (2 * std::fabs(q.x) < gap || 2 * std::fabs(q.y) < gap) return quadrant_cells - 1;
    return (q.x < 0 ? 0 : 1) + (q.y < 0 ? 0 : 2);
  }
  // Cell of a point of the square [-1, 1]^2, row by row from the lower left.
  STRAY_HD static std::uint32_t cell(double x, double y, std::uint32_t columns, std::uint32_t rows) {
    if (columns == 0 || !(x >= -1 && x < 1 && y >= -1 && y < 1)) return outside;
    auto const i = static_cast<std::uint32_t>(0.5 * (x + 1) * columns);
    auto const j = static_cast<std::uint32_t>(0.5 * (y + 1) * rows);
    return (j < rows ? j : rows - 1) * columns + (i < columns ? i : columns - 1);
  }
};

}  // namespace straytrace::world
