// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/cad/cad_face.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

#include "geometry/drawing.hpp"

namespace straytrace::geometry {
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

// As for meshes: two sums of different mixers over all numbers, in order.
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

namespace {

struct Range {
  double low = infinity, high = -infinity;
  void add(double x) {
    low = std::fmin(low, x);
    high = std::fmax(high, x);
  }
};

// Of cos(2 pi t) for t in [from, to].
Range cosine_range(double from, double to) {
  Range r;
  r.add(sincos_turn(from).cos);
  r.add(sincos_turn(to).cos);
  for (double extreme = std::ceil(2 * from); extreme <= 2 * to; ++extreme)
    r.add(std::fmod(std::fabs(extreme), 2) == 0 ? 1 : -1);
  return r;
}

struct Profile {
  Range z, rho;  // heights along e3 and distances from it
};

// Profile of a surface of revolution between two values of y.
Profile profile(CadFace const& f, double low, double high) {
  double const r = f.radius;
  Range z{low, high}, rho{r, r};
  if (f.carrier == Carrier::cone) {
    rho = {std::sqrt(std::fmax(0.0, low)), std::sqrt(std::fmax(0.0, high))};
    z = {rho.low * f.cosine / f.sine, rho.high * f.cosine / f.sine};
  } else if (f.carrier == Carrier::sphere) {
    z = {std::fmax(low, -r), std::fmin(high, r)};
    rho = {};
    rho.add(std::sqrt(std::fmax(0.0, (r - z.low) * (r + z.low))));
    rho.add(std::sqrt(std::fmax(0.0, (r - z.high) * (r + z.high))));
    if (z.low < 0 && z.high > 0) rho.add(r);
  } else if (f.carrier == Carrier::torus) {
    double const from = f.tube_turn(low), to = f.tube_turn(high);
    Range const c = cosine_range(from, to), s = cosine_range(from - 0.25, to - 0.25);
    rho = {r + f.second * c.low, r + f.second * c.high};
    z = {f.second * s.low, f.second * s.high};
  }
  return {z, rho};
}

void add_corners(Box& box, Pose const& pose, Box const& local) {
  for (int i = 0; i < 8; ++i)
    box.add(pose.point({(i & 1 ? local.upper : local.lower).x, (i & 2 ? local.upper : local.lower).y,
                        (i & 4 ? local.upper : local.lower).z}));
}

// Box of the part between two azimuths (turns).
Box sector(Profile const& p, double from, double to) {
  Range const c = cosine_range(from, to), s = cosine_range(from - 0.25, to - 0.25);
  auto const lowest = [&](double x) { return x < 0 ? x * p.rho.high : x * p.rho.low; };
  auto const highest = [&](double x) { return x > 0 ? x * p.rho.high : x * p.rho.low; };
  return {{lowest(c.low), lowest(s.low), p.z.low}, {highest(c.high), highest(s.high), p.z.high}};
}

// Range of x of the loops where y is in [low, high].
Range span(CadOutline const& outline, double low, double high) {
  Range x;
  for (std::size_t i = 0; i < outline.edges.size; ++i) {
    OutlineEdge const& e = outline.edges[i];
    double const from = std::fmax(low, e.low), to = std::fmin(high, e.high);
    if (!(from <= to)) continue;
    x.add(e.x_at(from));
    x.add(e.x_at(to));
    if (e.side != 0 && from <= e.y && e.y <= to) x.add(e.x_at(e.y));
  }
  return x;
}

Box box_of(CadFace const& f) {
  constexpr int strips = 16, sectors = 8;
  CadOutline const& o = f.outline;
  double const height = (o.high_y - o.low_y) / strips;
  Box box;
  for (int i = 0; i < strips; ++i) {
    double const low = o.low_y + i * height, high = low + height;
    Range const x = span(o, low, high);
    if (!(x.low <= x.high)) continue;
    if (f.carrier == Carrier::plane) {
      add_corners(box, f.pose, {{x.low, low, 0}, {x.high, high, 0}});
      continue;
    }
    Profile const p = profile(f, low, high);
    double const width = (x.high - x.low) / sectors;
    for (int k = 0; k < sectors; ++k) add_corners(box, f.pose, sector(p, x.low + k * width, x.low + (k + 1) * width));
  }
  return box;
}

}  // namespace

void CadFace::place(Pose const& where) {
  pose = where;
  axis = where.e3;
  SinCos const a = sincos_turn(second / (2 * pi));
  sine = carrier == Carrier::cone ? a.sin : 0;
  cosine = carrier == Carrier::cone ? a.cos : 1;
  Profile p{{0, 0}, {0, 0}};
  if (carrier == Carrier::plane)
    p.rho.high = std::hypot(std::fmax(std::fabs(outline.low_x), std::fabs(outline.high_x)),
                            std::fmax(std::fabs(outline.low_y), std::fabs(outline.high_y)));
  else
    p = profile(*this, outline.low_y, outline.high_y);
  low = p.z.low;
  high = p.z.high;
  near = p.rho.low;
  far = p.rho.high;
  box = box_of(*this);
  double const r = 0x1p-50 * (length(pose.origin) + far + std::fmax(std::fabs(low), std::fabs(high)));  // of rounding
  Vec3 const pad{r, r, r};
  box = {box.lower - pad, box.upper + pad};
}

SurfaceCurvature CadFace::curvature_at(Vec3 p) const {
  SurfaceCurvature const k = with_carrier([p](auto const& c) { return curvature_of(c, p, 0); });
  return sense > 0 ? k : k.from_behind();
}

// Triangulates CAD faces. Cuts the chart at the ends of all edges into slabs, and each slab into the trapezoids between
// its edges.

namespace {

constexpr double points_per_turn = 48;
constexpr int levels_of_arc = 12, levels_of_bend = 12;

bool comes_before(OutlineEdge const& a, OutlineEdge const& b) {
  return std::tie(a.low, a.high, a.turn, a.side, a.x, a.y, a.slope) <
         std::tie(b.low, b.high, b.turn, b.side, b.x, b.y, b.slope);
}

std::vector<OutlineEdge> edges_of(CadOutline const& outline) {  // each once
  std::vector<OutlineEdge> all(outline.edges.data, outline.edges.data + outline.edges.size);
  std::ranges::sort(all, comes_before);
  auto const same = [](auto const& a, auto const& b) { return !comes_before(a, b) && !comes_before(b, a); };
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
  std::ranges::sort(all);
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

Drawing CadFace::drawing() const {
  Drawing d;
  std::vector<OutlineEdge> const edges = edges_of(outline);
  std::vector<double> const levels = levels_of(*this, edges);
  for (std::size_t i = 0; i + 1 < levels.size(); ++i) {
    double const middle = 0.5 * (levels[i] + levels[i + 1]);
    std::vector<OutlineEdge> here;
    for (OutlineEdge const& e : edges)
      if (e.low <= middle && middle < e.high) here.push_back(e);
    std::ranges::sort(here, [&](auto const& a, auto const& b) { return a.x_at(middle) < b.x_at(middle); });
    double winding = 0;  // of what lies to the right of an edge
    for (std::size_t k = here.size(); k-- > 1;) {
      winding += here[k].turn;
      if (winding != 0) add_trapezoid(*this, here[k - 1], here[k], levels[i], levels[i + 1], d);
    }
  }
  return d;
}

}  // namespace straytrace::geometry
