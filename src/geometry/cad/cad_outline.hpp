// SPDX-License-Identifier: BSD-3-Clause
// Closed loops of straight edges and arcs in a plane, and which points they go around. The plane is the chart of a CAD
// face (cad_face.hpp), in which its trimming is drawn.
#pragma once

#include <vector>

#include "base/math/vec3.hpp"
#include "base/memory/storage.hpp"

namespace straytrace {

// Corner of a loop, and how it goes on to the next: straight, or along an arc that turns by 4 atan(bulge), against the
// clock when positive; |bulge| <= 1.
struct ChartCorner {
  double x = 0, y = 0, bulge = 0;
};
using ChartLoop = std::vector<ChartCorner>;  // closed: the last corner is joined to the first; the face is on its left

// A piece of a loop along which y only rises or only falls.
struct OutlineEdge {
  double low, high;  // y of its ends
  double turn;       // 1: the loop runs upwards here, -1: downwards
  double side;       // 0: straight; 1, -1: right or left half of a circle
  double x, y;       // the lower end, or the centre of the circle
  double slope;      // dx/dy, or the squared radius of the circle

  STRAY_HD double x_at(double height) const {
    double const dy = height - y;
    return side == 0 ? x + dy * slope : x + side * std::sqrt(std::fmax(0.0, slope - dy * dy));
  }
};

// A point is within when the loops go around it (winding number not zero), so loops may overlap themselves at corners.
struct CadOutline {
  View<OutlineEdge const> edges;         // band by band, an edge in every band that it crosses
  View<std::uint32_t const> band_start;  // of bands of equal height; one more than there are bands
  double low_x = 0, high_x = 0, low_y = 0, high_y = 0;
  double bands_per_y = 0;
  double area = 0;               // within, in units of the chart
  std::uint64_t digest[2] = {};  // of all loops

  STRAY_HD bool holds(double x, double y) const {
    if (!(y >= low_y && y < high_y && x >= low_x && x <= high_x)) return false;
    std::uint32_t const band = band_of(y);
    double winding = 0;
    for (std::uint32_t i = band_start[band]; i < band_start[band + 1]; ++i) {
      OutlineEdge const e = edges[i];
      if (y >= e.low && y < e.high && x < e.x_at(y)) winding += e.turn;
    }
    return winding != 0;
  }
  STRAY_HD std::uint32_t band_of(double y) const {  // rises with y
    double const last = double(band_start.size - 2), band = std::floor((y - low_y) * bands_per_y);
    return std::uint32_t(band < last ? band : last);
  }
};

// Loops with a positive sum of their areas; arcs only in the charts of planes.
CadOutline prepare_outline(std::vector<ChartLoop> const& loops, Storage& storage);

}  // namespace straytrace
