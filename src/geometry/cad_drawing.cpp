// SPDX-License-Identifier: BSD-3-Clause
// Faces of CAD files as triangles: their chart is cut into slabs in which no edge of a loop begins or ends, and each
// slab into the trapezoids between its edges.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "geometry/drawing.hpp"

namespace straytrace {
namespace {

constexpr double points_per_turn = 48;
constexpr int levels_of_arc = 12, levels_of_bend = 12;

bool before(OutlineEdge const& a, OutlineEdge const& b) {
  return std::tie(a.low, a.high, a.turn, a.side, a.x, a.y, a.slope) <
         std::tie(b.low, b.high, b.turn, b.side, b.x, b.y, b.slope);
}

std::vector<OutlineEdge> edges_of(CadOutline const& outline) {  // each once
  std::vector<OutlineEdge> all(outline.edges.data, outline.edges.data + outline.edges.size);
  std::sort(all.begin(), all.end(), before);
  auto const same = [](auto const& a, auto const& b) { return !before(a, b) && !before(b, a); };
  all.erase(std::unique(all.begin(), all.end(), same), all.end());
  return all;
}

std::vector<double> levels_of(CadFace const& s, std::vector<OutlineEdge> const& edges) {
  std::vector<double> all;
  auto const add = [&](double low, double high, int parts) {
    for (int i = 0; i <= parts; ++i) all.push_back(low + (high - low) * i / parts);
  };
  for (OutlineEdge const& e : edges) add(e.low, e.high, e.side == 0 ? 1 : levels_of_arc);
  if (s.carrier != Carrier::plane) add(s.outline.low_y, s.outline.high_y, levels_of_bend);
  std::sort(all.begin(), all.end());
  double const least = 1e-12 * (s.outline.high_y - s.outline.low_y);
  all.erase(std::unique(all.begin(), all.end(), [&](double a, double b) { return b - a <= least; }), all.end());
  return all;
}

void add_trapezoid(CadFace const& s, OutlineEdge const& left, OutlineEdge const& right, double y0, double y1,
                   Drawing& d) {
  double const widest = std::max(right.x_at(y0) - left.x_at(y0), right.x_at(y1) - left.x_at(y1));
  int const columns = s.carrier == Carrier::plane ? 1 : std::max(1, int(std::ceil(widest * points_per_turn)));
  auto const first = std::uint32_t(d.points.size());
  for (int i = 0; i <= columns; ++i)
    for (double const y : {y0, y1}) {
      double const from = left.x_at(y), to = right.x_at(y);
      d.points.push_back(s.at(from + (to - from) * i / columns, y));
    }
  for (std::uint32_t i = 0; i < std::uint32_t(columns); ++i) {
    std::uint32_t const a = first + 2 * i;
    d.triangles.push_back({a, a + 2, a + 1});
    d.triangles.push_back({a + 1, a + 2, a + 3});
  }
}

}  // namespace

template <>
Drawing drawing_of(CadFace const& s) {
  Drawing d;
  std::vector<OutlineEdge> const edges = edges_of(s.outline);
  std::vector<double> const levels = levels_of(s, edges);
  for (std::size_t i = 0; i + 1 < levels.size(); ++i) {
    double const middle = 0.5 * (levels[i] + levels[i + 1]);
    std::vector<OutlineEdge> here;
    for (OutlineEdge const& e : edges)
      if (e.low <= middle && middle < e.high) here.push_back(e);
    std::sort(here.begin(), here.end(), [&](auto const& a, auto const& b) { return a.x_at(middle) < b.x_at(middle); });
    double winding = 0;  // of what lies to the right of an edge
    for (std::size_t k = here.size(); k-- > 1;) {
      winding += here[k].turn;
      if (winding != 0) add_trapezoid(s, here[k - 1], here[k], levels[i], levels[i + 1], d);
    }
  }
  return d;
}

}  // namespace straytrace
