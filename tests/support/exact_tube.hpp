// SPDX-License-Identifier: BSD-3-Clause
// Diffuse walks in a closed baffled tube, every hit checked against 80-bit arithmetic that is given between which
// baffles the ray starts (docs/develop/performance.md). Everything is a Lambertian wall, so every direction occurs at
// every place.
#pragma once

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "base/every_module.hpp"
#include "base/math/rng.hpp"
#include "optics/scatter/diffuse.hpp"
#include "support/shapes.hpp"
#include "world/model/world.hpp"

namespace straytrace::testing {

using Real = long double;

struct Tube {
  double length, radius, aperture;  // m; baffles reach from the aperture to the wall
  int baffles;
  double spacing() const { return length / (baffles + 1); }
};
inline constexpr Tube tube3{3000, 0.5, 0.4, 200}, tube40{40000, 0.6, 0.45, 500};

// The tube as surfaces (id 0 wall, 1 and 2 end disks, 3 + k baffle k) and as the 80-bit checker sees it.
struct TubeScene {
  Tube tube;
  World world;
  std::vector<Cone> cones;  // by baffle; unused for the flat ones
  std::vector<double> low, high;

  explicit TubeScene(Tube t) : tube(t) {
    auto const add = [&](auto const& shape) { world.add_surface(shape, 0, 0, {}, {}); };
    world.add_optic({});
    add(cylinder(t.radius, 0, t.length));
    add(disk(0, t.radius));
    add(disk(0, t.radius, {{0, 0, t.length}, {0, 0, -1}}));
    for (int k = 0; k < t.baffles; ++k) {
      double const z = (k + 1) * t.spacing(), half_angle = 0.35 + 0.9 * k / t.baffles, along = k % 4 == 1 ? 1 : -1;
      cones.push_back(cone(t.aperture, t.radius, half_angle, {{0, 0, z}, {0, 0, along}}));
      if (k % 2 == 0)
        add(disk(t.aperture, t.radius, {{0, 0, z}}));
      else
        add(cones.back());
      double const end = k % 2 ? z + along * cones.back().height() : z;
      low.push_back(std::min(z, end) - 1e-9);
      high.push_back(std::max(z, end) + 1e-9);
    }
    world.finish();
  }
};

struct ExactHit {
  std::uint32_t surface = 0xffffffffu;
  Real t = infinity;
};

// The roots of a t^2 + 2 b t + c, without the one at the start point when the ray leaves this very surface.
struct Roots {
  Real t[2] = {infinity, infinity};
  Roots(Real a, Real b, Real c, bool leaving) {
    Real const square = b * b - a * c;
    if (square < 0) return;
    Real const q = -(b + std::copysign(std::sqrt(square), b));
    t[0] = a == 0 ? Real(infinity) : q / a;
    t[1] = q == 0 ? Real(infinity) : c / q;
    if (std::fabs(t[0]) > std::fabs(t[1])) std::swap(t[0], t[1]);
    if (leaving) t[0] = infinity;
    if (t[0] > t[1]) std::swap(t[0], t[1]);
  }
};

class Exact {
 public:
  explicit Exact(TubeScene const& scene) : scene_(scene) {}

  // Distance to one surface, with the double start point and direction taken as they are.
  Real distance(std::uint32_t id, Ray const& ray, std::uint32_t from) const {
    Tube const& tube = scene_.tube;
    Real const x = ray.origin.x, y = ray.origin.y, z = ray.origin.z, dx = ray.dir.x, dy = ray.dir.y, dz = ray.dir.z;
    Real const a = dx * dx + dy * dy, b = x * dx + y * dy, c = x * x + y * y, wall = Real(tube.radius) * tube.radius;
    if (id == 0) {
      for (Real t : Roots(a, b, c - wall, from == 0).t)
        if (t > 0 && t < infinity && z + t * dz >= 0 && z + t * dz <= tube.length) return t;
      return infinity;
    }
    int const k = int(id) - 3;
    Real const hole = k < 0 ? Real(0) : Real(tube.aperture) * tube.aperture;
    auto const inside = [&](Real t) {
      Real const rho2 = c + t * (2 * b + t * a);
      return t > 0 && t < infinity && rho2 >= hole && rho2 <= wall;
    };
    if (k < 0 || k % 2 == 0) {
      Real const height = id == 1 ? 0 : id == 2 ? tube.length : (k + 1) * tube.spacing(), t = (height - z) / dz;
      return id != from && dz != 0 && inside(t) ? t : infinity;
    }
    Cone const& cone = scene_.cones[std::size_t(k)];
    Real const slope = Real(cone.sine) / cone.cosine, h = cone.axis.z * (z - cone.apex.z), dh = cone.axis.z * dz;
    Real const s2 = slope * slope;
    for (Real t : Roots(a - s2 * dh * dh, b - s2 * h * dh, c - s2 * h * h, id == from).t)
      if (h + t * dh >= 0 && inside(t)) return t;
    return infinity;
  }

  // Walks from the compartment of the start point along the ray, up to the first baffle beyond the answer.
  ExactHit closest(Ray const& ray, std::uint32_t from) const {
    ExactHit best;
    auto const test = [&](std::uint32_t id) {
      Real const t = distance(id, ray, from);
      if (t < best.t) best = {id, t};
    };
    for (std::uint32_t id : {0u, 1u, 2u}) test(id);
    int const count = scene_.tube.baffles, here = int(ray.origin.z / scene_.tube.spacing());
    int const step = ray.dir.z < 0 ? -1 : 1;
    for (int k = std::clamp(here - 2 * step, 0, count - 1); k >= 0 && k < count; k += step) {
      Real const end = ray.origin.z + best.t * ray.dir.z;
      if (step > 0 ? Real(scene_.low[std::size_t(k)]) > end : Real(scene_.high[std::size_t(k)]) < end) break;
      test(std::uint32_t(k) + 3);
    }
    return best;
  }

 private:
  TubeScene const& scene_;
};

struct Tally {
  long long bounces = 0, lost = 0, wrong = 0, self = 0;
  std::set<std::uint32_t> seen;  // surfaces hit
  double worst_error = 0;        // distance of the hit from the exact surface in units of `resolution`
};

// Spacing of doubles where it matters: heights up to the tube's length, radii, and the distance flown.
inline double resolution(double z, double t) { return 0x1p-52 * (std::fabs(z) + std::fabs(t) + 1); }

// Walks of 10,000 Lambertian bounces from random places on the wall; `tracer(ray, from)` finds the hits.
template <class Tracer>
Tally walk(TubeScene const& scene, long long bounces, std::uint64_t seed, Tracer tracer) {
  constexpr int walk_length = 10000;
  WorldView const view = scene.world.view();
  Exact const exact(scene);
  Lambertian const matt{1};
  Tally tally;
  for (std::uint64_t history = 0; tally.bounces < bounces; ++history) {
    Rng start(seed, history, 0, Stream::source);
    SurfaceId from{0};
    Vec3 p = view.project(from, {scene.tube.radius, 0, scene.tube.length * start.uniform()});
    Vec3 n = -view.normal(from, p);
    for (std::uint32_t event = 0; event < walk_length && tally.bounces < bounces; ++event, ++tally.bounces) {
      Rng rng(seed, history, event, Stream::direction);
      double const u = rng.uniform(), v = rng.uniform();
      Ray const ray{p, unit(Frame::around(n).to_world(matt.sample({0, 0, 1}, u, v).wo))};
      Hit const hit = tracer(ray, from);
      ExactHit const truth = exact.closest(ray, from.value);
      if (!hit.surface.valid()) {
        ++tally.lost;
        break;
      }
      if (hit.surface == from && hit.distance < 1e-9) ++tally.self;
      tally.seen.insert(hit.surface.value);
      Real const same = exact.distance(hit.surface.value, ray, from.value);  // the 80-bit answer for the surface found
      if (hit.surface.value != truth.surface && !(same - truth.t < 1e-11L)) ++tally.wrong;
      Vec3 const at = ray.origin + hit.distance * ray.dir;
      n = view.normal(hit.surface, at);
      double const slope = dot(n, ray.dir), off = std::fabs(double(hit.distance - same) * slope);
      tally.worst_error = std::max(tally.worst_error, off / resolution(at.z, hit.distance));
      if (slope > 0) n = -n;
      p = view.project(hit.surface, at);
      from = hit.surface;
    }
  }
  return tally;
}

// The claim: nothing lost, nothing wrong, no surface hit again where it was left, and hits off the exact surface by no
// more than one spacing of doubles at the place (9e-12 m at 40 km, 1e-5 of a wavelength).
inline bool exact_to_rounding(Tally const& t) {
  return t.lost == 0 && t.wrong == 0 && t.self == 0 && t.worst_error < 1;
}

}  // namespace straytrace::testing
