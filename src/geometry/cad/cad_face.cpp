// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/cad/cad_face.hpp"

#include <algorithm>
#include <cmath>

namespace straytrace {
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

// Of a surface of revolution between two values of y.
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

// Of what lies between two azimuths (turns).
Box sector(Profile const& p, double from, double to) {
  Range const c = cosine_range(from, to), s = cosine_range(from - 0.25, to - 0.25);
  auto const lowest = [&](double x) { return x < 0 ? x * p.rho.high : x * p.rho.low; };
  auto const highest = [&](double x) { return x > 0 ? x * p.rho.high : x * p.rho.low; };
  return {{lowest(c.low), lowest(s.low), p.z.low}, {highest(c.high), highest(s.high), p.z.high}};
}

// Between which x the loops lie where y is in [low, high].
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

}  // namespace straytrace
