// SPDX-License-Identifier: BSD-3-Clause
// Where a beam of the interferometer meets a surface. Sources and ports of the trace are made of these: light scattered
// there leaves the mode with weight |u|^2, light arriving there rejoins it with weight lambda^2 |u|^2 times the BSDF
// (docs/theory/path_integral.md, eq. 1.1).
#pragma once

#include "base/math/functions.hpp"
#include "base/math/vec3.hpp"
#include "base/memory/ids.hpp"
#include "optics/polarisation.hpp"

namespace straytrace::beams {

// gaussian: TEM00 of 1/e^2 intensity radius `radius` (eq. 0.6). astigmatic: TEM00 with an elliptic spot and a wavefront
// of two curvatures, whose axes need not be those of the spot. even: constant over a disc of `radius` (the even mirror
// weight of eq. 8.15). point: all light at the centre (closed forms of section 8).
enum class Profile : std::uint8_t { gaussian, even, point, astigmatic };

// Spot and wavefront of an astigmatic mode, in the principal axes of the spot: with Q of docs/theory/conventions.md,
// Im Q = lambda/pi diag(w1^-2, w2^-2) and Re Q = C.
struct Astigmatism {
  Vec3 e1{1, 0, 0}, e2{0, 1, 0};     // unit vectors across the travel
  double w1 = 0, w2 = 0;             // 1/e^2 intensity radii along them, m
  double c11 = 0, c12 = 0, c22 = 0;  // C: curvature of the incoming wavefront, 1/m
  // C o for a vector across the travel.
  STRAY_HD Vec3 bent(Vec3 o) const {
    double const x = dot(o, e1), y = dot(o, e2);
    return (c11 * x + c12 * y) * e1 + (c12 * x + c22 * y) * e2;
  }
};

struct Footprint {
  SurfaceId surface;
  Vec3 centre, travel;  // chief ray: where it meets the surface, unit direction of the INCOMING beam
  Profile profile = Profile::gaussian;
  double radius = 0;        // m
  double curvature = 0;     // 1/m, of the incoming wavefront; positive when it diverges in the direction of travel
  Astigmatism astigmatism;  // of the profile `astigmatic`, instead of radius and curvature
  double share = 1;         // q: power of the mode here relative to the main mode (eq. 1.1)
  double hollow = 1;        // Gaussian: the light is that beyond rho, exp(-2 rho^2) = hollow, scaled up to be 1 in all
  double index = 1;         // of the medium the beam arrives in: one mode takes the etendue (lambda/index)^2 there
  double backoff = 0;       // m, how far before the centre a chief-parallel line is certain to start off the surface
  PortId port;              // where light scattered back into this mode rejoins
  std::uint32_t beam = 0;   // footprints of one beam are visited by one and the same main mode
  bool standing = false;    // standing wave of a cavity: its own mirror image is the mode itself
  bool emits = true, receives = true;
  double sub_paths = 0;  // mean number per history that start in the reversed mode (trace/step/sub_path.hpp)
  bool returns = true;   // light scattered straight back into this mode counts; on a mirror of a cavity it is
                         // the mode itself
  bool free = false;     // a beam that starts in empty space: it touches no surface until it meets one
  GroupId origin;        // name of a free beam in routes
  optics::Polarisation polarisation;  // of the incoming wave

  STRAY_HD Vec3 offset(Vec3 p) const {  // of p from the chief ray, across it, m
    Vec3 const o = p - centre;
    return o - dot(o, travel) * travel;
  }
  // |u|^2 across the beam at a point, 1/m^2. A point profile cannot be evaluated, only sampled.
  STRAY_HD double intensity(Vec3 p) const {
    if (profile == Profile::astigmatic) {
      Astigmatism const& a = astigmatism;
      double const x = dot(p - centre, a.e1) / a.w1, y = dot(p - centre, a.e2) / a.w2;
      return beyond_hollow(exp_number(-2 * (x * x + y * y))) * (2 / (pi * a.w1 * a.w2));
    }
    double const rho2 = length2(offset(p)), w2 = radius * radius;
    if (profile == Profile::gaussian) {
      double const twice = 2 / w2;
      return beyond_hollow(exp_number(-rho2 * twice)) * (twice * (1 / pi));
    }
    return profile == Profile::even && rho2 <= w2 ? 1 / (pi * w2) : 0;
  }
  // Slope of the wavefront at an offset from the chief ray: gradient of its lag there, to first order.
  STRAY_HD Vec3 slope(Vec3 o) const { return profile == Profile::astigmatic ? astigmatism.bent(o) : curvature * o; }
  // Direction of the incoming wave at a point: normal of its wavefront.
  STRAY_HD Vec3 direction(Vec3 p) const { return unit(travel + slope(offset(p))); }
  // Light of a free beam that comes straight to p: each point of its plane travels along its own direction, so offsets
  // from the chief ray grow by 1 + L C over a length L along it, and the irradiance falls by the determinant.
  struct Passing {
    Vec3 start, travel;     // point of the plane; unit direction
    double irradiance = 0;  // across `travel`, over the power of the beam, 1/m^2; 0: none, or not known (a focus)
  };
  STRAY_HD Passing passing(Vec3 p) const {
    double const along = dot(p - centre, travel);
    if (!(along > 0)) return {};
    if (profile == Profile::astigmatic) return passing_astigmatic(offset(p), along);
    double const wider = 1 + curvature * along;
    if (std::fabs(wider) < 1e-9) return {};
    Passing light;
    light.start = centre + (1 / wider) * offset(p);
    light.travel = direction(light.start);
    light.irradiance = intensity(light.start) / (wider * wider * dot(light.travel, travel));
    return light;
  }
  // Lag of the wavefront on the plane across the chief ray, m: of a sphere sqrt(R^2 + rho^2) - R (R3.10).
  STRAY_HD double lag(Vec3 p) const {
    Vec3 const o = offset(p);
    if (profile == Profile::astigmatic) {
      Vec3 const bent = astigmatism.bent(o);
      return dot(o, bent) / (std::sqrt(1 + length2(bent)) + 1);
    }
    double const rho2 = length2(o), c = curvature;
    return c * rho2 / (std::sqrt(1 + c * c * rho2) + 1);
  }
  // A line parallel to the chief ray, drawn with density |u|^2 across the beam.
  STRAY_HD Ray sample(double u, double v) const {
    double rho = 0;
    if (profile == Profile::astigmatic) return sample_astigmatic(u, v);
    if (profile == Profile::gaussian) rho = radius * std::sqrt(-0.5 * log_positive(u * hollow));
    if (profile == Profile::even) rho = radius * std::sqrt(u);
    Frame const f = Frame::around(travel);
    SinCos const a = sincos_turn(v);
    return {centre - backoff * travel + (rho * a.cos) * f.e1 + (rho * a.sin) * f.e2, travel};
  }

 private:
  STRAY_HD double beyond_hollow(double beyond) const {
    return hollow == 1 ? beyond : beyond > hollow ? 0 : beyond / hollow;
  }
  STRAY_HD Ray sample_astigmatic(double u, double v) const {
    double const rho = std::sqrt(-0.5 * log_positive(u * hollow));
    SinCos const turn = sincos_turn(v);
    Astigmatism const& a = astigmatism;
    return {centre - backoff * travel + (a.w1 * rho * turn.cos) * a.e1 + (a.w2 * rho * turn.sin) * a.e2, travel};
  }
  // The offset was (1 + L C)^-1 o on the plane.
  STRAY_HD Passing passing_astigmatic(Vec3 o, double along) const {
    Astigmatism const& a = astigmatism;
    double const x = dot(o, a.e1), y = dot(o, a.e2);
    double const m11 = 1 + along * a.c11, m12 = along * a.c12, m22 = 1 + along * a.c22;
    double const wider = m11 * m22 - m12 * m12;
    if (std::fabs(wider) < 1e-9) return {};
    Passing light;
    light.start = centre + ((m22 * x - m12 * y) / wider) * a.e1 + ((m11 * y - m12 * x) / wider) * a.e2;
    light.travel = direction(light.start);
    light.irradiance = intensity(light.start) / (std::fabs(wider) * dot(light.travel, travel));
    return light;
  }
};

}  // namespace straytrace::beams
