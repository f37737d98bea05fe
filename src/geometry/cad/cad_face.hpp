// SPDX-License-Identifier: BSD-3-Clause
// A face of a CAD file: the part of a plane, cylinder, cone, sphere or torus that lies within loops. Hits and normals
// are those of the exact surface; the loops are polygons in its chart, where equal areas are equal areas of surface:
//   plane     x, y                     m, m        along e1 and e2
//   cylinder  azimuth, height          turns, m    azimuth from e1 towards e2, about e3
//   cone      azimuth, radius^2        turns, m^2  the axis e3 points from the apex into the cone
//   sphere    azimuth, height          turns, m
//   torus     azimuth, s               turns, 1    s = w + (r/R) sin(2 pi w)/(2 pi), w turns around the tube from the
//                                                  outer equator towards e3
// Page: docs/reference/shapes/cad_face.md.
#pragma once

#include <vector>

#include "base/memory/storage.hpp"
#include "geometry/shapes/cone.hpp"
#include "geometry/shapes/cylinder.hpp"
#include "geometry/shapes/flat.hpp"
#include "geometry/shapes/shape.hpp"
#include "geometry/shapes/sphere.hpp"
#include "geometry/shapes/torus.hpp"

namespace straytrace::geometry {

// Corner of a loop, and the edge to the next: straight, or an arc that turns by 4 atan(bulge), counter-clockwise when
// positive; |bulge| <= 1.
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

enum class Carrier : std::uint8_t { plane, cylinder, cone, sphere, torus };

struct CadFace {
  static constexpr char const* key = "cad_face";
  static constexpr bool hides_itself = true;  // on a torus
  SurfaceCurvature curvature_at(Vec3 p) const;
  Drawing drawing() const;

  Carrier carrier = Carrier::plane;
  Pose pose;           // origin: centre, apex of a cone, a point of the axis of a cylinder
  Vec3 axis{0, 0, 1};  // e3 of the pose
  double radius = 0;   // m: of cylinder and sphere, of the ring of a torus
  double second = 0;   // tube radius of a torus, m; half angle of a cone, rad
  double sense = 1;    // 1: the normal is that of the carrier, -1: against it
  CadOutline outline;
  double sine = 0, cosine = 1;                  // of the half angle, set by place()
  double low = 0, high = 0, near = 0, far = 0;  // heights along e3, distances from it, set by place()
  Box box;                                      // in the world, set by place()

  void place(Pose const& where);  // where the carrier lies in the world

  STRAY_HD PlaneFrame plane() const { return {pose.origin, pose.e1, pose.e2, axis}; }
  STRAY_HD Cylinder cylinder() const { return {pose.origin, axis, radius, low, high}; }
  STRAY_HD Cone cone() const { return {pose.origin, axis, 0, far, second, sine, cosine, pose.origin}; }
  STRAY_HD Sphere sphere() const { return {pose.origin, axis, radius}; }
  STRAY_HD Torus torus() const { return {pose.origin, axis, radius, second}; }
  // Calls f with the whole surface that the face is a part of.
  template <class F>
  STRAY_HD auto with_carrier(F const& f) const {
    switch (carrier) {
      case Carrier::plane:
        break;
      case Carrier::cylinder:
        return f(cylinder());
      case Carrier::cone:
        return f(cone());
      case Carrier::sphere:
        return f(sphere());
      case Carrier::torus:
        return f(torus());
    }
    return f(plane());
  }

  // Turns about e3 of a vector from the origin, as the loops count them.
  STRAY_HD double azimuth(Vec3 o) const { return wrapped(turn_of(dot(o, pose.e1), dot(o, pose.e2)), outline.low_x); }
  STRAY_HD static double wrapped(double turns, double low) { return turns - std::floor(turns - low); }
  STRAY_HD double torus_share(double w) const { return w + second / radius * sincos_turn(w).sin / (2 * pi); }

  STRAY_HD double distance(Ray const& r, bool leaving) const {
    switch (carrier) {
      case Carrier::plane:
        return plane().meet(r, leaving, [this](double x, double y) { return outline.holds(x, y); });
      case Carrier::cylinder:
        return cylinder().first(r, leaving, [this](Vec3 o, double z) { return outline.holds(azimuth(o), z); });
      case Carrier::cone:
        return cone().first(r, leaving, [this](Vec3 o) { return outline.holds(azimuth(o), length2(o)); });
      case Carrier::sphere:
        return sphere().first(r, leaving, [this](Vec3 o) { return outline.holds(azimuth(o), dot(o, axis)); });
      case Carrier::torus:
        return torus().first(r, leaving, [this](Vec3 o) { return outline.holds(azimuth(o), around_tube(o)); });
    }
    return infinity;
  }
  STRAY_HD double around_tube(Vec3 o) const {
    double const z = dot(o, axis);
    return wrapped(torus_share(turn_of(length(o - z * axis) - radius, z)), outline.low_y);
  }
  // e3, away from the axis, out of sphere or tube; against these for sense -1.
  STRAY_HD Vec3 normal(Vec3 p) const {
    return sense * with_carrier([p](auto const& c) { return c.normal(p); });
  }
  STRAY_HD Vec3 project(Vec3 p) const {
    return with_carrier([p](auto const& c) { return c.project(p); });
  }
  STRAY_HD double area() const { return outline.area * area_per_chart(); }
  STRAY_HD double area_per_chart() const {
    switch (carrier) {
      case Carrier::plane:
        return 1;
      case Carrier::cylinder:
        return 2 * pi * radius;
      case Carrier::cone:
        return pi / sine;
      case Carrier::sphere:
        return 2 * pi * radius;
      case Carrier::torus:
        return 4 * pi * pi * radius * second;
    }
    return 0;
  }
  STRAY_HD Vec3 sample(double u, double v) const {  // even in the box of the loops, until it falls within them
    Redraw more(u, v);
    for (;;) {
      double const x = outline.low_x + u * (outline.high_x - outline.low_x);
      double const y = outline.low_y + v * (outline.high_y - outline.low_y);
      if (outline.holds(x, y)) return at(x, y);
      u = more.next();
      v = more.next();
    }
  }
  // The point of the surface at a place of the chart.
  STRAY_HD Vec3 at(double x, double y) const {
    if (carrier == Carrier::plane) return plane().at(x, y);
    double rho = radius, z = y;
    if (carrier == Carrier::cone) {
      rho = std::sqrt(std::fmax(0.0, y));
      z = rho * cosine / sine;
    } else if (carrier == Carrier::sphere) {
      rho = std::sqrt(std::fmax(0.0, (radius - y) * (radius + y)));
    } else if (carrier == Carrier::torus) {
      SinCos const tube = sincos_turn(tube_turn(y));
      rho = radius + second * tube.cos;
      z = second * tube.sin;
    }
    SinCos const a = sincos_turn(x);
    return pose.origin + z * axis + (rho * a.cos) * pose.e1 + (rho * a.sin) * pose.e2;
  }
  STRAY_HD double tube_turn(double share) const {
    auto const off = [&](double w) { return Sloped{torus_share(w) - share, 1 + second / radius * sincos_turn(w).cos}; };
    double const reach = second / radius / (2 * pi);
    return bracketed_root(off, share - reach, share + reach, true);
  }
  STRAY_HD Extent extent() const { return {low, high, near, far}; }
  STRAY_HD Vec3 reference() const { return pose.origin; }
  double largest_length() const { return carrier == Carrier::torus ? torus().largest_length() : 0; }
  STRAY_HD Box bounds() const { return box; }
};

}  // namespace straytrace::geometry
