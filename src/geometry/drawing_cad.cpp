// SPDX-License-Identifier: BSD-3-Clause
// CAD faces as triangles: the chart is cut into level strips between corners, each strip into what the loops go around.
#include <algorithm>
#include <cmath>

#include "geometry/drawing.hpp"

namespace straytrace {
namespace {

constexpr double columns = 48;  // of a full turn
constexpr int arc_levels = 20;  // of half a circle

// Heights at which strips end.
std::vector<double> levels_of(CadFace const& face) {
  CadOutline const& o = face.outline;
  std::vector<double> y = {o.low_y, o.high_y};
  for (std::size_t i = 0; i < o.edges.size; ++i) {
    OutlineEdge const& e = o.edges[i];
    y.push_back(e.low);
    y.push_back(e.high);
    for (int k = 1; k < arc_levels && e.side != 0; ++k)
      y.push_back(e.y - std::sqrt(e.slope) * std::cos(pi * k / arc_levels));
  }
  double const span = o.high_y - o.low_y, curved = face.carrier == Carrier::sphere  ? face.radius / 8
                                                   : face.carrier == Carrier::torus ? 1.0 / 24
                                                                                    : span;
  double const step = face.carrier == Carrier::plane ? span : std::fmin(curved, span / 8);  // oblique edges bend too
  for (double at = o.low_y + step; at < o.high_y; at += step) y.push_back(at);
  std::erase_if(y, [&](double at) { return at < o.low_y || at > o.high_y; });
  std::sort(y.begin(), y.end());
  auto const close = [&](double a, double b) { return b - a < 1e-9 * span; };
  y.erase(std::unique(y.begin(), y.end(), close), y.end());
  return y;
}

void add_cell(CadFace const& face, double x0, double x1, double y0, double x2, double x3, double y1, Drawing& d) {
  auto const n = std::uint32_t(d.points.size());
  for (auto const& [x, y] : {std::pair{x0, y0}, {x1, y0}, {x3, y1}, {x2, y1}}) d.points.push_back(face.at(x, y));
  bool const front = face.sense > 0;
  d.triangles.push_back(front ? std::array{n, n + 1, n + 2} : std::array{n, n + 2, n + 1});
  d.triangles.push_back(front ? std::array{n, n + 2, n + 3} : std::array{n, n + 3, n + 2});
}

void add_strip(CadFace const& face, double low, double high, Drawing& d) {
  CadOutline const& o = face.outline;
  double const middle = 0.5 * (low + high);
  std::vector<OutlineEdge> across;
  std::uint32_t const band = o.band_of(middle);
  for (std::uint32_t i = o.band_start[band]; i < o.band_start[band + 1]; ++i)
    if (middle >= o.edges[i].low && middle < o.edges[i].high) across.push_back(o.edges[i]);
  std::sort(across.begin(), across.end(),
            [&](OutlineEdge const& a, OutlineEdge const& b) { return a.x_at(middle) < b.x_at(middle); });
  double winding = 0;
  for (std::size_t i = 0; i + 1 < across.size(); ++i) {
    winding += across[i].turn;
    if (winding == 0) continue;
    double const a = across[i].x_at(low), b = across[i + 1].x_at(low), c = across[i].x_at(high),
                 e = across[i + 1].x_at(high);
    double const width = std::fmax(b - a, e - c);
    double const parts = face.carrier == Carrier::plane ? 1 : std::fmax(1, std::ceil(width * columns));
    for (double k = 0; k < parts; ++k)
      add_cell(face, a + (b - a) * k / parts, a + (b - a) * (k + 1) / parts, low, c + (e - c) * k / parts,
               c + (e - c) * (k + 1) / parts, high, d);
  }
}

}  // namespace

template <>
Drawing drawing_of(CadFace const& face) {
  Drawing d;
  std::vector<double> const y = levels_of(face);
  for (std::size_t i = 0; i + 1 < y.size(); ++i) add_strip(face, y[i], y[i + 1], d);
  return d;
}

}  // namespace straytrace
