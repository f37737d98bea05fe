// SPDX-License-Identifier: BSD-3-Clause
// E.1: an empty tube between two 1/theta^2 mirrors, and its closed forms (docs/theory/arm.md eq. 8.10,
// 8.15). One direction, one arm, static phase 0 unless stated.
#pragma once

#include "base/every_module.hpp"
#include "optics/scatter/shift_invariant.hpp"
#include "support/aimed_walls.hpp"
#include "trace/tally/replay.hpp"

namespace straytrace::testing::arm_tube {

inline constexpr double tube_radius = 0.6, mirror_radius = 0.175, arm = 3000, loss = 1e-6, above = 55e-6;
inline constexpr double lambda = 1.064e-6, k = 2 * pi / lambda, wall_motion = 0.075e-6;  // m, amplitude of each axis
inline constexpr SurfaceId mirror_1{0}, mirror_2{1}, wall_surface{2}, ring_2{4};

struct Case {
  Profile weight = Profile::even;   // |u|^2 of mirror 2, of the radius of the mirror
  double spot = 0;                  // m, standard deviation of the light on mirror 1; 0: a point on the axis
  double reflect = 1, scatter = 0;  // of the wall: specular, Lambertian
  bool white = false;               // mirror 2 is Lambertian instead, of reflectance 1
  bool rings = false;               // flat rings of silicon carbide right before the mirrors
  bool both_ways = false;           // one beam lights both mirrors and takes light back at both
};

inline double mirror_kappa() { return loss * statistical_kappa(above) / (2 * pi); }  // eq. 3.19, 1/sr

inline World make(Case const& c = {}) {
  World world;
  BodyId const optics = world.add_body("optics", {}), pipe = world.add_body("pipe", {});
  std::uint32_t const mirror = power_law_optic(world, mirror_kappa(), 2, above), black = black_optic(world);
  world.add_surface(Disk{{}, {0, 0, 1}, 0, mirror_radius}, mirror, black, optics, world.add_group("mirror 1"));
  world.add_surface(Disk{{0, 0, arm}, {0, 0, -1}, 0, mirror_radius}, c.white ? lambertian_optic(world, 1) : mirror,
                    black, optics, world.add_group("mirror 2"));
  Optic steel;
  steel.reflect = c.reflect;
  if (c.scatter > 0) {
    steel.laws = 1;
    steel.law[0] = world.add_law(Lambertian{c.scatter});
  }
  world.add_surface(Cylinder{{}, {0, 0, 1}, tube_radius, 0, arm}, black, world.add_optic(steel), pipe,
                    world.add_group("wall"));
  if (c.rings) {
    Optic carbide;  // as `sic_baffle` of the library
    carbide.reflect = 0.19526;
    carbide.laws = 1;
    carbide.law[0] = world.add_law(Lambertian{5e-5});
    std::uint32_t const ring = world.add_optic(carbide);
    BodyId const shaken = world.add_body("rings", {});
    for (auto [z, facing, name] : {std::tuple{0.01, -1.0, "ring 1"}, {arm - 0.01, -1.0, "ring 2"}})
      world.add_surface(Disk{{0, 0, z}, {0, 0, facing}, 0.176, 0.4}, ring, ring, shaken, world.add_group(name));
  }
  Profile const source = c.spot > 0 ? Profile::gaussian : Profile::point;
  Footprint one = spot(mirror_1, {}, {0, 0, -1}, source, 2 * c.spot,
                       c.both_ways || c.rings ? world.add_port("mirror 1") : PortId{});
  Footprint two =
      spot(mirror_2, {0, 0, arm}, {0, 0, 1}, c.weight, mirror_radius, world.add_port("mirror 2"), c.both_ways ? 0 : 1);
  two.emits = c.both_ways;
  world.add_footprint(one);
  world.add_footprint(two);
  world.limits.max_order = 4;
  world.limits.route_vertices = 6;
  world.finish();
  return world;
}

// Eq. 8.10: angles between which light of the axis reaches mirror 2 after m hits of the wall.
inline double first_angle(int m) { return (2 * m * tube_radius - mirror_radius) / arm; }
inline double last_angle(int m) { return (2 * m * tube_radius + mirror_radius) / arm; }
inline double order_share(int m) {  // of the light scattered out of mirror 1
  return statistical_kappa(above) * std::log(last_angle(m) / first_angle(m));
}
inline double prefactor() { return lambda * lambda * loss / (std::sqrt(32.0) * pi * pi * arm * mirror_radius); }
inline double order_line(int m) {  // two axes
  return prefactor() * statistical_kappa(above) * k * wall_motion *
         std::sqrt(2 * std::log(last_angle(m) / first_angle(m)));
}
// Recoupled power of order m, eq. 1.7 with even weight: (eps kappa_s lambda)^2/(2 pi^2 R_m^2) int dtheta/theta^3.
inline double order_coupling(int m) {
  return std::pow(loss * statistical_kappa(above) * lambda / (pi * mirror_radius), 2) / 4 *
         (1 / std::pow(first_angle(m), 2) - 1 / std::pow(last_angle(m), 2));
}

// First directions of mirror 1 aimed at the part of the wall from which light reaches mirror 2 next; `spare`: as a
// share of its distance, for light that does not start on the axis. What is aimed carries less, and must not be weeded
// for it.
inline void aim_at_first_order(World& world, double spare = 0.01) {
  double const near = (1 - spare) * tube_radius / last_angle(1) / arm,
               far = (1 + spare) * tube_radius / first_angle(1) / arm;
  world.limits.roulette_below = 0;
  world.steer(aimed_walls(world, mirror_1, {{wall_surface, 2 * pi * tube_radius * arm, {0, near, far, 1}, 1, 2}}));
}

// Power that arrives on mirror 2 after m wall hits, and h^2 of the line made by light rejoining there, by paths that
// start at mirror 1.
struct Orders : Silent {
  World const& world;
  double amplitude;  // m, of the wall along x, and along y a quarter of a period later
  std::vector<PassedVertex> passed;
  double share[4] = {}, coupling[4] = {}, line2[4] = {},
         third2[4] = {};  // third2: of the line at three times the frequency
  explicit Orders(World const& w, double a = wall_motion) : world(w), amplitude(a) {}
  void start(Vec3 at, Vec3 out) { passed = {{mirror_1, at, {0, 0, -1}, out, Event::emit}}; }
  void emitted(PathState const&, Vertex const&) { passed.clear(); }
  void visit(PathState const& path, Vertex const& v) {
    Vec3 const d = path.ray.dir, n = v.frame.e3;
    if (passed.empty()) start(path.ray.origin, d);
    passed.push_back({v.surface, v.point, d, d - (2 * dot(d, n)) * n, Event::reflect});
    if (v.surface == mirror_2 && path.order <= 4) share[path.order - 1] += path.power;
  }
  void score(PathState const& path, Vertex const&, std::uint32_t lit, std::uint32_t number, Vertex const&, double f) {
    if (!is_hit(number) || path.order > 4 || passed.back().surface != mirror_2) return;
    auto vertices = passed;
    vertices.back().out = {0, 0, -1};
    coupling[path.order - 1] += f;
    for (PhaseSensitivity const& l : phase_sensitivities_of(world, vertices, 0, lit)) {
      if (world.bodies()[l.body.value].name != "pipe") continue;
      // h = (lambda/4 pi L) sqrt(f) sin(z sin wt), eq. 9.1 and 7.3; lines of amplitude 2 J_n(z)
      double const z = std::hypot(l.d[0], l.d[1]) * amplitude, scale = f * std::pow(lambda / (4 * pi * arm), 2);
      line2[path.order - 1] += scale * 2 * std::pow(std::cyl_bessel_j(1, z), 2);
      third2[path.order - 1] += scale * 2 * std::pow(std::cyl_bessel_j(3, z), 2);
    }
  }
  void clear() {
    for (auto* sums : {share, coupling, line2, third2}) std::fill_n(sums, 4, 0.0);
  }
};

// The program's step on directions at equal shares of the BSDF model's own density, from points at equal shares of the
// spot: a quadrature.
inline Orders quadrature(World const& world, double spot = 0, double amplitude = wall_motion, int n = 1 << 19) {
  WorldView const view = world.view();
  PowerLaw const law = power_law(mirror_kappa(), 2, above);
  Orders orders(world, amplitude);
  auto const evenly = [](double step, int i) { return std::fmod(step * i + 0.5, 1.0); };  // additive recurrence
  for (int i = 0; i < n; ++i) {
    BsdfSample const s = law.sample({0, 0, 1}, (i + 0.5) / n, evenly(0.569840290998053, i));
    if (!(s.pdf > 0)) continue;
    History history;
    PathState& path = history.path;
    path.from = mirror_1;
    path.ray.dir = s.wo;
    if (spot > 0) path.ray.origin = {spot * std::sqrt(-2 * std::log(evenly(0.754877666246693, i))), 0, 0};
    path.power = law.eval({0, 0, 1}, s.wo) * s.wo.z / s.pdf / n;
    path.emitted = loss / n;
    path.hop.law_pdf = path.hop.value = s.pdf;
    orders.start(path.ray.origin, s.wo);
    while (path.order < 4 && step(view, 1, history, orders) && orders.passed.back().surface != mirror_2) {
    }
  }
  return orders;
}

}  // namespace straytrace::testing::arm_tube
