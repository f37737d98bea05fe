// SPDX-License-Identifier: BSD-3-Clause
// Maps of a surface with adaptive cells, as small as the number of arrivals allows: a spot of 0.1 mm shows on a sensor
// of 2 cm.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/math/functions.hpp"
#include "base/memory/ids.hpp"

namespace straytrace::world {

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

}  // namespace straytrace::world
