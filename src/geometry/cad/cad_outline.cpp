// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/cad/cad_outline.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace straytrace {
namespace {

constexpr std::size_t most_bands = 1024;

struct Bounds {
  double low_x = infinity, high_x = -infinity, low_y = infinity, high_y = -infinity;
  void add(double x, double y) {
    low_x = std::fmin(low_x, x);
    high_x = std::fmax(high_x, x);
    low_y = std::fmin(low_y, y);
    high_y = std::fmax(high_y, y);
  }
};

// Cuts loops into edges.
struct Cutter {
  std::vector<OutlineEdge> edges;
  Bounds bounds;
  double area = 0;

  void add(ChartLoop const& loop) {
    ChartCorner const o = loop[0];  // areas are summed about it, for precision
    for (std::size_t i = 0; i < loop.size(); ++i) {
      ChartCorner const p = loop[i], q = loop[(i + 1) % loop.size()];
      bounds.add(p.x, p.y);
      area += 0.5 * ((p.x - o.x) * (q.y - o.y) - (q.x - o.x) * (p.y - o.y));
      if (p.bulge == 0)
        straight(p, q);
      else
        arc(p, q);
    }
  }

 private:
  void straight(ChartCorner from, ChartCorner to) {
    if (from.y == to.y) return;
    bool const up = from.y < to.y;
    ChartCorner const low = up ? from : to, high = up ? to : from;
    edges.push_back({low.y, high.y, up ? 1.0 : -1.0, 0, low.x, low.y, (high.x - low.x) / (high.y - low.y)});
  }
  // The centre lies (1 - b^2)/(4 b) chords to the left of the middle of the chord.
  void arc(ChartCorner from, ChartCorner to) {
    double const dx = to.x - from.x, dy = to.y - from.y, lift = (1 - from.bulge * from.bulge) / (4 * from.bulge);
    double const cx = 0.5 * (from.x + to.x) - lift * dy, cy = 0.5 * (from.y + to.y) + lift * dx;
    double const square = (dx * dx + dy * dy) * (0.25 + lift * lift), r = std::sqrt(square);
    double const angle = 4 * std::atan(from.bulge), start = std::atan2(from.y - cy, from.x - cx);
    area += 0.5 * square * (angle - std::sin(angle));
    double const way = angle > 0 ? 1 : -1;
    double y = from.y, at = start;
    for (;;) {  // quarter by quarter
      double const step = std::floor(way * at / (pi / 2) + 1e-12) + 1, next = way * step * (pi / 2);
      bool const last = way * next >= way * (start + angle) - 1e-12;
      double const end = last ? start + angle : next, end_y = last ? to.y : cy + r * std::sin(next);
      double const middle = 0.5 * (at + end);
      if (!last) bounds.add(cx + r * std::cos(next), end_y);
      if (y != end_y)
        edges.push_back({std::fmin(y, end_y), std::fmax(y, end_y), y < end_y ? 1.0 : -1.0,
                         std::cos(middle) > 0 ? 1.0 : -1.0, cx, cy, square});
      if (last) return;
      y = end_y;
      at = end;
    }
  }
};

// As of meshes: two sums of different mixers over all numbers, in order.
void digest(CadOutline& out, std::vector<ChartLoop> const& loops) {
  std::uint64_t a = loops.size(), b = 1;
  for (ChartLoop const& loop : loops)
    for (ChartCorner const& p : loop)
      for (double number : {p.x, p.y, p.bulge}) {
        auto const x = std::bit_cast<std::uint64_t>(number);
        a = (a ^ x) * 0x9e3779b97f4a7c15ull;
        a ^= a >> 32;
        b = (b + x) * 0xbf58476d1ce4e5b9ull;
        b ^= b >> 29;
      }
  out.digest[0] = a;
  out.digest[1] = b;
}

}  // namespace

CadOutline prepare_outline(std::vector<ChartLoop> const& loops, Storage& storage) {
  CadOutline out;
  Cutter cutter;
  for (ChartLoop const& loop : loops) cutter.add(loop);
  out.low_x = cutter.bounds.low_x;
  out.high_x = cutter.bounds.high_x;
  out.low_y = cutter.bounds.low_y;
  out.high_y = cutter.bounds.high_y;
  out.area = cutter.area;
  digest(out, loops);
  std::vector<OutlineEdge> const& edges = cutter.edges;
  std::size_t const bands = std::clamp<std::size_t>(edges.size() / 2, 1, most_bands);
  out.bands_per_y = double(bands) / (out.high_y - out.low_y);
  std::vector<std::uint32_t> start(bands + 1);
  out.band_start = {start.data(), start.size()};
  for (OutlineEdge const& e : edges)
    for (std::uint32_t b = out.band_of(e.low); b <= out.band_of(e.high); ++b) ++start[b + 1];
  for (std::size_t b = 0; b < bands; ++b) start[b + 1] += start[b];
  std::vector<OutlineEdge> sorted(start.back());
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (OutlineEdge const& e : edges)
    for (std::uint32_t b = out.band_of(e.low); b <= out.band_of(e.high); ++b) sorted[next[b]++] = e;
  out.band_start = storage.keep(std::move(start));
  out.edges = storage.keep_large(std::move(sorted));
  return out;
}

}  // namespace straytrace
