// SPDX-License-Identifier: BSD-3-Clause
#include "world/cad_shapes.hpp"

#include <cmath>

namespace straytrace {
namespace {

Pose about(Pose const& p, Vec3 origin, bool turned) {  // turned: by half a turn about e1
  return turned ? Pose{origin, p.e1, -p.e2, -p.e3} : Pose{origin, p.e1, p.e2, p.e3};
}

// Factors of the coordinates of the chart when lengths grow by `s`.
ChartCorner chart_scale(Carrier carrier, double s) {
  switch (carrier) {
    case Carrier::plane:
      return {s, s};
    case Carrier::cone:
      return {1, s * s};
    case Carrier::torus:
      return {1, 1};
    default:
      return {1, s};
  }
}

PlacedCadShape trimmed(CadFileFace const& f, std::vector<ChartLoop> loops, double scale, Storage& storage) {
  ChartCorner const by = chart_scale(f.carrier, scale);
  for (ChartLoop& loop : loops)
    for (ChartCorner& c : loop) c = {c.x * by.x, c.y * by.y, c.bulge};
  CadFace face;
  face.carrier = f.carrier;
  face.radius = f.radius * scale;
  face.second = f.carrier == Carrier::torus ? f.second * scale : f.second;
  face.sense = f.flipped ? -1 : 1;
  face.outline = prepare_outline(loops, storage);
  return {face, about(f.frame, scale * f.frame.origin, false)};
}

// Natural bounds of a face that looks inwards, as a window of its chart.
std::vector<ChartLoop> window(CadFileFace const& f) {
  double low = f.from, high = f.to;
  if (f.carrier == Carrier::cone) {
    low *= f.from;
    high *= f.to;
  } else if (f.carrier == Carrier::torus) {
    low = 0;
    high = 1;
  }
  return {{{0, low}, {1, low}, {1, high}, {0, high}}};
}

PlacedCadShape natural_sphere(CadFileFace const& f, double s, Storage& storage) {
  double const r = f.radius;
  bool const upper = f.to >= r, lower = f.from <= -r;
  double const rim = upper ? f.from : -f.to;  // height of the rim towards the pole
  if (upper != lower && rim > 1e-3 * r) {
    Cap cap;
    cap.curvature = (f.flipped ? 1 : -1) / (s * r);
    cap.outer_radius = s * std::sqrt((r - rim) * (r + rim));
    Vec3 const vertex = s * (f.frame.origin + (upper ? r : -r) * f.frame.e3);
    return {cap, about(f.frame, vertex, upper == f.flipped)};
  }
  if (f.flipped) return trimmed(f, window(f), s, storage);
  Pose const here = about(f.frame, s * f.frame.origin, false);
  if (upper && lower) {
    Sphere sphere;
    sphere.radius = s * r;
    return {sphere, here};
  }
  Zone zone;
  zone.radius = s * r;
  zone.from = s * f.from;
  zone.to = s * f.to;
  return {zone, here};
}

}  // namespace

PlacedCadShape cad_shape(CadFileFace const& f, double s, Storage& storage) {
  if (!f.natural) return trimmed(f, f.loops, s, storage);
  if (f.carrier == Carrier::plane) {
    Disk disk;
    disk.inner_radius = s * f.from;
    disk.outer_radius = s * f.to;
    return {disk, about(f.frame, s * f.frame.origin, f.flipped)};
  }
  if (f.carrier == Carrier::sphere) return natural_sphere(f, s, storage);
  if (f.flipped) return trimmed(f, window(f), s, storage);
  Pose const here = about(f.frame, s * f.frame.origin, false);
  if (f.carrier == Carrier::cylinder) {
    Cylinder c;
    c.radius = s * f.radius;
    c.from = s * f.from;
    c.to = s * f.to;
    return {c, here};
  }
  if (f.carrier == Carrier::torus) {
    Torus t;
    t.major_radius = s * f.radius;
    t.minor_radius = s * f.second;
    return {t, here};
  }
  Cone c;
  c.inner_radius = s * f.from;
  c.outer_radius = s * f.to;
  c.half_angle = f.second;
  return {c, about(f.frame, s * f.frame.origin + (s * f.from / std::tan(f.second)) * f.frame.e3, false)};
}

}  // namespace straytrace
