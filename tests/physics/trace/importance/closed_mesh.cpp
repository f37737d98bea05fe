// SPDX-License-Identifier: BSD-3-Clause
// Population of paths where walls absorb nothing (docs/theory/sampling.md): targets in the plane of the vertex create
// no power, and the copies of one history are bounded without bias.
#include "support/mesh_shapes.hpp"
#include "support/trace_received.hpp"

namespace straytrace::testing::trace_closed_mesh {
namespace {

// A cross of seven cubes, white inside and black outside, with a lit spot on one wall. Turned, so that rounding moves
// points off the planes of their walls; its patches join walls of several planes.
World white_cross(double radius) {
  World world;
  BodyId const body = world.add_body("all", {});
  std::uint32_t const white = lambertian_optic(world, 1), black = black_optic(world);
  TriangleMesh const mesh = mesh_of(cross_shaped(), facing_along({}, unit({0.3, -0.5, 0.7})));
  SurfaceId const walls = world.add_surface(mesh, black, white, body, world.add_group("walls"));
  SurfacePoint const p = sample_of(mesh, 0.504, 0.43);
  Footprint lit = spot(walls, p.point, normal_of(mesh, p.point, p.piece), Profile::even, radius, world.add_port("p"));
  lit.backoff = 0.4;
  lit.standing = true;
  world.add_footprint(lit);
  world.finish();
  return world;
}

// Steps of a walk without splitting. `drop`: an aimed hop that meets nothing on the list of targets has no weight, as
// in finish_hop_weight(); otherwise its weight is that of a direction of the BSDF model.
struct Leak {
  int outside = 0;     // arrivals on the black side with more than rounding
  double created = 0;  // power of all weights that `drop` sets to zero
  double emitted_power = 0;
};
Leak leaking(WorldView const& view, std::uint64_t histories, bool drop) {
  Leak leak;
  Silent sink;
  for (std::uint64_t h = 0; h < histories; ++h) {
    PathState path;
    path.history = h;
    if (!emit(view, 1, path, sink)) continue;
    leak.emitted_power += path.power;
    for (bool alive = true; alive && path.order < view.limits.max_order;) {
      Hit const hit = view.closest(path.ray, path.from);
      if (!hit.surface.valid()) break;
      Vertex v = vertex_at(view, path, hit);
      bool const passed =
          met_aim(view, path.hop, &v) && view.steering.density(view.steering.sides[path.hop.side], v.patch) == 0;
      double weight = finish_hop_weight(view, path, &v);
      if (!drop && passed) {
        weight = path.hop.value / (path.hop.lobe * law_share(view, path.hop.side) * path.hop.law_pdf);
        leak.created += path.power * weight;
      }
      path.power *= weight;
      if (path.power == 0) break;
      ++path.event;
      ++path.order;
      evaluate_scattering(view, path, path.ray.dir, v);
      if (v.front && path.power > 1e-6) ++leak.outside;
      alive = scatter(view, 1, path, v, sink);
    }
  }
  return leak;
}

TEST(ClosedMesh, TargetsInThePlaneOfTheVertexCreateNoPower) {
  World world = white_cross(0.2);
  SteeredWorld const steered = steer(world);
  WorldView const view = steered.view();
  EXPECT_EQ(leaking(view, 40000, true).outside, 0);
  Leak const wrong = leaking(view, 40000, false);  // negative control
  EXPECT_GT(wrong.outside, 0);
  EXPECT_GT(wrong.created, 1e-4 * wrong.emitted_power);
  // The trace loses no path, and nothing reaches the black side.
  TraceResult const r = run_histories(world, 5 * largest_block);
  EXPECT_EQ(r.total.lost, 0u);
  EXPECT_LT(r.total.energy_balance[int(BalanceTerm::absorbed)].sum, 1e-9 * r.total.emitted.sum);
  // All light is still there after four bounces; later the weights spread too much for an error.
  world.limits.max_order = 4;
  BlockSums const few = run_histories(world, 1 << 17).total;
  expect_mean("light after four bounces",
              sample_mean(estimate(few.energy_balance[int(BalanceTerm::truncated)], few.histories, few.blocks),
                          few.histories, double(few.histories) / few.emitted.sum),
              1, 4e-2);
}

// A white sphere whose strips have adjoints of two sizes: every path wants to be split up to a billion times.
World splitting(double rho) {
  World world;
  BodyId const body = world.add_body("sphere", {});
  std::uint32_t const white = lambertian_optic(world, rho), black = black_optic(world);
  SurfaceId const wall = world.add_surface(sphere(1), black, white, body, world.add_group("wall"));
  Footprint lit = spot(wall, {0, 0, -1}, {0, 0, -1}, Profile::even, 0.3);
  lit.backoff = 0.5;
  world.add_footprint(lit);
  world.finish();
  SteeringTables tables = make_strips(world);
  for (PatchSide& side : tables.sides) side.adjoint = 1;
  tables.level = 1e-9;
  world.steer(std::move(tables));
  return world;
}
struct Population : Silent {
  double emitted_power = 0, arrived = 0, before_the_bound = 0;
  std::uint64_t events = 0, most = 0, bound = 0;
  void emitted(PathState const& path, Vertex const&) { emitted_power = path.emitted; }
  void visit(PathState const& path, Vertex const&) {
    arrived += path.power;
    if (++events <= bound) before_the_bound += path.power;
  }
};

TEST(ClosedMesh, CopiesOfAHistoryAreBoundedWithoutBias) {
  double const rho = 0.7;
  World world = splitting(rho);
  world.limits.max_order = 24;
  double const bound = double(most_events_per_order * world.limits.max_order);
  Population population;
  population.bound = std::uint64_t(bound / 2);
  Sampler all, cut;
  walk(world, 400, population, [&] {
    all.add(population.arrived / population.emitted_power);
    cut.add(population.before_the_bound / population.emitted_power);
    population.most = std::max(population.most, population.events);
    population.arrived = population.before_the_bound = 0;
    population.events = 0;
  });
  EXPECT_NEAR(double(population.most), bound, 0.1 * bound) << "without the bound there would be far more";
  double const expected = (1 - std::pow(rho, world.limits.max_order)) / (1 - rho);
  expect_mean("arriving power", all.mean(), expected, 2e-2 * expected);
  expect_rejected("a wall that is 10 % more reflecting", all.mean(), 1 / (1 - 1.1 * rho));
  EXPECT_LT(cut.mean().mean, 0.97 * expected) << "negative control: the second half of the events does not count";
}

}  // namespace
}  // namespace straytrace::testing::trace_closed_mesh
