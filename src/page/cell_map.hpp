// SPDX-License-Identifier: BSD-3-Clause
// Maps of a surface with cells as small as what falls into them allows: a spot of 0.1 mm shows on a sensor of 2 cm.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace straytrace {

// What u and v are. plane: x, y across an axis [m]; polar: distance from the axis [m], angle about it [rad]; unrolled:
// along the axis, arc about it [m].
enum class Chart : std::uint8_t { plane, polar, unrolled };

struct MapPlace {
  double u = 0, v = 0;
};
struct WeightedPlace {
  MapPlace place;
  double weight = 1;  // > 0
};
struct MapCell {
  double u_low = 0, u_high = 0, v_low = 0, v_high = 0;
};
double area_of(Chart, MapCell const&);  // m^2, of the map: what is tilted to it is larger

// A rectangle of u and v that is halved again and again. The longer side is halved, in polar charts into equal areas;
// in unrolled ones, whose sides may be km and m, the side that is longer as a part of the whole.
class CellTree {
 public:
  CellTree(Chart, MapCell const& whole);
  // Halves the fullest cell, ties to the older one, until none holds more than `most_in_cell` of these places or there
  // are `most_cells`. Places count as many as equal ones of the same relative error would be, (sum w)^2 / sum w^2.
  // Cells are a function of the list alone.
  void refine(std::vector<WeightedPlace> const&, double most_in_cell, std::size_t most_cells);
  std::size_t at(MapPlace) const;  // number of the cell; places beyond the whole belong to the nearest one
  std::vector<MapCell> const& cells() const { return cells_; }

 private:
  struct Node {
    MapCell cell;
    std::uint32_t cell_number = 0, depth = 0;
    std::uint32_t halves = 0;  // number of the first half, the second follows; 0: none
    bool along_u = false;
    double at = 0;  // where it is halved
  };
  bool halve(std::uint32_t node);  // false: it is as small as cells get
  Chart chart_;
  std::vector<Node> nodes_;
  std::vector<MapCell> cells_;
};

}  // namespace straytrace
