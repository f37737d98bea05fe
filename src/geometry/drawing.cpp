// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace straytrace {
namespace {

constexpr std::uint32_t around = 48, along_curve = 8, across_ball = 16;

// Corners in `rows` + 1 rows of `columns`; a ring closes on itself. `place(u, v)` with u along, v around in [0, 1].
template <class Place>
Drawing grid(std::uint32_t rows, std::uint32_t columns, bool ring, Place const& place) {
  Drawing d;
  std::uint32_t const width = ring ? columns : columns + 1;
  for (std::uint32_t i = 0; i <= rows; ++i)
    for (std::uint32_t j = 0; j < width; ++j) d.points.push_back(place(double(i) / rows, double(j) / columns));
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j) {
      std::uint32_t const next = ring ? (j + 1) % columns : j + 1;
      std::uint32_t const a = i * width + j, b = i * width + next, c = a + width, e = b + width;
      d.triangles.push_back({a, b, c});
      d.triangles.push_back({b, e, c});
    }
  return d;
}

double area_of(Drawing const& d, std::array<std::uint32_t, 3> const& t) {
  return 0.5 * length(cross(d.points[t[1]] - d.points[t[0]], d.points[t[2]] - d.points[t[0]]));
}

// Without triangles that have collapsed, as around the pole of a disk.
Drawing cleaned(Drawing d) {
  double const least = 1e-12 * d.area() / double(std::max<std::size_t>(d.triangles.size(), 1));
  std::erase_if(d.triangles, [&](auto const& t) { return !(area_of(d, t) > least); });
  return d;
}

// Shapes whose `sample` maps the unit square onto them without a tear: its second number runs around.
template <class Shape>
Drawing by_sampling(Shape const& s, std::uint32_t rows) {
  return cleaned(grid(rows, around, true, [&](double u, double v) { return s.sample(u, v); }));
}

// Distance from the centre to a regular outline at an azimuth, m.
double reach(RegularOutline const& o, double azimuth) {
  if (o.sides == 0) return o.radius;
  double const side = 2 * pi / o.sides, x = (azimuth - o.rotation) / side;
  return o.apothem / std::cos((x - std::floor(x) - 0.5) * side);
}

}  // namespace

double Drawing::area() const {
  double sum = 0;
  for (auto const& t : triangles) sum += area_of(*this, t);
  return sum;
}

template <>
Drawing drawing_of(Disk const& s) {
  return by_sampling(s, 1);
}
template <>
Drawing drawing_of(Cap const& s) {
  return by_sampling(s, along_curve);
}
template <>
Drawing drawing_of(Cylinder const& s) {
  return by_sampling(s, 1);
}
template <>
Drawing drawing_of(Cone const& s) {
  return by_sampling(s, 1);
}
template <>
Drawing drawing_of(Sphere const& s) {
  return by_sampling(s, across_ball);
}
template <>
Drawing drawing_of(Zone const& s) {
  return by_sampling(s, across_ball);
}
template <>
Drawing drawing_of(Torus const& s) {
  Frame const f = Frame::around(s.axis);
  return grid(around / 2, around, true, [&](double u, double v) {
    double const rho = s.major_radius + s.minor_radius * std::cos(2 * pi * u);
    return s.centre + (rho * std::cos(2 * pi * v)) * f.e1 + (rho * std::sin(2 * pi * v)) * f.e2 +
           (s.minor_radius * std::sin(2 * pi * u)) * s.axis;
  });
}
template <>
Drawing drawing_of(CutCylinder const& s) {
  return by_sampling(s, 1);
}

template <>
Drawing drawing_of(Conic const& s) {
  return cleaned(grid(along_curve, around, true, [&](double u, double v) {
    double const rho = s.inner_radius + u * (s.outer_radius - s.inner_radius);
    double const x = s.decentre_x + rho * std::cos(2 * pi * v), y = s.decentre_y + rho * std::sin(2 * pi * v);
    return s.vertex + s.world({x, y, s.sag(x * x + y * y)});
  }));
}

template <>
Drawing drawing_of(Rectangle const& s) {
  if (!(s.hole_width > 0 && s.hole_height > 0))
    return grid(1, 1, false, [&](double u, double v) { return s.at((u - 0.5) * s.width, (v - 0.5) * s.height); });
  return cleaned(grid(1, 4, true, [&](double u, double v) {
    double const turn = 2 * pi * (v + 0.125), w = s.hole_width + u * (s.width - s.hole_width),
                 h = s.hole_height + u * (s.height - s.hole_height);
    return s.at(std::copysign(0.5 * w, std::cos(turn)), std::copysign(0.5 * h, std::sin(turn)));
  }));
}

template <>
Drawing drawing_of(Ellipse const& s) {
  return cleaned(grid(1, around, true, [&](double u, double v) {
    double const x = s.hole_x + u * (s.semi_x - s.hole_x), y = s.hole_y + u * (s.semi_y - s.hole_y);
    return s.at(x * std::cos(2 * pi * v), y * std::sin(2 * pi * v));
  }));
}

template <>
Drawing drawing_of(Polygon const& s) {
  std::vector<double> azimuths;  // of all corners: between them both outlines are straight
  for (RegularOutline const& o : {s.outline(), s.hole()}) {
    double const corners = o.sides == 0 ? around : o.sides;
    for (double k = 0; k < corners && o.radius > 0; ++k) {
      double const turn = o.rotation / (2 * pi) + k / corners;
      azimuths.push_back(2 * pi * (turn - std::floor(turn)));
    }
  }
  std::sort(azimuths.begin(), azimuths.end());
  auto const columns = std::uint32_t(azimuths.size());
  return cleaned(grid(1, columns, true, [&](double u, double v) {
    double const a = azimuths[std::uint32_t(std::lround(v * columns)) % columns];
    double const inner = s.hole_radius > 0 ? reach(s.hole(), a) : 0, rho = u > 0 ? reach(s.outline(), a) : inner;
    return s.at(rho * std::cos(a), rho * std::sin(a));
  }));
}

template <>
Drawing drawing_of(Cuboid const& s) {
  Drawing d;
  Vec3 const e[3] = {s.width * s.e1, s.height * s.e2, s.depth * s.axis};
  for (int i = 0; i < 3; ++i)
    for (double const side : {-0.5, 0.5}) {
      auto const first = std::uint32_t(d.points.size());
      for (double const x : {-0.5, 0.5})
        for (double const y : {-0.5, 0.5})
          d.points.push_back(s.centre + side * e[i] + x * e[(i + 1) % 3] + y * e[(i + 2) % 3]);
      d.triangles.push_back({first, first + 1, first + 2});
      d.triangles.push_back({first + 1, first + 3, first + 2});
    }
  return d;
}

template <>
Drawing drawing_of(PiercedCylinder const& s) {  // cells of a sixth of the holes' radius at their height
  constexpr std::uint32_t rows = 14;
  double const low = std::max(s.from, s.hole_height - s.hole_radius), cell = s.hole_radius / 6;
  double const high = std::min(s.to, s.hole_height + s.hole_radius);
  auto const columns = std::uint32_t(std::clamp(std::ceil(2 * pi * s.radius / cell), 48.0, 480.0));
  Drawing d = grid(rows, columns, true, [&](double u, double v) {
    double const part = (u * rows - 1) / (rows - 2), z = u == 0 ? s.from : u == 1 ? s.to : low + part * (high - low);
    return s.origin + z * s.axis + (s.radius * std::cos(2 * pi * v)) * s.e1 + (s.radius * std::sin(2 * pi * v)) * s.e2;
  });
  std::erase_if(d.triangles, [&](auto const& t) {
    Vec3 const middle = (1.0 / 3) * (d.points[t[0]] + d.points[t[1]] + d.points[t[2]]) - s.origin;
    double const z = dot(middle, s.axis);
    return s.in_hole(middle - z * s.axis, z);
  });
  return cleaned(std::move(d));
}

template <>
Drawing drawing_of(SerratedCone const& s) {
  auto const flanks = std::uint32_t(std::lround(2 * s.teeth));
  std::uint32_t const steps = std::max(1u, 2 * around / flanks), columns = flanks * steps;
  return cleaned(grid(1, columns, true, [&](double u, double v) {
    double const a = 2 * pi * v + s.phase, x = std::cos(a), y = std::sin(a),
                 half = std::fabs(std::remainder(v * s.teeth, 1));
    double const edge = s.inner_radius + 2 * half * s.tooth_depth;
    double const rho = u > 0 ? s.outer_radius : edge;
    return s.apex + (rho * s.cosine / s.sine) * s.axis + (rho * x) * s.e1 + (rho * y) * s.e2;
  }));
}

template <>
Drawing drawing_of(TriangleMesh const& s) {
  Drawing d;
  for (std::size_t i = 0; i < s.content.vertices.size; ++i)
    d.points.push_back(s.pose.point(s.unit * exact(s.content.vertices[i])));
  for (std::size_t i = 0; i < s.content.triangles.size; ++i) {
    auto const& corner = s.content.triangles[i].corner;
    d.triangles.push_back({corner[0], corner[1], corner[2]});
  }
  return d;
}

// Faces of CAD files as triangles: their chart is cut into slabs in which no edge of a loop begins or ends, and each
// slab into the trapezoids between its edges.

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
