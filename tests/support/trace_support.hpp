// SPDX-License-Identifier: BSD-3-Clause
// Small worlds built by hand, and estimates read from their traces.
#pragma once

#include <cmath>
#include <string>

#include "support/laws.hpp"
#include "support/shapes.hpp"
#include "support/statistics.hpp"
#include "support/test_backend.hpp"
#include "trace/run/trace.hpp"
#include "trace/step/step.hpp"

namespace straytrace::testing {

inline std::uint32_t lambertian_optic(World& world, double reflectance) {
  Optic optic;
  optic.laws = 1;
  optic.law[0] = world.add_law(Lambertian{reflectance});
  return world.add_optic(optic);
}
inline std::uint32_t power_law_optic(World& world, double kappa, double exponent, double above, double reflect = 0) {
  Optic optic;
  optic.reflect = reflect;
  optic.laws = 1;
  optic.law[0] = world.add_law(power_law(kappa, exponent, above));
  return world.add_optic(optic);
}
inline std::uint32_t mirror_optic(World& world, double reflect) {
  Optic optic;
  optic.reflect = reflect;
  return world.add_optic(optic);
}
inline std::uint32_t black_optic(World& world) { return world.add_optic({}); }

// A lit spot on a surface; the chief ray arrives along `travel`.
inline Footprint spot(SurfaceId surface, Vec3 centre, Vec3 travel, Profile profile, double radius, PortId port = {},
                      std::uint32_t beam = 0) {
  Footprint f;
  f.surface = surface;
  f.centre = centre;
  f.travel = travel;
  f.profile = profile;
  f.radius = radius;
  f.port = port;
  f.beam = beam;
  f.receives = port.valid();
  return f;
}

// A beam that starts in empty space, at the plane through `from` across `travel`.
inline Footprint free_beam(GroupId origin, Vec3 from, Vec3 travel, Profile profile, double radius, double curvature = 0,
                           std::uint32_t beam = 0) {
  Footprint f = spot({}, from, unit(travel), profile, radius, {}, beam);
  f.free = true;
  f.curvature = curvature;
  f.origin = origin;
  return f;
}

// Bare glass, by Fresnel's equations.
inline std::uint32_t glass_optic(World& world) {
  Optic optic;
  optic.has_interface = true;
  optic.interface = world.add_interface(Fresnel{});
  return world.add_optic(optic);
}
// Two faces from `below` to `above`, normals out of the glass; wide enough to need no barrel.
inline void add_plate(World& world, std::string const& name, double index, double below, double above, double x = 0,
                      double radius = 0.5, double absorption = 0) {
  std::uint32_t const optic = glass_optic(world), volume = world.add_volume({index, absorption});
  BodyId const body = world.add_body(name, {});
  world.add_surface(disk(0, radius, {{x, 0, below}, {0, 0, -1}}), optic, optic, body, world.add_group(name + " below"),
                    volume);
  world.add_surface(disk(0, radius, {{x, 0, above}, {0, 0, 1}}), optic, optic, body, world.add_group(name + " above"),
                    volume);
}

inline TraceResult run_histories(World const& world, std::uint64_t histories, std::uint64_t seed = 1,
                                 unsigned threads = 2) {
  TraceSettings settings;
  settings.seed = seed;
  settings.histories = histories;
  settings.threads = threads;
  return run_trace(SteeredWorld::as_given(world), settings, *test_backend());
}

// A sink that listens to nothing; tests overrule what they want to hear.
struct Silent {
  void emitted(PathState const&, Vertex const&) {}
  void visit(PathState const&, Vertex const&) {}
  void score(PathState const&, Vertex const&, std::uint32_t, std::uint32_t, Vertex const&, double) {}
  void book(BalanceTerm, double) {}
};
// Histories 0 to n - 1 one after the other; `after` closes each.
template <class Sink, class After>
void walk(World const& world, std::uint64_t histories, Sink& sink, After&& after, std::uint64_t seed = 1) {
  WorldView const view = world.view();
  for (std::uint64_t h = 0; h < histories; ++h) {
    trace_history(view, seed, h, sink);
    after();
  }
}

// Starts a path by hand at a point of a surface, scattered as if light of power 1 had come in along `travel`.
template <class Sink>
bool launch(WorldView const& view, std::uint64_t seed, std::uint64_t history, SurfaceId from, Vec3 point, Vec3 travel,
            PathState& path, Sink& sink) {
  Vertex vertex = make_vertex(view, from, point, travel);
  path.history = history;
  path.strata = {seed, history, view.block_size};
  path.ray.dir = travel;
  evaluate_scattering(view, path, travel, vertex);
  path.power = 1;
  path.emitted = vertex.albedo;
  return scatter(view, seed, path, vertex, sink, true);
}

inline bool same(Moments const& a, Moments const& b) {
  return a.sum == b.sum && a.sum2 == b.sum2 && a.sum3 == b.sum3 && a.sum4 == b.sum4 && a.block_sum2 == b.block_sum2 &&
         a.largest == b.largest && a.largest_history == b.largest_history && a.scored == b.scored &&
         a.first_sum == b.first_sum && a.tail == b.tail;
}
inline bool same(PhaseSensitivitySums const& a, PhaseSensitivitySums const& b) {
  return a.paths == b.paths && a.weight == b.weight && a.given_up == b.given_up &&
         std::equal(a.products.begin(), a.products.end(), b.products.begin(), b.products.end(),
                    [](PhaseSensitivityProduct const& p, PhaseSensitivityProduct const& q) {
                      return p.replica == q.replica && p.first == q.first && p.second == q.second && p.sum == q.sum;
                    });
}
inline bool same(ClassSums const& a, ClassSums const& b) {
  if (a.port != b.port || !same(a.moments, b.moments) || a.replica_sum != b.replica_sum || a.threshold != b.threshold ||
      a.off_list != b.off_list || a.kept.size() != b.kept.size() || !same(a.phase_sensitivities, b.phase_sensitivities))
    return false;
  for (std::size_t i = 0; i < a.kept.size(); ++i) {
    ScoreAddress const &x = a.kept[i], &y = b.kept[i];
    if (x.history != y.history || x.event != y.event || x.connection != y.connection || x.coupling != y.coupling ||
        x.priority != y.priority)
      return false;
  }
  return true;
}
// Bit by bit.
inline bool same(BlockSums const& a, BlockSums const& b) {
  if (a.histories != b.histories || a.blocks != b.blocks || a.bounces != b.bounces || a.lost != b.lost ||
      !same(a.emitted, b.emitted) || a.classes.size() != b.classes.size() || a.arrived.size() != b.arrived.size())
    return false;
  for (int f = 0; f < balance_term_count; ++f)
    if (!same(a.energy_balance[f], b.energy_balance[f])) return false;
  for (std::size_t g = 0; g < a.arrived.size(); ++g)
    if (!same(a.arrived[g], b.arrived[g])) return false;
  for (auto x = a.classes.begin(), y = b.classes.begin(); x != a.classes.end(); ++x, ++y)
    if (x->first != y->first || !same(x->second, y->second)) return false;
  return true;
}

inline CouplingClass const* find_route(TraceResult const& r, std::string const& name) {
  for (CouplingClass const& c : r.coupling.classes)
    if (route_name(r.coupling, c) == name) return &c;
  return nullptr;
}
inline SampleMean sample_mean(Estimate const& e, std::uint64_t n, double scale = 1) {
  return {e.mean * scale, e.std_error * scale, (long long)n};
}
// Ordered paths of one route, nothing when it was never found.
inline SampleMean route_coupling(TraceResult const& r, std::string const& name) {
  CouplingClass const* c = find_route(r, name);
  return c ? SampleMean{c->coupling.mean, c->coupling.std_error, (long long)r.total.histories} : SampleMean{};
}
// Power arriving on a group, relative to what was emitted per history (all histories emit the same in these worlds).
inline SampleMean arrived(World& world, TraceResult const& r, std::string const& group) {
  Estimate const e = estimate(r.total.arrived[world.add_group(group).value], r.total.histories, r.total.blocks);
  double const emitted = r.total.emitted.sum / double(r.total.histories);
  return sample_mean(e, (long long)r.total.histories, 1 / emitted);
}
// Sum over all routes into all ports, ordered paths.
inline SampleMean total_coupling(TraceResult const& r) {
  double mean = 0, variance = 0;
  for (CouplingClass const& c : r.coupling.classes) {
    mean += c.coupling.mean;
    variance += c.coupling.std_error * c.coupling.std_error;
  }
  return {mean, std::sqrt(variance), (long long)r.total.histories};
}

}  // namespace straytrace::testing
